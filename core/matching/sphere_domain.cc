#include "core/matching/sphere_domain.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace moduli {

SphereDomain::SphereDomain(const SphereLocator& sphere,
                           const std::vector<Eigen::Vector3d>& positions, double unit, Index pole)
    : sphere_(sphere), pole_(pole), walk_(sphere.surface(), positions, unit, pole) {
  if (pole_ != kNone) rim_.emplace(sphere.surface(), sphere.points(), walk_.positions());
}

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

Image SphereDomain::onRim(const Eigen::Vector3d& direction) const {
  Image image = at(rim_->at(direction));
  const Eigen::Vector3d level(direction.x(), direction.y(), 0);
  const bool is_unit = std::abs(level.squaredNorm() - 1) < 1e-14;
  image.direction = is_unit ? level : level.normalized();
  return image;
}

Image SphereDomain::walkRim(const Image& start, double length) const {
  return at(rim_->atPlace(rim_->place(start.point) + length));
}

Eigen::Vector3d SphereDomain::rimTangent(const Image& at) const {
  const Connectivity& surface = sphere_.surface();
  const Index h = rim_->halfedge(rim_->edgeOf(at.point));
  return (walk_.positions()[surface.head(h)] - walk_.positions()[surface.tail(h)])
      .stableNormalized();
}

double SphereDomain::rimWay(const Image& from, const Image& to) const {
  const double way = rim_->place(to.point) - rim_->place(from.point);
  return way < 0 ? way + rim_->length() : way;
}

double SphereDomain::clearance(const Image& a, const Image& b, const Image& c) {
  if (!isPositive(a, b, c)) return 0;
  const Eigen::Vector3d ab = b.direction - a.direction, ac = c.direction - a.direction;
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
  return std::max(a.direction.dot(ab.cross(ac)) / longest, std::numeric_limits<double>::min());
}

}  // namespace moduli
