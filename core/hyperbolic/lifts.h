#pragma once

#include <cstdint>
#include <vector>

#include "core/hyperbolic/axis.h"
#include "core/hyperbolic/orbit_polygon.h"

/// All axes over one closed geodesic that pass the polygon, in 113 bits: an axis in the middle of a
/// collar of length l has its conjugate at the other end of the polygon e^{2 radius} / l away from
/// what doubles make of it.
namespace moduli {

/// A conjugate of an element.
struct Lift {
  WideSu11 map;
  Su11 shape;  ///< The same in doubles.
  /// It is s^-1 g s of the lift g with this number and this pairing s; -1: given.
  int from = -1, pairing = -1;

  Axis axis() const { return axisOf(shape); }
};

/// The pairings whose product is the element, up to sign, in the polygon's coordinates. Empty also
/// where it is not of the group. O(n p) for n pairings of p.
std::vector<std::int32_t> pairingsOf(const OrbitPolygon& polygon, const Su11& element);

/// The product of pairings.
WideSu11 productOf(const OrbitPolygon& polygon, const std::vector<std::int32_t>& pairings);

/// The element and its conjugates whose axes pass the polygon at a sinh of distance of at most
/// `slack`. element: with an axis that does. O(n^2 + n p) for n of them and p pairings.
std::vector<Lift> liftsAcross(const OrbitPolygon& polygon, const WideSu11& element,
                              double slack = 0.05);

}  // namespace moduli
