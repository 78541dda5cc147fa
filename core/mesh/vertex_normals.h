#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/connectivity.h"

namespace moduli {

/// Which way a surface looks at its vertices: the mean of the normals of the faces around each,
/// weighted by their angles there, so that it does not matter how a flat part is cut into faces
/// (Thürmer and Wüthrich 1998). Of length 1; 0 where they cancel or no face has an area. positions:
/// per vertex. O(F).
std::vector<Eigen::Vector3d> vertexNormals(const Connectivity& surface,
                                           const std::vector<Eigen::Vector3d>& positions);

}  // namespace moduli
