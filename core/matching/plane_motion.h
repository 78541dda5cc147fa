#pragma once

#include <Eigen/Core>

#include "core/intrinsic/geometry.h"

/// The flat and the hyperbolic plane in homogeneous vectors (x, y, t), and their isometries as
/// matrices: what covers of tori and of surfaces of more handles have in common.
///
/// Points are t = 1 in the flat plane and t^2 - x^2 - y^2 = 1, t > 0 in the hyperbolic one; (x / t,
/// y / t) is Klein's model, so that lines are straight in both. 0 is (0, 0, 1). Isometries keep
/// orientation. Rounding grows with e^d for distances d from 0: keep 0 near.
namespace moduli {

using Motion = Eigen::Matrix3d;

/// The plane of a geometry, kEuclidean or kHyperbolic.
class CoverPlane {
 public:
  explicit CoverPlane(Geometry geometry) : is_flat_(geometry == Geometry::kEuclidean) {}

  bool isFlat() const { return is_flat_; }
  Motion inverse(const Motion& motion) const;

  /// Carries 0 along `way` by its length, without turning.
  Motion shift(const Eigen::Vector2d& way) const;
  /// About 0, counter-clockwise, radians.
  static Motion turn(double angle);

  /// The direction from 0 to a point, as long as its distance.
  Eigen::Vector2d wayTo(const Eigen::Vector3d& point) const;
  Eigen::Vector3d pointAt(const Eigen::Vector2d& way) const;

  /// The point on the ray of a vector; the nearest isometry to a matrix that is nearly one.
  Eigen::Vector3d normalized(const Eigen::Vector3d& vector) const;
  Motion normalized(const Motion& motion) const;

  /// Signed area of the triangle 0, p, q.
  double area(const Eigen::Vector3d& p, const Eigen::Vector3d& q) const;

 private:
  bool is_flat_;
};

/// The largest change of an entry from the identity.
inline double distanceToUnit(const Motion& motion) {
  return (motion - Motion::Identity()).cwiseAbs().maxCoeff();
}

}  // namespace moduli
