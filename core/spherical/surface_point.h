#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/mobius.h"

namespace moduli {

/// A point of a surface: in a face, with the weights of its three corners (>= 0, sum 1).
struct SurfacePoint {
  Index face = 0;
  std::array<double, 3> barycentric = {1, 0, 0};
};

/// Vertex v as a point of one of its faces. v: a vertex of the surface. O(1).
SurfacePoint vertexPoint(const Connectivity& surface, Index v);

/// The point at fraction t (0 at its tail, 1 at its head) of halfedge h. O(1).
SurfacePoint edgePoint(Index h, double t);

/// Fails with kInvalidOption, calling the point by `name`, unless its face exists and its weights
/// are finite, at least -1e-12 and of sum 1 to 1e-9.
Status checkSurfacePoint(const Connectivity& surface, const SurfacePoint& point,
                         const std::string& name);

/// Where a point goes under a map to the sphere: the combination of its corners, brought to the
/// unit sphere. points: per vertex, unit vectors; a face lies in an open half sphere.
Eigen::Vector3d spherePoint(const Connectivity& surface, const Points3& points,
                            const SurfacePoint& point);

}  // namespace moduli
