#include "core/intrinsic/edge_graph.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>

namespace moduli {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
using Reached = std::pair<double, Index>;
using Frontier = std::priority_queue<Reached, std::vector<Reached>, std::greater<>>;

/// Takes up the frontier until it is empty; calls improved(from, to, distance) for every vertex
/// whose distance falls.
template <typename Improved>
void spread(const EdgeGraph& graph, Frontier& frontier, std::vector<double>& distance,
            const Improved& improved) {
  while (!frontier.empty()) {
    const auto [so_far, v] = frontier.top();
    frontier.pop();
    if (so_far > distance[v]) continue;
    for (const auto& [u, length] : graph.neighbours(v)) {
      if (!(so_far + length < distance[u])) continue;
      distance[u] = so_far + length;
      improved(v, u, distance[u]);
      frontier.emplace(distance[u], u);
    }
  }
}

Index farthest(const std::vector<double>& distance) {
  return static_cast<Index>(std::max_element(distance.begin(), distance.end()) - distance.begin());
}

}  // namespace

EdgeGraph::EdgeGraph(const Connectivity& surface, const std::vector<double>& lengths)
    : begin_(static_cast<std::size_t>(surface.vertexCount()) + 1, 0) {
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    ++begin_[surface.tail(h) + 1];
    ++begin_[surface.head(h) + 1];
  }
  for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
  neighbours_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e), a = surface.tail(h), b = surface.head(h);
    neighbours_[next[a]++] = {b, lengths[e]};
    neighbours_[next[b]++] = {a, lengths[e]};
  }
}

std::span<const std::pair<Index, double>> EdgeGraph::neighbours(Index vertex) const {
  return {neighbours_.data() + begin_[vertex], begin_[vertex + 1] - begin_[vertex]};
}

std::vector<double> EdgeGraph::distances(std::span<const Index> sources) const {
  std::vector<double> distance(vertexCount(), kFar);
  Frontier frontier;
  for (const Index source : sources) {
    distance[source] = 0;
    frontier.emplace(0, source);
  }
  spread(*this, frontier, distance, [](Index, Index, double) {});
  return distance;
}

std::vector<std::pair<Index, double>> EdgeGraph::within(Index source, double radius) const {
  std::vector<std::pair<Index, double>> found;
  std::vector<std::pair<Index, double>> best = {{source, 0}};  // Few: sorted by vertex.
  const auto place = [&](Index v) {
    return std::lower_bound(best.begin(), best.end(), v,
                            [](const auto& entry, Index vertex) { return entry.first < vertex; });
  };
  Frontier frontier;
  frontier.emplace(0, source);
  while (!frontier.empty()) {
    const auto [so_far, v] = frontier.top();
    frontier.pop();
    if (so_far > place(v)->second) continue;
    found.emplace_back(v, so_far);
    for (const auto& [u, length] : neighbours(v)) {
      const double distance = so_far + length;
      if (distance > radius) continue;
      const auto at = place(u);
      if (at != best.end() && at->first == u) {
        if (!(distance < at->second)) continue;
        at->second = distance;
      } else {
        best.insert(at, {u, distance});
      }
      frontier.emplace(distance, u);
    }
  }
  return found;
}

VertexSamples EdgeGraph::farthestSamples(const std::vector<Index>& begin, Index count) const {
  VertexSamples samples;
  samples.nearest.assign(vertexCount(), 0);
  std::vector<double> distance(vertexCount(), kFar);
  const auto add = [&](Index vertex) {
    const auto number = static_cast<Index>(samples.vertices.size());
    samples.vertices.push_back(vertex);
    samples.nearest[vertex] = number;
    distance[vertex] = 0;
    Frontier frontier;
    frontier.emplace(0, vertex);
    spread(*this, frontier, distance, [&](Index, Index u, double) { samples.nearest[u] = number; });
  };
  for (const Index vertex : begin) {
    if (static_cast<Index>(samples.vertices.size()) < count) add(vertex);
  }
  if (begin.empty() && count > 0) {
    const Index origin = 0;
    add(farthest(distances(std::span(&origin, 1))));
  }
  while (static_cast<Index>(samples.vertices.size()) < count) add(farthest(distance));
  return samples;
}

}  // namespace moduli
