#include "tests/core/hyperbolic/sample_groups.h"

#include <cmath>
#include <cstddef>
#include <queue>
#include <random>

namespace moduli {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// The corners of a triangle in the disk, the first at 0, the second on the positive real axis.
std::array<Complex, 3> cornersOf(const TriangleValues& sides) {
  const double angle = std::acos((std::cosh(sides[0]) * std::cosh(sides[2]) - std::cosh(sides[1])) /
                                 (std::sinh(sides[0]) * std::sinh(sides[2])));
  return {0, std::tanh(sides[0] / 2), std::polar(std::tanh(sides[2] / 2), angle)};
}

/// Carries the triangle across a halfedge to its place beside the halfedge's own triangle.
Su11 transition(const IntrinsicSurface& surface, Index h) {
  const auto frame = [&surface](Index e) {
    const auto corners = cornersOf(surface.sides(e / 3));
    return edgeFrame(corners[e % 3], corners[(e + 1) % 3]);
  };
  const double length = surface.lengths[surface.connectivity.edge(h)];
  return frame(h) * edgeHalfTurn(length) * inverse(frame(surface.connectivity.twin(h)));
}

}  // namespace

std::vector<Su11> holonomyGenerators(const IntrinsicSurface& surface, Index root) {
  const Connectivity& connectivity = surface.connectivity;
  std::vector<Su11> place(connectivity.faceCount());
  std::vector<bool> placed(connectivity.faceCount(), false);
  std::vector<bool> inside(connectivity.edgeCount(), false);
  std::queue<Index> next;
  next.push(root);
  placed[root] = true;
  for (; !next.empty(); next.pop())
    for (Index h = 3 * next.front(); h < 3 * next.front() + 3; ++h) {
      const Index face = Connectivity::faceOf(connectivity.twin(h));
      if (placed[face]) continue;
      placed[face] = true;
      inside[connectivity.edge(h)] = true;
      place[face] = renormalized(place[next.front()] * transition(surface, h));
      next.push(face);
    }
  std::vector<Su11> generators;
  for (Index e = 0; e < connectivity.edgeCount(); ++e) {
    if (inside[e]) continue;
    const Index h = connectivity.halfedge(e);
    const Su11 g = place[Connectivity::faceOf(h)] * transition(surface, h) *
                   inverse(place[Connectivity::faceOf(connectivity.twin(h))]);
    if (distanceToUnit(g) > 1e-6) generators.push_back(renormalized(g));
  }
  return generators;
}

std::vector<Su11> regularPolygonGroup(int genus) {
  const int n = 4 * genus;
  const double radius = std::acosh(1 / std::pow(std::tan(kPi / n), 2));
  const double side = 2 * std::acosh(std::cos(kPi / n) / std::sin(kPi / n));
  const auto corner = [&](int k) { return std::polar(std::tanh(radius / 2), 2 * kPi * k / n); };
  const auto frame = [&](int k) { return edgeFrame(corner(k), corner(k + 1)); };
  std::vector<Su11> generators;
  for (int k = 0; k < n; ++k) {
    // Side k + 2 is side k backwards: from the polygon across side k one enters it at side k + 2.
    if (k % 4 >= 2) continue;
    generators.push_back(frame(k) * edgeHalfTurn(side) * inverse(frame(k + 2)));
  }
  return generators;
}

std::vector<Su11> conjugated(const std::vector<Su11>& generators, const Su11& move) {
  std::vector<Su11> result;
  for (const Su11& g : generators) result.push_back(renormalized(move * g * inverse(move)));
  return result;
}

std::vector<Su11> otherGenerators(std::vector<Su11> generators, unsigned seed) {
  std::mt19937 random(seed);
  for (std::size_t k = 0; k + 1 < generators.size(); k += 2) {
    const Su11& next = generators[k + 1];
    generators[k] = renormalized(generators[k] * (random() % 2 == 0 ? next : inverse(next)));
  }
  return generators;
}

}  // namespace moduli
