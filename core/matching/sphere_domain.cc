#include "core/matching/sphere_domain.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace moduli {

SphereDomain::SphereDomain(const SphereLocator& sphere,
                           const std::vector<Eigen::Vector3d>& positions, double unit)
    : sphere_(sphere), walk_(sphere.surface(), positions, unit) {}

Image SphereDomain::at(const SurfacePoint& point) const {
  return {point, walk_.place(point), spherePoint(sphere_.surface(), sphere_.points(), point)};
}

Image SphereDomain::at(const Eigen::Vector3d& direction) const {
  Image image = at(sphere_.locate(direction));
  const bool is_unit = std::abs(direction.squaredNorm() - 1) < 1e-14;
  image.direction = is_unit ? direction : direction.normalized();
  return image;
}

Image SphereDomain::walk(const Image& start, const Eigen::Vector3d& motion, int longest) const {
  return at(walk_(start.point, motion, longest));
}

double SphereDomain::clearance(const Image& a, const Image& b, const Image& c) {
  if (!isPositive(a, b, c)) return 0;
  const Eigen::Vector3d ab = b.direction - a.direction, ac = c.direction - a.direction;
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
  return std::max(a.direction.dot(ab.cross(ac)) / longest, std::numeric_limits<double>::min());
}

}  // namespace moduli
