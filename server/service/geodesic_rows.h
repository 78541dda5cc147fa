#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/mesh/connectivity.h"
#include "core/parameterize/parameterization.h"

namespace moduli {

/// Rows of the array GEODESICS: x y z of the point where a closed geodesic enters a face, u v of
/// its image and of that of the point where it leaves.
using GeodesicRow = std::array<double, 7>;

/// The geodesics of a map to the Poincaré disk, one after the other. surface: as it was mapped;
/// positions: of its vertices; none: x y z are 0. O(steps).
std::vector<GeodesicRow> geodesicRows(const Connectivity& surface,
                                      const std::vector<Eigen::Vector3d>& positions,
                                      const Parameterization& map);

}  // namespace moduli
