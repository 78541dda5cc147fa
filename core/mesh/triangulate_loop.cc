#include "core/mesh/triangulate_loop.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace moduli {
namespace {

constexpr double kImpossible = std::numeric_limits<double>::infinity();

// A triangle's cost is the square of its longest edge times (that square over its area): in squared
// length, least for equilateral ones. The cap keeps degenerate ones comparable with each other.
constexpr double kThinnest = 1e6;
// A fold by 180 degrees at an edge costs as much as this many squares over the edge, twice.
constexpr double kBendWeight = 8;

// Moved to the first point and scaled by a power of two, so that fourth powers of lengths stay
// within the range of doubles and nothing but the move is rounded.
std::vector<Eigen::Vector3d> inUnitBox(std::vector<Eigen::Vector3d> points) {
  const Eigen::Vector3d origin = points[0];
  double size = 0;
  for (Eigen::Vector3d& p : points) {
    p -= origin;
    size = std::max(size, p.lpNorm<Eigen::Infinity>());
  }
  int exponent = 0;
  std::frexp(size, &exponent);
  for (Eigen::Vector3d& p : points) {
    for (double& x : p) x = std::ldexp(x, -exponent);
  }
  return points;
}

class LoopFiller {
 public:
  LoopFiller(const SpaceLoop& loop, const std::function<bool(Index, Index)>& blocked)
      : loop_(loop),
        blocked_(blocked),
        n_(static_cast<Index>(loop.points.size())),
        points_(inUnitBox(loop.points)),
        best_(static_cast<std::size_t>(n_) * n_) {}

  Result<std::optional<std::vector<Triangle>>> run(Context& context) {
    for (Index i = 0; i + 1 < n_; ++i) best(i, i + 1) = {0, kNone, loop_.rim_normals[i]};
    for (Index span = 2; span < n_; ++span) {
      RETURN_IF_ERROR(context.check());
      for (Index i = 0; i + span < n_; ++i) solve(i, i + span);
    }
    if (best(0, n_ - 1).cost == kImpossible) return std::optional<std::vector<Triangle>>();
    return std::optional(collect());
  }

 private:
  // The cheapest filling of the polygon i, i + 1, ..., j, and its triangle at the edge (i, j).
  struct Filling {
    double cost = kImpossible;
    Index apex = kNone;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  };

  Filling& best(Index i, Index j) { return best_[static_cast<std::size_t>(i) * n_ + j]; }

  void solve(Index i, Index j) {
    const bool is_whole = i == 0 && j == n_ - 1;
    if (!is_whole && blocked_(i, j)) return;
    for (Index m = i + 1; m < j; ++m) {
      const Filling& left = best(i, m);
      const Filling& right = best(m, j);
      const double parts = left.cost + right.cost;
      if (!(parts < best(i, j).cost)) continue;
      Filling candidate = triangle(i, m, j);
      candidate.cost += parts + bend(i, m, candidate.normal, left.normal) +
                        bend(m, j, candidate.normal, right.normal);
      if (is_whole) candidate.cost += bend(i, j, candidate.normal, loop_.rim_normals[j]);
      if (candidate.cost < best(i, j).cost) best(i, j) = candidate;
    }
  }

  Filling triangle(Index i, Index m, Index j) const {
    const Eigen::Vector3d a = point(m) - point(i);
    const Eigen::Vector3d b = point(j) - point(i);
    const Eigen::Vector3d cross = a.cross(b);
    const double area = 0.5 * cross.norm();
    const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
    const double thinness = longest < kThinnest * area ? longest / area : kThinnest;
    const Eigen::Vector3d normal = area > 0 ? Eigen::Vector3d(cross / (2 * area)) : cross;
    return {longest * thinness, m, normal};
  }

  double bend(Index i, Index j, const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
    return kBendWeight * (point(j) - point(i)).squaredNorm() * (1 - a.dot(b));
  }

  std::vector<Triangle> collect() {
    std::vector<Triangle> triangles;
    std::vector<std::pair<Index, Index>> open = {{0, n_ - 1}};
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      const Index apex = best(i, j).apex;
      if (apex == kNone) continue;
      triangles.push_back({i, apex, j});
      open.emplace_back(apex, j);
      open.emplace_back(i, apex);
    }
    return triangles;
  }

  const Eigen::Vector3d& point(Index i) const { return points_[i]; }

  const SpaceLoop& loop_;
  const std::function<bool(Index, Index)>& blocked_;
  const Index n_;
  const std::vector<Eigen::Vector3d> points_;
  std::vector<Filling> best_;
};

}  // namespace

Result<std::optional<std::vector<Triangle>>> triangulateLoop(
    Context& context, const SpaceLoop& loop, const std::function<bool(Index, Index)>& blocked) {
  return LoopFiller(loop, blocked).run(context);
}

}  // namespace moduli
