#include "core/parameterize/seams.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <queue>
#include <utility>

#include "core/forms/cotan.h"
#include "core/intrinsic/angles.h"
#include "core/mesh/disjoint_sets.h"

namespace moduli {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// The most that curvature adds to a length, as a multiple of it.
constexpr double kMostAdded = 10;

class SeamChoice {
 public:
  SeamChoice(const Connectivity& surface, const std::vector<double>& costs,
             const std::vector<bool>& through, const std::vector<bool>& given)
      : surface_(surface), costs_(costs), kept_(given), ends_(through) {
    kept_.resize(surface.edgeCount(), false);
    ends_.resize(surface.vertexCount(), false);
    for (Index e = 0; e < surface.edgeCount(); ++e) {
      if (surface.isBoundaryEdge(e)) kept_[e] = true;
      if (kept_[e]) ends_[tail(e)] = ends_[head(e)] = true;
    }
  }

  std::vector<bool> run() {
    has_ends_ = std::find(ends_.begin(), ends_.end(), true) != ends_.end();
    if (!has_ends_) dearest_ = dearest();
    growPaths();
    std::vector<bool> seam = cutIntoDisks();
    prune(seam);
    return seam;
  }

 private:
  Index tail(Index e) const { return surface_.tail(surface_.halfedge(e)); }
  Index head(Index e) const { return surface_.head(surface_.halfedge(e)); }

  Index dearest() const {
    std::vector<double> sum(surface_.vertexCount(), 0), count(surface_.vertexCount(), 0);
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      for (const Index v : {tail(e), head(e)}) {
        sum[v] += costs_[e];
        ++count[v];
      }
    }
    for (std::size_t v = 0; v < sum.size(); ++v) sum[v] /= count[v];
    return static_cast<Index>(std::max_element(sum.begin(), sum.end()) - sum.begin());
  }

  /// Where paths begin if there is no end.
  bool isRoot(Index v) const { return has_ends_ ? ends_[v] : v == dearest_; }

  /// Shortest paths from the ends, a forest.
  void growPaths() {
    distance_.assign(surface_.vertexCount(), kInfinity);
    last_.assign(surface_.vertexCount(), kNone);
    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      if (!isRoot(v)) continue;
      distance_[v] = 0;
      queue.push({0, v});
    }
    std::vector<std::vector<Index>> around(surface_.vertexCount());
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      around[tail(e)].push_back(e);
      around[head(e)].push_back(e);
    }
    while (!queue.empty()) {
      const auto [distance, v] = queue.top();
      queue.pop();
      if (distance > distance_[v]) continue;
      for (const Index e : around[v]) {
        const Index other = tail(e) == v ? head(e) : tail(e);
        const double there = distance + costs_[e];
        if (there >= distance_[other]) continue;
        distance_[other] = there;
        last_[other] = e;
        queue.push({there, other});
      }
    }
  }

  /// Joins faces across the edges that no path uses, those first whose ways to the ends cost most;
  /// what joins nothing new stays a seam.
  std::vector<bool> cutIntoDisks() const {
    std::vector<bool> seam = kept_;
    for (const Index e : last_) {
      if (e != kNone) seam[e] = true;
    }
    std::vector<Index> order;
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      if (!seam[e]) order.push_back(e);
    }
    const auto cost = [&](Index e) { return distance_[tail(e)] + costs_[e] + distance_[head(e)]; };
    std::stable_sort(order.begin(), order.end(),
                     [&](Index a, Index b) { return cost(a) > cost(b); });
    DisjointSets faces(surface_.faceCount());
    for (const Index e : order) {
      const Index h = surface_.halfedge(e);
      seam[e] = !faces.join(Connectivity::faceOf(h), Connectivity::faceOf(surface_.twin(h)));
    }
    return seam;
  }

  /// Takes seams away that lead nowhere.
  void prune(std::vector<bool>& seam) const {
    std::vector<Index> degree(surface_.vertexCount(), 0);
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      if (!seam[e]) continue;
      ++degree[tail(e)];
      ++degree[head(e)];
    }
    std::vector<Index> loose;
    const auto consider = [&](Index v) {
      if (degree[v] == 1 && !ends_[v]) loose.push_back(v);
    };
    for (Index v = 0; v < surface_.vertexCount(); ++v) consider(v);
    while (!loose.empty()) {
      const Index v = loose.back();
      loose.pop_back();
      if (degree[v] != 1) continue;
      Index h = surface_.outgoing(v);
      while (!seam[surface_.edge(h)]) h = surface_.rotate(h);
      seam[surface_.edge(h)] = false;
      --degree[v];
      --degree[surface_.head(h)];
      consider(surface_.head(h));
    }
  }

  const Connectivity& surface_;
  const std::vector<double>& costs_;
  std::vector<bool> kept_;  ///< Per edge.
  std::vector<bool> ends_;  ///< Per vertex: where a seam may end.
  bool has_ends_ = true;
  Index dearest_ = kNone;
  std::vector<double> distance_;  ///< Per vertex to the nearest end.
  std::vector<Index> last_;       ///< Per vertex the last edge on the way from there.
};

}  // namespace

std::vector<double> seamCosts(const Connectivity& surface, const std::vector<double>& lengths) {
  const std::vector<double> areas = faceAreas(surface, lengths);
  const std::vector<double> angles = cornerAngles(surface, lengths);
  const Index vertices = surface.vertexCount();
  std::vector<double> turning(vertices, 0), area(vertices, 0);
  for (Index v = 0; v < vertices; ++v) {
    turning[v] = surface.isBoundaryVertex(v) ? 0 : 2 * std::numbers::pi;
  }
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const Index v = surface.tail(h);
    if (!surface.isBoundaryVertex(v)) turning[v] -= angles[h];
    area[v] += areas[Connectivity::faceOf(h)] / 3;
  }
  const double whole = std::accumulate(areas.begin(), areas.end(), 0.0);
  std::vector<double> near_turning(vertices), near_area = area;
  for (Index v = 0; v < vertices; ++v) near_turning[v] = std::abs(turning[v]);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e), a = surface.tail(h), b = surface.head(h);
    near_turning[a] += std::abs(turning[b]);
    near_turning[b] += std::abs(turning[a]);
    near_area[a] += area[b];
    near_area[b] += area[a];
  }
  const double round = 4 * std::numbers::pi / whole;
  std::vector<double> costs(lengths);
  const auto pointed = [&](Index v) {
    return std::min(kMostAdded, std::sqrt(near_turning[v] / (near_area[v] * round)));
  };
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    costs[e] *= 1 + (pointed(surface.tail(h)) + pointed(surface.head(h))) / 2;
  }
  return costs;
}

std::vector<bool> chooseSeams(const Connectivity& surface, const std::vector<double>& costs,
                              const std::vector<bool>& through, const std::vector<bool>& given) {
  return SeamChoice(surface, costs, through, given).run();
}

}  // namespace moduli
