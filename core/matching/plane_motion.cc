#include "core/matching/plane_motion.h"

#include <cmath>

namespace moduli {

using Eigen::Vector2d;
using Eigen::Vector3d;

Motion CoverPlane::inverse(const Motion& motion) const {
  Motion result;
  if (is_flat_) {
    const Eigen::Matrix2d back = motion.topLeftCorner<2, 2>().transpose();
    result.topLeftCorner<2, 2>() = back;
    result.topRightCorner<2, 1>() = -back * motion.topRightCorner<2, 1>();
    result.bottomRows<1>() << 0, 0, 1;
    return result;
  }
  result = motion.transpose();
  result.topRightCorner<2, 1>() *= -1;
  result.bottomLeftCorner<1, 2>() *= -1;
  return result;
}

Motion CoverPlane::shift(const Vector2d& way) const {
  Motion result = Motion::Identity();
  if (is_flat_) {
    result.topRightCorner<2, 1>() = way;
    return result;
  }
  const double length = way.norm();
  if (!(length > 0)) return result;
  const Vector2d along = way / length;
  const double half = std::sinh(length / 2);
  result.topLeftCorner<2, 2>() += 2 * half * half * along * along.transpose();
  result.topRightCorner<2, 1>() = std::sinh(length) * along;
  result.bottomLeftCorner<1, 2>() = std::sinh(length) * along.transpose();
  result(2, 2) = std::cosh(length);
  return result;
}

Motion CoverPlane::turn(double angle) {
  Motion result = Motion::Identity();
  result.topLeftCorner<2, 2>() << std::cos(angle), -std::sin(angle), std::sin(angle),
      std::cos(angle);
  return result;
}

Vector2d CoverPlane::wayTo(const Vector3d& point) const {
  const Vector2d flat = point.head<2>();
  const double radius = flat.norm();
  if (is_flat_ || !(radius > 0)) return flat;
  return flat * (std::asinh(radius) / radius);
}

Vector3d CoverPlane::pointAt(const Vector2d& way) const {
  const double length = way.norm();
  if (is_flat_ || !(length > 0)) return {way[0], way[1], 1};
  const Vector2d flat = way * (std::sinh(length) / length);
  return {flat[0], flat[1], std::cosh(length)};
}

Vector3d CoverPlane::normalized(const Vector3d& vector) const {
  if (is_flat_) return vector / vector[2];
  const double radius = vector.head<2>().norm();
  const double scale = 1 / std::sqrt((vector[2] - radius) * (vector[2] + radius));
  Vector3d result = vector * scale;
  result[2] = std::hypot(1.0, result.head<2>().norm());
  return result;
}

Motion CoverPlane::normalized(const Motion& motion) const {
  const auto rotation = [](const Motion& turned) {
    const Vector2d axis(turned(0, 0) + turned(1, 1), turned(1, 0) - turned(0, 1));
    const Vector2d unit = axis.normalized();
    Motion result = Motion::Identity();
    result.topLeftCorner<2, 2>() << unit[0], -unit[1], unit[1], unit[0];
    return result;
  };
  if (is_flat_) {
    Motion result = rotation(motion);
    result.topRightCorner<2, 1>() = motion.topRightCorner<2, 1>();
    return result;
  }
  const Motion there = shift(wayTo(motion.col(2)));
  return there * rotation(inverse(there) * motion);
}

double CoverPlane::area(const Vector3d& p, const Vector3d& q) const {
  const double cross = p[0] * q[1] - p[1] * q[0];
  if (is_flat_) return cross / 2;
  return 2 * std::atan2(cross, (1 + p[2]) * (1 + q[2]) - p.head<2>().dot(q.head<2>()));
}

}  // namespace moduli
