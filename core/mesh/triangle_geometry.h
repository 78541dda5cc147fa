#pragma once

#include <Eigen/Geometry>
#include <algorithm>

namespace moduli {

/// Size and thinness of a triangle in space.
struct TriangleShape {
  double area = 0;           ///< In squared model units.
  double relative_area = 0;  ///< Area over the square of the longest edge: 0 to sqrt(3)/4.
};

/// Below this relative area a face counts as having none: it is what rounding leaves of the cross
/// product of collinear edges, with two digits to spare.
inline constexpr double kZeroRelativeArea = 1e-14;

/// Finite corners. Scaled by the triangle's own size first, so that tiny and huge models neither
/// underflow nor overflow.
inline TriangleShape triangleShape(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                   const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a;
  const Eigen::Vector3d ac = c - a;
  const double scale = std::max(ab.lpNorm<Eigen::Infinity>(), ac.lpNorm<Eigen::Infinity>());
  if (scale == 0) return {};
  const Eigen::Vector3d u = ab / scale;
  const Eigen::Vector3d w = ac / scale;
  const double area = 0.5 * u.cross(w).norm();
  const double longest = std::max({u.squaredNorm(), w.squaredNorm(), (w - u).squaredNorm()});
  return {area * scale * scale, area / longest};
}

}  // namespace moduli
