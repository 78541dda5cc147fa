#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/hyperbolic/axis.h"
#include "core/hyperbolic/fenchel_nielsen.h"
#include "core/hyperbolic/length_spectrum.h"

/// Cutting a closed hyperbolic surface into pairs of pants along short closed geodesics.
///
///   ASSIGN_OR_RETURN(const PantsDecomposition pants, pantsDecomposition(context, polygon));
///   ASSIGN_OR_RETURN(const PantsGroup group, groupFromFenchelNielsen(pants.coordinates));
namespace moduli {

/// The axes over a closed geodesic that pass the polygon, directed as the element. O(n p).
std::vector<Axis> axesAcross(const OrbitPolygon& polygon, const Su11& element);

/// Whether an axis of `a` crosses one of `b` at an angle of more than 1e-4. With the axes of all
/// lifts to the polygon: whether the geodesics meet, or, a = b, whether one meets itself. O(a b).
bool anyCross(const std::vector<Axis>& a, const std::vector<Axis>& b);

/// What the coordinates were read from, and how well they fit it.
struct FenchelNielsenReading {
  FenchelNielsen coordinates;
  /// The largest difference of a seam as found from what its cuffs make it, relative to 1 + seam.
  double seam_error = 0;
};

/// Fenchel-Nielsen coordinates for 3 g - 3 disjoint simple closed geodesics, in their order and
/// directed as their elements; elements whose axes pass the polygon. The zero of twists depends on
/// order and directions; see FenchelNielsen.
///
/// On each side of an axis over each curve the copies of the polygon are searched, not past other
/// axes, for the nearest axes over the two other cuffs of the pants. Fails with kInvalidOption for
/// another number of curves or curves that cross; with kResidualTooLarge where a seam differs by
/// 1e-6. Source: MATH 7.7.
Result<FenchelNielsenReading> fenchelNielsen(Context& context, const OrbitPolygon& polygon,
                                             const std::vector<ClosedGeodesic>& curves);

struct PantsDecomposition {
  std::vector<ClosedGeodesic> curves;  ///< 3 g - 3, simple and disjoint, ascending by length.
  FenchelNielsen coordinates;
  double seam_error = 0;
};

/// Curves chosen greedily: the shortest simple closed geodesic, then the shortest one that is
/// disjoint from those chosen, and so on; of equally short ones any. Fails with kNoConvergence
/// where options.most_elements do not suffice to know 3 g - 3 of them.
Result<PantsDecomposition> pantsDecomposition(Context& context, const OrbitPolygon& polygon,
                                              const SpectrumOptions& options = {});

}  // namespace moduli
