#pragma once

#include <complex>
#include <vector>

#include "core/hyperbolic/su11.h"
#include "core/hyperbolic/wide_su11.h"

namespace moduli {

/// A corner in the middle of a collar is e^{-2 d} from the circle in Klein's model, at distances d
/// of 8 and more, and sides there are shorter still: more than doubles hold.
using KleinPoint = std::complex<long double>;

/// A convex polygon in Klein's model, where geodesics are straight; the side from corner i to the
/// next has a label, negative on the frame that nothing was cut off yet.
struct KleinCell {
  std::vector<KleinPoint> corner;
  std::vector<int> side;
  std::vector<Complex> rough;  ///< The corners in doubles.
  double reach = 0;            ///< The largest distance of these from 0.

  /// A square around the disk.
  KleinCell();
  KleinCell(std::vector<KleinPoint> corners, std::vector<int> sides);
};

/// Whether the cell has points that are nearer to g(0) than to 0: more than slivers at its corners,
/// of 1e-12 in Klein's model up to distance 6, less beyond. shape: `map` in doubles. O(n).
bool cutsOff(const KleinCell& cell, const WideSu11& map, const Su11& shape);

/// Whether it may, as far as doubles tell. rounding: of the entries of g over |g.a|. O(n).
bool mayCutOff(const KleinCell& cell, const Su11& g, double rounding);

/// Cuts these off, if any, along a side of that label. O(n).
void cutOff(KleinCell& cell, const WideSu11& map, const Su11& shape, int label);

/// Whether all corners are inside the disk.
bool isBounded(const KleinCell& cell);

/// The hyperbolic area. Precondition: bounded.
double areaOf(const KleinCell& cell);

/// In Poincaré's disk. Precondition: inside the disk.
Complex diskPoint(const KleinPoint& klein);

}  // namespace moduli
