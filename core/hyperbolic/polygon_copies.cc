#include "core/hyperbolic/polygon_copies.h"

#include <cmath>

namespace moduli {

bool reachesFar(const OrbitPolygon& polygon) {
  // A step of length 2 r multiplies the rounding of a direction by e^{2 r}.
  return 1e-16 * std::exp(4 * polygon.radius) > polygon.separation / 100;
}

PolygonCopies::PolygonCopies(const OrbitPolygon& polygon, const Su11& first)
    : polygon_(polygon), is_far_(reachesFar(polygon)), known_(polygon.separation), maps_{first} {
  known_.enter(first, 0);
  if (is_far_) wide_.push_back(widened(first));
}

std::int32_t PolygonCopies::beyond(std::int32_t copy, int pairing) {
  WideSu11 wide;
  Su11 map;
  if (is_far_) {
    wide = renormalized(wide_[copy] * polygon_.wide[pairing]);
    map = rounded(wide);
  } else {
    map = maps_[copy] * polygon_.pairings[pairing].map;
  }
  const std::int32_t found = known_.find(map);
  if (found >= 0) return found;
  const auto number = static_cast<std::int32_t>(maps_.size());
  known_.enter(map, number);
  maps_.push_back(renormalized(map));
  if (is_far_) wide_.push_back(wide);
  return number;
}

Axis PolygonCopies::seenFrom(std::int32_t copy, const Axis& axis) const {
  if (!is_far_) return imageOf(inverse(maps_[copy]), axis);
  // As imageOf.
  const WideSu11 g = inverse(wide_[copy]);
  const Wide time = axis.time;
  const WideComplex space(axis.space.real(), axis.space.imag());
  const WideComplex left = g.a * time + g.b * std::conj(space);
  const WideComplex right = g.a * space + g.b * time;
  const WideComplex image = right * g.a + left * g.b;
  return {static_cast<double>(std::real(left * std::conj(g.a) + right * std::conj(g.b))),
          {static_cast<double>(image.real()), static_cast<double>(image.imag())}};
}

}  // namespace moduli
