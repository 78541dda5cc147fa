#include "core/spherical/sphere_locator.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/spherical/exact_sign.h"

namespace moduli {
namespace {

/// Six times the volume of the tetrahedron with the origin; well kept where the three are near to
/// each other.
double volume(const Eigen::Vector3d& q, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return q.dot((a - q).cross(b - q));
}

/// Of length 1 to rounding; a unit vector keeps its last digits, so that a vertex finds itself.
Eigen::Vector3d unit(const Eigen::Vector3d& v) {
  return std::abs(v.squaredNorm() - 1) < 1e-14 ? v : v.normalized();
}

}  // namespace

Result<SphereLocator> SphereLocator::make(const Connectivity& surface, Points3 points) {
  if (points.size() != static_cast<std::size_t>(surface.vertexCount())) {
    return Status(Reason::kInvalidOption, "a map to the sphere needs one point for every vertex");
  }
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (surface.isBoundaryEdge(e)) {
      return Status(Reason::kUnsupportedTopology, "a map to the sphere needs a closed surface");
    }
  }
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto& [a, b, c] = surface.face(f);
    if (spherical::orientationSign(points[a], points[b], points[c]) <= 0) {
      return Status(Reason::kFoldedMap, "the map to the sphere folds at face " + std::to_string(f));
    }
  }
  return SphereLocator(surface, std::move(points));
}

bool SphereLocator::isInside(Index face, int c, const Eigen::Vector3d& direction) const {
  const Triangle& corner = surface_.face(face);
  return spherical::orientationSign(points_[corner[c]], points_[corner[(c + 1) % 3]], direction) >=
         0;
}

SurfacePoint SphereLocator::weigh(Index face, const Eigen::Vector3d& direction) const {
  const auto& [a, b, c] = surface_.face(face);
  const std::array<const Eigen::Vector3d*, 3> p = {&points_[a], &points_[b], &points_[c]};
  SurfacePoint point{face, {0, 0, 0}};
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    if (direction == *p[i]) {
      point.barycentric[i] = 1;
      return point;
    }
  }
  for (int i = 0; i < 3; ++i) {
    point.barycentric[i] = std::max(0.0, volume(direction, *p[(i + 1) % 3], *p[(i + 2) % 3]));
    sum += point.barycentric[i];
  }
  for (double& weight : point.barycentric) weight = sum > 0 ? weight / sum : 1.0 / 3;
  return point;
}

SurfacePoint SphereLocator::locate(const Eigen::Vector3d& given) const {
  const Eigen::Vector3d direction = unit(given);
  const Index start = tree_.nearest(direction);
  Index face = Connectivity::faceOf(surface_.outgoing(start));
  if (direction == points_[start]) return weigh(face, direction);
  const Index longest_walk = 64 + surface_.faceCount() / 16;
  for (Index step = 0; step < longest_walk; ++step) {
    // Sides in another order at every step: a walk that always leaves by the first side that will
    // do can circle for ever.
    Index leave = kNone;
    for (int i = 0; i < 3 && leave == kNone; ++i) {
      const int c = (i + step) % 3;
      if (!isInside(face, c, direction)) leave = 3 * face + c;
    }
    if (leave == kNone) return weigh(face, direction);
    face = Connectivity::faceOf(surface_.twin(leave));
  }
  return locateSlowly(given);
}

SurfacePoint SphereLocator::locateSlowly(const Eigen::Vector3d& given) const {
  const Eigen::Vector3d direction = unit(given);
  for (Index face = 0; face < surface_.faceCount(); ++face) {
    if (isInside(face, 0, direction) && isInside(face, 1, direction) &&
        isInside(face, 2, direction)) {
      return weigh(face, direction);
    }
  }
  return weigh(0, direction);  // Not for a bijective map.
}

}  // namespace moduli
