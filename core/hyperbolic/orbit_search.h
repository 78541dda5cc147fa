#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/base/context.h"
#include "core/hyperbolic/orbit_polygon.h"

namespace moduli {

/// Finds an element of a group by where it sends 0: a grid over the plane of (x, y) in Minkowski
/// space, in which points of the orbit are at least 2 sinh(separation / 2) apart however far from 0
/// they are. Rounding 1e-16 e^d must stay far below: d < 25 for separations of 1e-3.
class OrbitIndex {
 public:
  explicit OrbitIndex(double separation);

  /// The value entered for the element, up to sign; -1 where there is none.
  std::int32_t find(const Su11& g) const;
  /// Enters a value for an element that is not there.
  void enter(const Su11& g, std::int32_t value);

 private:
  struct Cell {
    std::int64_t x = 0, y = 0;
    bool operator==(const Cell&) const = default;
  };
  struct CellHash {
    std::size_t operator()(const Cell& cell) const;
  };
  struct Entry {
    Complex place;
    std::int32_t value = 0;
  };

  double size_;
  std::unordered_map<Cell, Entry, CellHash> cells_;
};

/// Elements in the polygon's coordinates, ascending by their displacement of 0; the first is 1.
struct OrbitBall {
  std::vector<Su11> elements;
  /// Per element the one it came from and the pairing that was multiplied on the right.
  std::vector<std::int32_t> parent, pairing;
  /// Every element of displacement at most this is there.
  double complete_to = 0;

  /// The word of an element in the given generators, reduced. O(letters).
  Word wordOf(const OrbitPolygon& polygon, std::size_t i) const;
};

/// The elements g with d(0, g 0) <= reach, as far as `most` of them suffice: where they do not,
/// complete_to is less than reach.
///
/// Every element but 1 is carried nearer to 0 by one of the pairings (0 is the point of its orbit
/// nearest to 0), so that products that move away from 0 find them all; there are about (cosh reach
/// - 1) / (2 genus - 2). O(n p) for n elements and p pairings. Source: MATH 7.5.
Result<OrbitBall> searchOrbit(Context& context, const OrbitPolygon& polygon, double reach,
                              std::size_t most);

}  // namespace moduli
