#include "core/spherical/cap_loops.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace moduli {
namespace {

/// Spokes are at least this part of the longest side: above 1/2, below which there is no triangle.
constexpr double kLeastRadius = 17.0 / 32;

/// Half of the angle under which the sides are seen from the centre of a circle of diameter 1 / x.
double halfAngle(const std::vector<double>& sides, double x) {
  double sum = 0;
  for (const double side : sides) sum += std::asin(std::min(1.0, side * x));
  return sum;
}

Status badLoop(std::size_t k, const std::string& what) {
  return {Reason::kInvalidOption, "loop " + std::to_string(k) + " " + what};
}

Status checkLoop(const Connectivity& surface, const std::vector<Index>& loop, std::size_t k) {
  if (loop.empty()) return badLoop(k, "has no halfedges");
  for (const Index h : loop) {
    if (h < 0 || h >= surface.halfedgeCount() || surface.twin(h) != kNone) {
      return badLoop(k, "contains " + std::to_string(h) + ", no halfedge of the boundary");
    }
  }
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Index following = loop[(i + 1) % loop.size()];
    if (surface.head(loop[i]) == surface.tail(following)) continue;
    return badLoop(k, "is not in order: halfedge " + std::to_string(following) +
                          " does not follow " + std::to_string(loop[i]));
  }
  return {};
}

/// The faces of all caps, glued to the loops and to each other.
///
/// The face beyond halfedge h runs from its head to its tail and on to the apex, so that its side 1
/// is the spoke of h's tail and its side 2 that of the next halfedge's tail.
struct Gluing {
  std::vector<Triangle> faces;
  std::vector<Index> twin;

  void glue(Index a, Index b) {
    twin[a] = b;
    twin[b] = a;
  }

  Status addCap(const Connectivity& surface, const std::vector<Index>& loop, std::size_t number,
                Index apex) {
    const auto first = static_cast<Index>(3 * faces.size());
    const auto count = static_cast<Index>(loop.size());
    twin.resize(twin.size() + 3 * loop.size(), kNone);
    for (Index k = 0; k < count; ++k) {
      if (twin[loop[k]] != kNone) return badLoop(number, "comes twice");
      faces.push_back({surface.head(loop[k]), surface.tail(loop[k]), apex});
      glue(loop[k], first + 3 * k);
      glue(first + 3 * k + 2, first + 3 * ((k + 1) % count) + 1);
    }
    return {};
  }
};

Gluing gluingOf(const Connectivity& surface) {
  Gluing gluing{surface.faces(), std::vector<Index>(surface.halfedgeCount())};
  for (Index h = 0; h < surface.halfedgeCount(); ++h) gluing.twin[h] = surface.twin(h);
  return gluing;
}

}  // namespace

double capRadius(const std::vector<double>& sides) {
  const double longest = *std::max_element(sides.begin(), sides.end());
  const double least = kLeastRadius * longest;
  // The angle falls as the radius grows: where it is less than a full turn at the least radius, the
  // circle of the polygon is smaller than that or does not have its centre inside.
  double high = 0.5 / least;
  if (halfAngle(sides, high) <= std::numbers::pi) return least;
  double low = 0;
  while (true) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) return 0.5 / high;
    (halfAngle(sides, middle) < std::numbers::pi ? low : high) = middle;
  }
}

Result<CappedSurface> capLoops(const Connectivity& surface, const std::vector<double>& lengths,
                               const std::vector<std::vector<Index>>& loops) {
  if (lengths.size() != static_cast<std::size_t>(surface.edgeCount())) {
    return Status(Reason::kInvalidOption, "there are " + std::to_string(lengths.size()) +
                                              " lengths for " +
                                              std::to_string(surface.edgeCount()) + " edges");
  }
  Gluing gluing = gluingOf(surface);
  std::vector<double> all_lengths = lengths;
  std::vector<Index> apex;
  for (std::size_t k = 0; k < loops.size(); ++k) {
    RETURN_IF_ERROR(checkLoop(surface, loops[k], k));
    apex.push_back(surface.vertexCount() + static_cast<Index>(k));
    RETURN_IF_ERROR(gluing.addCap(surface, loops[k], k, apex.back()));
    std::vector<double> sides;
    for (const Index h : loops[k]) sides.push_back(lengths[surface.edge(h)]);
    all_lengths.insert(all_lengths.end(), loops[k].size(), capRadius(sides));
  }
  const Index vertex_count = surface.vertexCount() + static_cast<Index>(loops.size());
  ASSIGN_OR_RETURN(
      Connectivity capped,
      Connectivity::fromGluing(vertex_count, std::move(gluing.faces), std::move(gluing.twin)));
  return CappedSurface{std::move(capped), std::move(all_lengths), std::move(apex),
                       surface.faceCount()};
}

}  // namespace moduli
