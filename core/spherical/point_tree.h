#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/triangle_soup.h"

namespace moduli::spherical {

/// A k-d tree of points in space, for the nearest one. Internal to this room. Keeps a copy of the
/// points; safe to read from several threads. O(n log n) to build.
class PointTree {
 public:
  explicit PointTree(std::vector<Eigen::Vector3d> points);

  /// The index of the nearest point; of equal distances any one. kNone in an empty tree.
  /// O(log n) on surfaces.
  Index nearest(const Eigen::Vector3d& query) const;

 private:
  void split(Index begin, Index end);
  void search(Index begin, Index end, const Eigen::Vector3d& query, double& best2,
              Index& best) const;

  std::vector<Eigen::Vector3d> points_;
  std::vector<Index> order_;       ///< The middle of a range divides the rest of it.
  std::vector<signed char> axis_;  ///< Per place in order_, the coordinate that it divides by.
};

}  // namespace moduli::spherical
