#include "core/spherical/point_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace moduli::spherical {

PointTree::PointTree(std::vector<Eigen::Vector3d> points)
    : points_(std::move(points)), order_(points_.size()), axis_(points_.size(), 0) {
  std::iota(order_.begin(), order_.end(), 0);
  split(0, static_cast<Index>(order_.size()));
}

void PointTree::split(Index begin, Index end) {
  if (end - begin < 2) return;
  Eigen::AlignedBox3d box;
  for (Index i = begin; i < end; ++i) box.extend(points_[order_[i]]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const Index middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](Index a, Index b) { return points_[a][axis] < points_[b][axis]; });
  axis_[middle] = static_cast<signed char>(axis);
  split(begin, middle);
  split(middle + 1, end);
}

void PointTree::search(Index begin, Index end, const Eigen::Vector3d& query, double& best2,
                       Index& best) const {
  if (begin >= end) return;
  const Index middle = begin + (end - begin) / 2;
  const Eigen::Vector3d& point = points_[order_[middle]];
  const double distance2 = (point - query).squaredNorm();
  if (distance2 < best2) {
    best2 = distance2;
    best = order_[middle];
  }
  const double off = query[axis_[middle]] - point[axis_[middle]];
  const std::pair<Index, Index> below(begin, middle), above(middle + 1, end);
  const auto& near = off < 0 ? below : above;
  const auto& far = off < 0 ? above : below;
  search(near.first, near.second, query, best2, best);
  if (off * off < best2) search(far.first, far.second, query, best2, best);
}

Index PointTree::nearest(const Eigen::Vector3d& query) const {
  double best2 = std::numeric_limits<double>::infinity();
  Index best = kNone;
  search(0, static_cast<Index>(order_.size()), query, best2, best);
  return best;
}

}  // namespace moduli::spherical
