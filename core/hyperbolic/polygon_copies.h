#pragma once

#include <cstdint>
#include <vector>

#include "core/hyperbolic/orbit_search.h"

namespace moduli {

/// Whether the polygon reaches so far that two steps from copy to copy in doubles could miss a copy
/// that is known.
bool reachesFar(const OrbitPolygon& polygon);

/// Numbered copies of a polygon, reached from one to the next, as a search from a first one meets
/// them. Where the polygon reaches far, steps are taken in 113 bits.
class PolygonCopies {
 public:
  /// first: the isometry that carries the polygon to its first copy, which has the number 0.
  PolygonCopies(const OrbitPolygon& polygon, const Su11& first);

  /// The number of the copy beyond the side of a pairing. O(1), some 0.3 us, or 4 us in 113 bits.
  std::int32_t beyond(std::int32_t copy, int pairing);
  /// Carries the polygon to a copy.
  Su11 map(std::int32_t copy) const { return maps_[copy]; }
  /// An axis in the coordinates of a copy.
  Axis seenFrom(std::int32_t copy, const Axis& axis) const;

 private:
  const OrbitPolygon& polygon_;
  bool is_far_;
  OrbitIndex known_;
  std::vector<Su11> maps_;
  std::vector<WideSu11> wide_;  ///< Only where it is far.
};

}  // namespace moduli
