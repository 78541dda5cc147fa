#pragma once

#include <array>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/triangle_mesh.h"

namespace moduli {

/// Principal curvatures at vertices of a surface that heat flow has smoothed. Positive where it
/// is convex as seen from the side that its faces look to.
struct SmoothedCurvatures {
  std::vector<double> first, second;  ///< k1 >= k2, times the radius given.
  std::vector<double> areas;          ///< Of the vertices on the smoothed surface, sum 1.
};

/// Times of the flow in units of the area: it smooths over about sqrt(2 t) sqrt(area).
inline constexpr std::array<double, 2> kSmoothingTimes = {0.0004, 0.0025};

/// One result per time. Both the positions and then the curvature tensors of the edges, length
/// times dihedral angle times the square of the direction (Cohen-Steiner and Morvan 2003), take one
/// implicit step (M + t L) x = M b of the heat equation, so that noise neither bends the surface
/// nor makes it larger; the curvatures are those of the tensor across the normal. Faces with edges
/// longer than the flow smooths over are cut into smaller ones first, so that the result belongs to
/// the polyhedral surface and not to its mesh. lengths: per edge, proper triangles. radius: the
/// length that makes curvatures free of scale, in model units. Fails as SpdSolver does. About 1.3 F
/// a time, at least some 30 ms.
Result<std::vector<SmoothedCurvatures>> smoothedCurvatures(Context& context,
                                                           const TriangleMesh& mesh,
                                                           const std::vector<double>& lengths,
                                                           double radius);

/// Soft bins of the joint distribution of shape index and curvedness (Koenderink, van Doorn 1992),
/// by area: one for what is flat, then kCurvednessRings rings by log(1 + curvedness), which is log
/// 2 on a sphere, each with five shape indices from -1 (cup) to 1 (cap). Sum 1. Continuous where
/// flat points have no index.
inline constexpr int kCurvednessRings = 6;
inline constexpr int kShapeIndexBins = 1 + 5 * kCurvednessRings;
std::vector<double> shapeIndexHistogram(const SmoothedCurvatures& curvatures);

}  // namespace moduli
