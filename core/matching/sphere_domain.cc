#include "core/matching/sphere_domain.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace moduli {

SphereDomain::SphereDomain(const SphereLocator& sphere,
                           const std::vector<Eigen::Vector3d>& positions, double unit, Index pole)
    : sphere_(sphere), pole_(pole), positions_(positions) {
  for (Eigen::Vector3d& p : positions_) p /= unit;
  normals_.reserve(sphere.surface().faceCount());
  twice_areas_.reserve(sphere.surface().faceCount());
  for (const auto& [a, b, c] : sphere.surface().faces()) {
    const Eigen::Vector3d normal =
        (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]);
    twice_areas_.push_back(normal.norm());
    normals_.push_back(twice_areas_.back() > 0 ? Eigen::Vector3d(normal / twice_areas_.back())
                                               : Eigen::Vector3d::Zero());
  }
  if (pole_ != kNone) rim_.emplace(sphere.surface(), sphere.points(), positions_);
}

Image SphereDomain::at(const SurfacePoint& point) const {
  Image image{point, Eigen::Vector3d::Zero(),
              spherePoint(sphere_.surface(), sphere_.points(), point)};
  const Triangle& face = sphere_.surface().face(point.face);
  for (int c = 0; c < 3; ++c) image.space += point.barycentric[c] * positions_[face[c]];
  return image;
}

Image SphereDomain::at(const Eigen::Vector3d& direction) const {
  Image image = at(sphere_.locate(direction));
  const bool is_unit = std::abs(direction.squaredNorm() - 1) < 1e-14;
  image.direction = is_unit ? direction : direction.normalized();
  return image;
}

Image SphereDomain::walk(const Image& start, const Eigen::Vector3d& motion, int longest) const {
  const Connectivity& surface = sphere_.surface();
  SurfacePoint here = start.point;
  Eigen::Vector3d left = motion;
  int entered = -1;  // The side just crossed, which is not crossed back.
  for (int crossed = 0;; ++crossed) {
    const Triangle& face = surface.face(here.face);
    const double twice_area = twice_areas_[here.face];
    if (!(twice_area > 0)) break;
    const Eigen::Vector3d& normal = normals_[here.face];
    // How the weights change along `left`, and which of them is the first to end.
    std::array<double, 3> rate{};
    double fraction = 1;
    int leave = -1;
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d side = positions_[face[(c + 2) % 3]] - positions_[face[(c + 1) % 3]];
      rate[c] = normal.cross(side).dot(left) / twice_area;
      if (c == entered || !(rate[c] < 0)) continue;
      const double end = here.barycentric[c] / -rate[c];
      if (end < fraction) {
        fraction = end;
        leave = c;
      }
    }
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      here.barycentric[c] =
          c == leave ? 0 : std::max(0.0, here.barycentric[c] + fraction * rate[c]);
      sum += here.barycentric[c];
    }
    for (double& weight : here.barycentric) weight /= sum;
    if (leave < 0 || crossed == longest) break;
    left *= 1 - fraction;
    const Index h = 3 * here.face + (leave + 1) % 3;  // The side opposite the corner `leave`.
    const Index twin = surface.twin(h);
    if (pole_ != kNone && surface.tail(Connectivity::previous(twin)) == pole_) break;
    const Eigen::Vector3d along = (positions_[surface.head(h)] - positions_[surface.tail(h)]);
    const double length = along.norm();
    if (!(length > 0)) break;
    const Eigen::Vector3d axis = along / length;
    const Index next = Connectivity::faceOf(twin);
    // Outwards here and inwards there are the same direction of the unfolded plane.
    const double outwards = axis.cross(normal).dot(left);
    left = axis.dot(left) * axis + outwards * axis.cross(normals_[next]);
    SurfacePoint there{next, {0, 0, 0}};
    there.barycentric[twin % 3] = here.barycentric[(leave + 2) % 3];
    there.barycentric[Connectivity::next(twin) % 3] = here.barycentric[(leave + 1) % 3];
    entered = Connectivity::previous(twin) % 3;
    here = there;
  }
  return at(here);
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
  return (positions_[surface.head(h)] - positions_[surface.tail(h)]).stableNormalized();
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
