#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/mesh/connectivity.h"
#include "core/spherical/surface_point.h"

namespace moduli {

/// Straight ways over a surface in space. Refers to the connectivity, which must live as long; safe
/// to read from several threads.
class SurfaceWalk {
 public:
  /// positions: per vertex. unit: > 0; lengths are counted in it. pole: a vertex whose faces no way
  /// enters, if any.
  SurfaceWalk(const Connectivity& surface, const std::vector<Eigen::Vector3d>& positions,
              double unit, Index pole = kNone);

  /// Told of every halfedge that is crossed, as the face that is left has it.
  using Crossing = std::function<void(Index halfedge)>;

  /// Straight on from `start`: in the plane of its face by the component of `motion` there, across
  /// edges as if the next face were unfolded into the plane. Ends early after `longest` edges, at a
  /// face without area and before the pole's faces. O(edges).
  SurfacePoint operator()(const SurfacePoint& start, const Eigen::Vector3d& motion,
                          int longest = 256, const Crossing& crossing = {}) const;

  /// In the unit.
  const std::vector<Eigen::Vector3d>& positions() const { return positions_; }
  Eigen::Vector3d place(const SurfacePoint& point) const;
  /// Unit normal of a face; 0 where it has no area.
  const Eigen::Vector3d& normal(Index face) const { return normals_[face]; }

 private:
  const Connectivity& surface_;
  Index pole_;
  std::vector<Eigen::Vector3d> positions_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<double> twice_areas_;
};

}  // namespace moduli
