#include "core/hyperbolic/klein_cell.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace moduli {
namespace {

using Real = long double;

Complex narrow(const KleinPoint& z) {
  return {static_cast<double>(z.real()), static_cast<double>(z.imag())};
}

/// What is cut off at a corner must be thicker than this, in Klein's model: 1e-12 up to distance 6;
/// sides in the middle of a collar of length l meet at angles of some l^2, and reach as far as
/// log(4 / l) and more.
Real sliverAt(const KleinPoint& corner) {
  const Real height = 1 - std::norm(corner);
  return std::clamp(1.6e-3L * height * height, 3e-19L, 1e-12L);
}

/// Per corner how much nearer it is to g(0) than to 0: Re(conj(u) k) - |w| for the image w of 0 in
/// the direction u. Empty where none is, or no more than a sliver.
std::vector<Real> aboveBisector(const KleinCell& cell, const WideSu11& map, const Su11& shape) {
  if (!mayCutOff(cell, shape, 1e-15)) return {};
  const auto real = [](const WideComplex& z) {
    return KleinPoint(static_cast<Real>(z.real()), static_cast<Real>(z.imag()));
  };
  const KleinPoint image = real(map.b) / std::conj(real(map.a));
  const Real height = std::abs(image);
  const KleinPoint direction = image / height;
  std::vector<Real> above;
  bool cuts = false;
  for (const KleinPoint& k : cell.corner) {
    above.push_back(direction.real() * k.real() + direction.imag() * k.imag() - height);
    cuts = cuts || above.back() > sliverAt(k);
  }
  return cuts ? above : std::vector<Real>{};
}

}  // namespace

KleinCell::KleinCell() : KleinCell({{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, {-1, -1, -1, -1}) {}

KleinCell::KleinCell(std::vector<KleinPoint> corners, std::vector<int> sides)
    : corner(std::move(corners)), side(std::move(sides)) {
  for (const KleinPoint& k : corner) {
    rough.push_back(narrow(k));
    reach = std::max(reach, std::abs(rough.back()));
  }
}

bool mayCutOff(const KleinCell& cell, const Su11& g, double rounding) {
  const double b = std::sqrt(std::norm(g.b));
  const double a = std::sqrt(std::norm(g.a));
  const double height = b / a - rounding;
  if (height > cell.reach) return false;
  const Complex direction = g.b * g.a / (a * b);
  return std::any_of(cell.rough.begin(), cell.rough.end(), [&](const Complex& k) {
    return direction.real() * k.real() + direction.imag() * k.imag() > height;
  });
}

bool cutsOff(const KleinCell& cell, const WideSu11& map, const Su11& shape) {
  return !aboveBisector(cell, map, shape).empty();
}

void cutOff(KleinCell& cell, const WideSu11& map, const Su11& shape, int label) {
  const std::vector<Real> above = aboveBisector(cell, map, shape);
  if (above.empty()) return;
  const std::size_t n = cell.corner.size();
  std::vector<KleinPoint> corners;
  std::vector<int> sides;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    const bool in = above[i] <= 0;
    if (in) {
      corners.push_back(cell.corner[i]);
      sides.push_back(cell.side[i]);
    }
    if (in == (above[j] <= 0)) continue;
    const Real t = above[i] / (above[i] - above[j]);
    corners.push_back(cell.corner[i] + t * (cell.corner[j] - cell.corner[i]));
    sides.push_back(in ? label : cell.side[i]);
  }
  cell = KleinCell(std::move(corners), std::move(sides));
}

bool isBounded(const KleinCell& cell) {
  return cell.reach < 1 - 1e-14;
}

Complex diskPoint(const KleinPoint& klein) {
  const Real k = std::abs(klein);
  return narrow(klein / (1 + std::sqrt((1 - k) * (1 + k))));
}

double areaOf(const KleinCell& cell) {
  double area = 0;
  for (std::size_t i = 0; i < cell.corner.size(); ++i) {
    const Complex p = diskPoint(cell.corner[i]);
    const Complex q = diskPoint(cell.corner[(i + 1) % cell.corner.size()]);
    area -= 2 * std::arg(1.0 - std::conj(p) * q);
  }
  return area;
}

}  // namespace moduli
