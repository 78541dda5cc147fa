#pragma once

#include <cstddef>
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
/// The surface is cut along the curves, and on each side of a curve the copies of the polygon's
/// parts within the pants are searched for the two other cuffs. Fails with kInvalidOption for
/// another number of curves or curves that cross; with kResidualTooLarge where a seam differs by
/// 1e-6. Source: MATH 7.7.
Result<FenchelNielsenReading> fenchelNielsen(Context& context, const OrbitPolygon& polygon,
                                             const std::vector<ClosedGeodesic>& curves);

struct PantsDecomposition {
  std::vector<ClosedGeodesic> curves;  ///< 3 g - 3, simple and disjoint, ascending by length.
  FenchelNielsen coordinates;
  double seam_error = 0;
};

struct PantsOptions {
  /// How many parts of copies of the polygon may be looked at. A million take some 1.5 s and at
  /// most 100 MB, with cuffs below 1e-2 up to 10 s; a surface of genus 12 takes a quarter of a
  /// million.
  std::size_t most_parts = 2'000'000;
};

/// Curves chosen greedily: the shortest simple closed geodesic, then the shortest one that is
/// disjoint from those chosen, and so on; of equally short ones any.
///
/// The shortest one of the rest is the shortest one of a piece of the surface that is cut along
/// those chosen. These pieces alone are searched, disk by disk, up to lengths that grow by 1/2 each
/// time: for n disks some n e^{length} parts as long as a piece is large, and few in small ones.
/// Fails with kNoConvergence, naming the pieces that are not pants yet, where options.most_parts do
/// not suffice; with kResidualTooLarge where rounding leaves no surfaces in pieces, or as
/// fenchelNielsen.
Result<PantsDecomposition> pantsDecomposition(Context& context, const OrbitPolygon& polygon,
                                              const PantsOptions& options = {});

}  // namespace moduli
