#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/signature/surface_points.h"

namespace moduli {

/// Parts of the quantiles of each distribution.
inline constexpr int kDistributionParts = 16;

/// Distributions of what points of a surface, uniform by area, are to each other. D1, D2 and D3 as
/// logarithms of quantile means of lengths in units of the radius of gyration, which noise on the
/// surface hardly changes, unlike its area.
struct ShapeDistributions {
  std::vector<double> d1;  ///< Distance of a point from the centroid.
  std::vector<double> d2;  ///< Distance of two points.
  std::vector<double> d3;  ///< Square root of the area of the triangle of three points.
  std::vector<double> a3;  ///< Angle in it, radians.
};

/// D1 from all points; D2 from all pairs of 512 of them, D3 and A3 from all triples of 96, which
/// stand for the points nearest to them. They are chosen by farthestSample: no random numbers.
/// Fails as it does. About 1 F, and some 30 ms whatever the size. Source: Osada et al. 2002.
Result<ShapeDistributions> shapeDistributions(Context& context, const SurfacePoints& points);

}  // namespace moduli
