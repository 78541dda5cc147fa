#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace moduli {

/// Weighted points that stand for the area of a surface, free of scale and position, and as even on
/// few large faces as on many small ones.
struct SurfacePoints {
  Eigen::Matrix3Xd points;    ///< From the centroid, in units of sqrt(area).
  Eigen::Matrix3Xd normals;   ///< Unit, of the face.
  std::vector<double> areas;  ///< Sum 1.
  double radius = 0;          ///< Root mean square distance from the centroid: of gyration.
  double unit = 0;            ///< sqrt(area) in model units.
};

/// The centroids of all faces; faces longer than kPointSpacing sqrt(area) are cut into small ones.
/// Faces without area are left out. The order of the points is that of the faces, their places are
/// those of the surface. mesh: some area. At most F + 4000 points on faces of sound shape, and
/// never more than 4 F + 10^5. O(F).
inline constexpr double kPointSpacing = 0.06;
SurfacePoints surfacePoints(const TriangleMesh& mesh);

}  // namespace moduli
