#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace moduli {

/// Newton's step of a function of space in the plane of that normal (of length 1); 0 where the
/// Hessian is not positive definite there.
inline Eigen::Vector3d stepInPlane(const Eigen::Vector3d& normal, const Eigen::Vector3d& gradient,
                                   const Eigen::Matrix3d& hessian) {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  Eigen::Index least = 0;
  normal.cwiseAbs().minCoeff(&least);
  axis[least] = 1;
  Eigen::Matrix<double, 3, 2> tangent;
  tangent.col(0) = normal.cross(axis).normalized();
  tangent.col(1) = normal.cross(tangent.col(0));
  const Eigen::Matrix2d h = tangent.transpose() * hessian * tangent;
  const Eigen::Vector2d g = tangent.transpose() * gradient;
  const double determinant = h(0, 0) * h(1, 1) - h(0, 1) * h(1, 0);
  if (!(determinant > 0)) return Eigen::Vector3d::Zero();
  return tangent * Eigen::Vector2d((h(0, 1) * g[1] - h(1, 1) * g[0]) / determinant,
                                   (h(1, 0) * g[0] - h(0, 0) * g[1]) / determinant);
}

}  // namespace moduli
