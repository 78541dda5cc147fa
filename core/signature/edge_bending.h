#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/connectivity.h"

namespace moduli {

/// How a surface bends across its edges.
struct EdgeBending {
  std::vector<Eigen::Vector3d> normals;  ///< Unit, per face; 0 where none can be had.
  std::vector<double> angles;  ///< Per edge in (-pi, pi], positive where convex; 0 on the boundary.
};

/// positions: one per vertex. A zero-area face has no normal, and needs none: it takes the normal
/// of the face across its longest edge. An edge folded flat onto itself counts as convex. O(F).
EdgeBending edgeBending(const Connectivity& surface, const std::vector<Eigen::Vector3d>& positions);

}  // namespace moduli
