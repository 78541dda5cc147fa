#pragma once

#include <complex>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/triangle_soup.h"
#include "core/spherical/circle.h"

namespace moduli {

struct KoebeOptions {
  /// The largest distance of a loop's points from its circle that is left, in radii of the outer
  /// circle.
  double tolerance = 1e-10;
  int max_sweeps = 100;
  /// Into how many parts all sides of loops are cut to begin with, 1 to 32: more where triangles at
  /// the loops turn over, as the curves then follow the polygons' sides more closely.
  int parts = 1;
};

/// The unit disk less round holes, and where points have gone.
struct CircleDomain {
  std::vector<std::complex<double>> points;  ///< Per given point; those of loops on their circles.
  std::vector<Circle> circles;               ///< Per loop; [0] is the unit circle.
  /// After each sweep over the loops the largest distance of a loop's points from its circle.
  std::vector<double> history;
  /// The factor by which the last sweep but rounding made that smaller; 0 for fewer than two.
  double rate = 0;
  /// Per loop into how many parts its sides were cut to keep all points on their side of it.
  std::vector<int> parts;
  Index centered = kNone;  ///< The loop of the hole around 0; kNone without holes.
  Index aligned = kNone;   ///< The loop of the hole with its centre on the positive real axis.
};

/// Maps a plane domain, bounded by Jordan curves through points, conformally to the unit disk less
/// round holes (Koebe's iteration): the inside of the outer curve and the outside of each other one
/// are mapped to those of circles in turn, by InteriorMap and ExteriorMap, until all are round.
///
/// points: of the plane, any units; loops: one at least, each the indices of 3 points or more in
/// order, of either orientation; loops[0] encloses all. No point belongs to two loops or twice to
/// one. Points that belong to none lie between the curves; where they lie within the polygons but
/// not within the smooth curves of the maps, sides are cut into up to 32 parts.
///
/// Normalized: the hole that is largest when centred is around 0 (with one hole a concentric
/// annulus); of the others the one with the largest radius then has its centre on the positive real
/// axis; radii within 1e-6 of each other count as equal, and the first loop wins. With one hole
/// or none the first point of loops[0] is 1. What is left when all is done depends neither on
/// Möbius maps of the given plane nor on the order of points, but for what the curves between the
/// points do, which the sizes of their steps bound at second order.
///
/// A mesh's face with all three corners on the loop of one hole comes out turned over: its corners
/// lie on a circle whose inside is the hole. Cut such faces before.
///
/// Fails with kInvalidOption (sizes, indices, options), kFoldedMap (points beyond a loop, loops
/// that touch), kNoConvergence, and as context.check. A sweep costs n elementary maps for each of
/// the n points of all loops; each other point pays as much once for all sweeps, less what far
/// loops save. Stage "circles". Source: Koebe 1910; Henrici 1986, section 17.7; MATH 5.5.
Result<CircleDomain> koebe(Context& context, std::vector<std::complex<double>> points,
                           const std::vector<std::vector<Index>>& loops,
                           const KoebeOptions& options = {});

}  // namespace moduli
