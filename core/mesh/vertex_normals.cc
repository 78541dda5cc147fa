#include "core/mesh/vertex_normals.h"

#include <Eigen/Geometry>
#include <cmath>

namespace moduli {

std::vector<Eigen::Vector3d> vertexNormals(const Connectivity& surface,
                                           const std::vector<Eigen::Vector3d>& positions) {
  std::vector<Eigen::Vector3d> normals(positions.size(), Eigen::Vector3d::Zero());
  for (const Triangle& face : surface.faces()) {
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d& here = positions[face[c]];
      const Eigen::Vector3d to_next = positions[face[(c + 1) % 3]] - here,
                            to_last = positions[face[(c + 2) % 3]] - here;
      const Eigen::Vector3d normal = to_next.cross(to_last);
      const double angle = std::atan2(normal.norm(), to_next.dot(to_last));
      normals[face[c]] += angle * normal.stableNormalized();
    }
  }
  for (Eigen::Vector3d& normal : normals) normal = normal.stableNormalized();
  return normals;
}

}  // namespace moduli
