#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/surface_point.h"

namespace moduli {

/// A point of a disk, and where on the northern half of the sphere it is to go: a unit vector; on
/// the equator for points of the boundary, and for no others.
struct HemisphereMark {
  SurfacePoint point;
  Eigen::Vector3d target;
};

struct HemisphereFlow {
  Points3 points;   ///< No face folded, however far the marks came.
  bool met = true;  ///< To 1e-7 of the edges there.
  int steps = 0;
};

/// flowToLandmarks for disks: lets a map to the half sphere follow a smooth motion that carries the
/// marks to their targets along great circles, together with its mirror image below the equator,
/// which keeps the boundary there. It stops before a face folds.
///
/// surface, points: a disk closed by a cap, mapped as DiskRim has it; no face folded; the pole, the
/// last vertex, stays. Fails with kCancelled and kDeadlineExceeded. Stage "landmarks". O(steps
/// (marks V + marks^3)). Source: as flowToLandmarks.
Result<HemisphereFlow> flowOnHemisphere(Context& context, const Connectivity& surface,
                                        Points3 points, const std::vector<HemisphereMark>& marks);

}  // namespace moduli
