#include "core/matching/disk_rim.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/spherical/exact_sign.h"

namespace moduli {
namespace {

/// 1 where b is less than half a turn ahead of a, exactly.
int turn(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return spherical::orientationSign(a, b, Eigen::Vector3d::UnitZ());
}

double cross(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double angleFrom(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double angle = std::atan2(cross(a, b), a.head<2>().dot(b.head<2>()));
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

}  // namespace

DiskRim::DiskRim(const Connectivity& capped, const Points3& points,
                 const std::vector<Eigen::Vector3d>& positions)
    : edge_of_(capped.faceCount(), kNone) {
  const Index pole = capped.vertexCount() - 1;
  // Around the pole the caps' faces follow each other clockwise, seen from the north.
  Index spoke = capped.outgoing(pole);
  do {
    halfedges_.push_back(capped.twin(Connectivity::next(spoke)));
    spoke = capped.rotate(spoke);
  } while (spoke != capped.outgoing(pole));
  std::reverse(halfedges_.begin(), halfedges_.end());
  begin_.push_back(0);
  for (Index i = 0; i < size(); ++i) {
    const Index tail = capped.tail(halfedges_[i]), head = capped.head(halfedges_[i]);
    edge_of_[Connectivity::faceOf(halfedges_[i])] = i;
    tails_.push_back(points[tail]);
    angles_.push_back(i == 0 ? 0 : angleFrom(tails_[0], tails_[i]));
    begin_.push_back(begin_.back() + (positions[head] - positions[tail]).norm());
  }
}

SurfacePoint DiskRim::at(const Eigen::Vector3d& direction) const {
  const double angle = angleFrom(tails_[0], direction);
  const auto after = std::upper_bound(angles_.begin(), angles_.end(), angle);
  Index i = static_cast<Index>(after - angles_.begin()) - 1;
  const auto ahead = [&](Index k) { return k + 1 == size() ? 0 : k + 1; };
  const auto behind = [&](Index k) { return k == 0 ? size() - 1 : k - 1; };
  i = std::clamp<Index>(i, 0, size() - 1);
  for (Index step = 0; step < size(); ++step) {
    if (turn(tails_[i], direction) < 0) {
      i = behind(i);
    } else if (turn(direction, tails_[ahead(i)]) < 0) {
      i = ahead(i);
    } else {
      break;
    }
  }
  const double from = std::max(0.0, cross(tails_[i], direction));
  const double to = std::max(0.0, cross(direction, tails_[ahead(i)]));
  return edgePoint(halfedges_[i], from + to > 0 ? from / (from + to) : 0.0);
}

double DiskRim::place(const SurfacePoint& point) const {
  const Index i = edge_of_[point.face];
  const double t = point.barycentric[Connectivity::next(halfedges_[i]) % 3];
  return begin_[i] + t * (begin_[i + 1] - begin_[i]);
}

SurfacePoint DiskRim::atPlace(double place) const {
  double rest = std::fmod(place, length());
  if (rest < 0) rest += length();
  const auto after = std::upper_bound(begin_.begin(), begin_.end(), rest);
  const Index i = std::clamp<Index>(static_cast<Index>(after - begin_.begin()) - 1, 0, size() - 1);
  const double whole = begin_[i + 1] - begin_[i];
  const double t = whole > 0 ? (rest - begin_[i]) / whole : 0;
  return edgePoint(halfedges_[i], std::clamp(t, 0.0, 1.0));
}

}  // namespace moduli
