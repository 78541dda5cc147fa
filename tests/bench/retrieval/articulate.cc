#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>
#include <vector>

#include "tests/bench/retrieval/deform.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr std::size_t kFewestLimbs = 3, kMostLimbs = 4;
constexpr double kMostStretch = 1.5;

// Distances along edges.
class EdgeGraph {
 public:
  explicit EdgeGraph(const TriangleSoup& soup) : neighbours_(soup.vertices.size()) {
    for (const Triangle& t : soup.faces) {
      for (int c = 0; c < 3; ++c) {
        const Index a = t[c], b = t[(c + 1) % 3];
        const double length = (soup.vertices[a] - soup.vertices[b]).norm();
        neighbours_[a].emplace_back(b, length);
        neighbours_[b].emplace_back(a, length);
      }
    }
  }

  // Per vertex from the nearest of the sources (Dijkstra).
  std::vector<double> distances(const std::vector<Index>& sources) const {
    std::vector<double> distance(neighbours_.size(), kFar);
    std::priority_queue<std::pair<double, Index>, std::vector<std::pair<double, Index>>,
                        std::greater<>>
        queue;
    for (const Index s : sources) {
      distance[s] = 0;
      queue.emplace(0, s);
    }
    while (!queue.empty()) {
      const auto [so_far, v] = queue.top();
      queue.pop();
      if (so_far > distance[v]) continue;
      for (const auto& [u, length] : neighbours_[v]) {
        if (so_far + length >= distance[u]) continue;
        distance[u] = so_far + length;
        queue.emplace(distance[u], u);
      }
    }
    return distance;
  }

 private:
  std::vector<std::vector<std::pair<Index, double>>> neighbours_;
};

Index farthest(const std::vector<double>& distance) {
  return static_cast<Index>(std::max_element(distance.begin(), distance.end()) - distance.begin());
}

// What turns, about where, and by how much.
struct Limb {
  std::vector<double> weight;  ///< Per vertex, 1 within the limb, 0 outside.
  Vector3d joint;
  Vector3d axis;
  double angle = 0;
};

// The limb of a tip: within `reach` of it. Nothing if no vertex lies at its end.
Limb limbOf(const TriangleSoup& soup, const std::vector<double>& from_tip, Index tip, double reach,
            SampleRandom& random) {
  constexpr double kSoftness = 0.35;
  Limb limb;
  limb.joint = Vector3d::Zero();
  double ring = 0;
  for (std::size_t v = 0; v < from_tip.size(); ++v) {
    const double t = (from_tip[v] / reach - 1) / kSoftness;  // -1 .. 1 where the turn sets in.
    const double s = std::clamp((1 - t) / 2, 0.0, 1.0);
    limb.weight.push_back(s * s * (3 - 2 * s));
    const double near = std::max(0.0, 1 - std::abs(t));
    limb.joint += near * soup.vertices[v];
    ring += near;
  }
  limb.joint = ring > 0 ? Vector3d(limb.joint / ring) : soup.vertices[tip];
  const Vector3d bone = soup.vertices[tip] - limb.joint;
  limb.axis = bone.cross(random.inBall()).normalized();
  limb.angle = (25 + 15 * random.uniform()) * std::numbers::pi / 180;
  return limb;
}

std::vector<Limb> findLimbs(const TriangleSoup& soup, SampleRandom& random) {
  const EdgeGraph graph(soup);
  std::vector<Index> tips = {
      farthest(graph.distances({static_cast<Index>(random.next() % soup.vertices.size())}))};
  const std::size_t count = kFewestLimbs + random.next() % (kMostLimbs - kFewestLimbs + 1);
  while (tips.size() < count) tips.push_back(farthest(graph.distances(tips)));
  std::vector<Limb> limbs;
  for (const Index tip : tips) {
    const std::vector<double> from_tip = graph.distances({tip});
    double nearest_tip = kFar;
    for (const Index other : tips) {
      if (other != tip) nearest_tip = std::min(nearest_tip, from_tip[other]);
    }
    limbs.push_back(limbOf(soup, from_tip, tip, 0.36 * nearest_tip, random));
  }
  return limbs;
}

TriangleSoup turned(const TriangleSoup& soup, const std::vector<Limb>& limbs, double share) {
  TriangleSoup result = soup;
  for (const Limb& limb : limbs) {
    for (std::size_t v = 0; v < result.vertices.size(); ++v) {
      if (limb.weight[v] == 0) continue;
      const Eigen::AngleAxisd turn(share * limb.weight[v] * limb.angle, limb.axis);
      result.vertices[v] = limb.joint + turn * (result.vertices[v] - limb.joint);
    }
  }
  return result;
}

// The stretch (or its inverse) that one edge in fifty exceeds.
double stretch(const TriangleSoup& before, const TriangleSoup& after) {
  std::vector<double> factors;
  for (const Triangle& t : before.faces) {
    for (int c = 0; c < 3; ++c) {
      const Index a = t[c], b = t[(c + 1) % 3];
      const double length = (before.vertices[a] - before.vertices[b]).norm();
      if (length == 0) continue;
      const double factor = (after.vertices[a] - after.vertices[b]).norm() / length;
      factors.push_back(std::max(factor, 1 / factor));
    }
  }
  const auto place = factors.begin() + static_cast<std::ptrdiff_t>(factors.size() * 49 / 50);
  std::nth_element(factors.begin(), place, factors.end());
  return *place;
}

}  // namespace

TriangleSoup articulated(const TriangleSoup& soup, SampleRandom& random) {
  const std::vector<Limb> limbs = findLimbs(soup, random);
  double share = 1;
  TriangleSoup result = turned(soup, limbs, share);
  while (stretch(soup, result) > kMostStretch) {
    share *= 0.8;
    result = turned(soup, limbs, share);
  }
  return result;
}

}  // namespace moduli
