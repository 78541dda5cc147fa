#include "core/matching/surface_walk.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace moduli {

SurfaceWalk::SurfaceWalk(const Connectivity& surface, const std::vector<Eigen::Vector3d>& positions,
                         double unit, Index pole)
    : surface_(surface), pole_(pole), positions_(positions) {
  for (Eigen::Vector3d& p : positions_) p /= unit;
  normals_.reserve(surface.faceCount());
  twice_areas_.reserve(surface.faceCount());
  for (const auto& [a, b, c] : surface.faces()) {
    const Eigen::Vector3d normal =
        (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]);
    twice_areas_.push_back(normal.norm());
    normals_.push_back(twice_areas_.back() > 0 ? Eigen::Vector3d(normal / twice_areas_.back())
                                               : Eigen::Vector3d::Zero());
  }
}

Eigen::Vector3d SurfaceWalk::place(const SurfacePoint& point) const {
  const Triangle& face = surface_.face(point.face);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) sum += point.barycentric[c] * positions_[face[c]];
  return sum;
}

SurfacePoint SurfaceWalk::operator()(const SurfacePoint& start, const Eigen::Vector3d& motion,
                                     int longest, const Crossing& crossing) const {
  SurfacePoint here = start;
  Eigen::Vector3d left = motion;
  int entered = -1;  // The side just crossed, which is not crossed back.
  for (int crossed = 0;; ++crossed) {
    const Triangle& face = surface_.face(here.face);
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
    const Index twin = surface_.twin(h);
    if (pole_ != kNone && surface_.tail(Connectivity::previous(twin)) == pole_) break;
    const Eigen::Vector3d along = (positions_[surface_.head(h)] - positions_[surface_.tail(h)]);
    const double length = along.norm();
    if (!(length > 0)) break;
    const Eigen::Vector3d axis = along / length;
    const Index next = Connectivity::faceOf(twin);
    if (crossing) crossing(h);
    // Outwards here and inwards there are the same direction of the unfolded plane.
    const double outwards = axis.cross(normal).dot(left);
    left = axis.dot(left) * axis + outwards * axis.cross(normals_[next]);
    SurfacePoint there{next, {0, 0, 0}};
    there.barycentric[twin % 3] = here.barycentric[(leave + 2) % 3];
    there.barycentric[Connectivity::next(twin) % 3] = here.barycentric[(leave + 1) % 3];
    entered = Connectivity::previous(twin) % 3;
    here = there;
  }
  return here;
}

}  // namespace moduli
