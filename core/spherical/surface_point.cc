#include "core/spherical/surface_point.h"

#include <cmath>

namespace moduli {

SurfacePoint vertexPoint(const Connectivity& surface, Index v) {
  return edgePoint(surface.outgoing(v), 0);
}

SurfacePoint edgePoint(Index h, double t) {
  SurfacePoint point{Connectivity::faceOf(h), {0, 0, 0}};
  point.barycentric[h % 3] = 1 - t;
  point.barycentric[Connectivity::next(h) % 3] = t;
  return point;
}

Status checkSurfacePoint(const Connectivity& surface, const SurfacePoint& point,
                         const std::string& name) {
  if (point.face < 0 || point.face >= surface.faceCount()) {
    return {Reason::kInvalidOption, name + " is in face " + std::to_string(point.face) +
                                        ", but there are " + std::to_string(surface.faceCount()) +
                                        " faces"};
  }
  double sum = 0;
  for (const double weight : point.barycentric) {
    if (!(weight >= -1e-12)) {
      return {Reason::kInvalidOption,
              name + " leaves its face: a corner has weight " + std::to_string(weight)};
    }
    sum += weight;
  }
  if (!(std::abs(sum - 1) <= 1e-9)) {
    return {Reason::kInvalidOption,
            name + " has corner weights of sum " + std::to_string(sum) + ", not 1"};
  }
  return {};
}

Eigen::Vector3d spherePoint(const Connectivity& surface, const Points3& points,
                            const SurfacePoint& point) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) {
    // A corner itself comes back to the last bit.
    if (point.barycentric[c] == 1) return points[surface.face(point.face)[c]];
    sum += point.barycentric[c] * points[surface.face(point.face)[c]];
  }
  return sum.normalized();
}

}  // namespace moduli
