#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/connectivity.h"
#include "core/spherical/surface_point.h"

namespace moduli {

/// The boundary of a disk that is mapped to the northern half of the sphere, boundary on the
/// equator, and closed by a cap: a vertex at the south pole, the last one, joined to the whole
/// boundary by faces behind all others. Vertices of the boundary have height 0 to the last bit.
///
/// Refers to nothing; safe to read from several threads.
class DiskRim {
 public:
  /// capped, points: per vertex, as above; no two vertices of the boundary at one place, and all of
  /// them counter-clockwise. positions: per vertex; for lengths. O(n).
  DiskRim(const Connectivity& capped, const Points3& points,
          const std::vector<Eigen::Vector3d>& positions);

  Index size() const { return static_cast<Index>(halfedges_.size()); }
  /// The halfedges of the disk's faces along the boundary, counter-clockwise.
  Index halfedge(Index i) const { return halfedges_[i]; }
  /// How far the tail of halfedge i is from that of the first, along the boundary in space.
  double begin(Index i) const { return begin_[i]; }
  double length() const { return begin_.back(); }

  /// The point of the boundary above which or below which a direction points. Its first two
  /// coordinates are not both 0. O(log n); exact sides.
  SurfacePoint at(const Eigen::Vector3d& direction) const;

  /// Where a point of the boundary is, from 0 to length(). point: in a face with an edge on the
  /// boundary, and on that edge.
  double place(const SurfacePoint& point) const;

  /// The point there; places that differ by the length are one.
  SurfacePoint atPlace(double place) const;

  /// Which halfedge the point is on; as for place().
  Index edgeOf(const SurfacePoint& point) const { return edge_of_[point.face]; }

 private:
  std::vector<Index> halfedges_;
  std::vector<double> begin_;   ///< And the length at last.
  Points3 tails_;               ///< On the equator.
  std::vector<double> angles_;  ///< Of the tails from the first, ascending but for rounding.
  std::vector<Index> edge_of_;  ///< Per face; kNone elsewhere.
};

}  // namespace moduli
