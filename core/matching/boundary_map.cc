#include "core/matching/boundary_map.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/intrinsic/edge_graph.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// Of an even map, so that no two vertices share a place.
constexpr double kEvenShare = 1e-3;

/// A boundary loop, and where its vertices are along it.
struct Loop {
  std::vector<Index> halfedges;
  std::vector<double> starts;  ///< Per halfedge how far along its tail is.
  double length = 0;
};

std::vector<Loop> loopsOf(const TriangleMesh& mesh) {
  const std::vector<double> lengths = mesh.edgeLengths();
  std::vector<Loop> loops;
  for (std::vector<Index>& halfedges : computeTopology(mesh.connectivity()).boundary_loops) {
    Loop& loop = loops.emplace_back();
    for (const Index h : halfedges) {
      loop.starts.push_back(loop.length);
      loop.length += lengths[mesh.connectivity().edge(h)];
    }
    loop.halfedges = std::move(halfedges);
  }
  return loops;
}

/// Not decreasing, and nearest to the values by weighted squares.
std::vector<double> isotonic(const std::vector<double>& values,
                             const std::vector<double>& weights) {
  struct Block {
    double sum = 0, weight = 0;
    std::size_t count = 0;
    double mean() const { return sum / weight; }
  };
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < values.size(); ++i) {
    blocks.push_back({values[i] * weights[i], weights[i], 1});
    while (blocks.size() > 1 && blocks.back().mean() < blocks[blocks.size() - 2].mean()) {
      const Block last = blocks.back();
      blocks.pop_back();
      blocks.back().sum += last.sum;
      blocks.back().weight += last.weight;
      blocks.back().count += last.count;
    }
  }
  std::vector<double> result;
  for (const Block& block : blocks) result.insert(result.end(), block.count, block.mean());
  return result;
}

/// The nearest whole number of turns away from 0.
double wrapped(double value, double length) {
  return value - length * std::round(value / length);
}

/// Places along a loop of the length `length`, in order and once around, near the targets. at: how
/// far along the other loop, of the length `whole`, the vertices are.
std::vector<double> inOrder(const std::vector<double>& targets, double length,
                            const std::vector<double>& at, double whole) {
  const std::size_t n = targets.size();
  const double rate = length / whole;
  std::vector<double> weights(n), lifted(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double before = i > 0 ? at[i] - at[i - 1] : at[0] + whole - at[n - 1];
    const double after = i + 1 < n ? at[i + 1] - at[i] : at[0] + whole - at[n - 1];
    weights[i] = std::max((before + after) / 2, 1e-12 * whole);
  }
  std::complex<double> turn = 0;
  for (std::size_t i = 0; i < n; ++i) {
    turn += std::polar(weights[i], 2 * std::numbers::pi * (targets[i] - rate * at[i]) / length);
  }
  const double shift = std::arg(turn) * length / (2 * std::numbers::pi);
  const auto even = [&](std::size_t i) { return shift + rate * at[i]; };
  // Each from the one before, if that leads once around; else from where an even map has it.
  lifted[0] = even(0) + wrapped(targets[0] - even(0), length);
  for (std::size_t i = 1; i < n; ++i) {
    lifted[i] = lifted[i - 1] + wrapped(targets[i] - lifted[i - 1], length);
  }
  const double around = lifted[n - 1] + wrapped(targets[0] - lifted[n - 1], length) - lifted[0];
  if (std::lround(around / length) != 1) {
    for (std::size_t i = 0; i < n; ++i) {
      lifted[i] = even(i) + wrapped(targets[i] - even(i), length);
    }
  }
  // The turns before and after keep the ends in order, too.
  std::vector<double> turns, turn_weights;
  for (int k = -1; k <= 1; ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      turns.push_back(lifted[i] + k * length);
      turn_weights.push_back(weights[i]);
    }
  }
  turns = isotonic(turns, turn_weights);
  const double first = turns[n];
  double mean = 0;
  for (std::size_t i = 0; i < n; ++i) {
    mean += weights[i] * (turns[n + i] - rate * at[i]) / whole;
  }
  std::vector<double> result(n);
  for (std::size_t i = 0; i < n; ++i) {
    result[i] = (1 - kEvenShare) * std::min(turns[n + i], first + length) +
                kEvenShare * (mean + rate * at[i]);
  }
  return result;
}

class BoundaryFit {
 public:
  BoundaryFit(const TriangleMesh& a, const TriangleMesh& b, const std::vector<SurfacePoint>& points)
      : a_(a),
        b_(b),
        points_(points),
        graph_(b.connectivity(), b.edgeLengths()),
        loops_a_(loopsOf(a)),
        loops_b_(loopsOf(b)) {}

  Result<BoundaryMap> run() {
    if (loops_a_.size() != loops_b_.size() || loops_a_.empty()) {
      return Status(Reason::kUnsupportedTopology, "the surfaces differ in their boundary loops");
    }
    for (const Loop& loop : loops_b_) {
      std::vector<Index> vertices;
      for (const Index h : loop.halfedges) vertices.push_back(b_.connectivity().tail(h));
      distances_.push_back(graph_.distances(vertices));
    }
    assignLoops();
    map_.edges.assign(a_.vertexCount(), kNone);
    map_.points.resize(a_.vertexCount());
    map_.steps.assign(a_.connectivity().halfedgeCount(), 0);
    for (std::size_t i = 0; i < loops_a_.size(); ++i) {
      fitLoop(loops_a_[i], static_cast<std::size_t>(map_.loops[i]));
    }
    return std::move(map_);
  }

 private:
  Index nearestCorner(Index v) const {
    const SurfacePoint& point = points_[v];
    const auto& weights = point.barycentric;
    const auto c = std::max_element(weights.begin(), weights.end()) - weights.begin();
    return b_.connectivity().face(point.face)[static_cast<std::size_t>(c)];
  }

  /// The nearest pairs first.
  void assignLoops() {
    const std::size_t n = loops_a_.size();
    struct Pair {
      double distance = 0;
      std::size_t i = 0, j = 0;
    };
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        double sum = 0;
        for (const Index h : loops_a_[i].halfedges) {
          sum += distances_[j][nearestCorner(a_.connectivity().tail(h))];
        }
        pairs.push_back({sum / static_cast<double>(loops_a_[i].halfedges.size()), i, j});
      }
    }
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& x, const Pair& y) { return x.distance < y.distance; });
    map_.loops.assign(n, kNone);
    std::vector<bool> taken(n, false);
    for (const Pair& pair : pairs) {
      if (map_.loops[pair.i] != kNone || taken[pair.j]) continue;
      map_.loops[pair.i] = static_cast<Index>(pair.j);
      taken[pair.j] = true;
    }
  }

  /// Down the distances from a loop to the vertex there.
  Index footOf(Index v, const std::vector<double>& distances) const {
    while (distances[v] > 0) {
      Index next = v;
      for (const auto& [other, length] : graph_.neighbours(v)) {
        if (distances[other] < distances[next]) next = other;
      }
      if (next == v) break;
      v = next;
    }
    return v;
  }

  void fitLoop(const Loop& from, std::size_t j) {
    const Loop& to = loops_b_[j];
    const Connectivity &a = a_.connectivity(), &b = b_.connectivity();
    std::vector<double> starts(b_.vertexCount(), 0.0);
    for (std::size_t i = 0; i < to.halfedges.size(); ++i) {
      starts[b.tail(to.halfedges[i])] = to.starts[i];
    }
    std::vector<double> targets;
    for (const Index h : from.halfedges) {
      targets.push_back(starts[footOf(nearestCorner(a.tail(h)), distances_[j])]);
    }
    const std::vector<double> places = inOrder(targets, to.length, from.starts, from.length);
    std::vector<Index> edges;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double turns = std::floor(places[i] / to.length);
      const double along = places[i] - turns * to.length;
      const auto after = std::upper_bound(to.starts.begin(), to.starts.end(), along);
      const auto k =
          static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - to.starts.begin() - 1));
      const double end = k + 1 < to.starts.size() ? to.starts[k + 1] : to.length;
      const double size = end - to.starts[k];
      const double t = size > 0 ? std::clamp((along - to.starts[k]) / size, 0.0, 1.0) : 0;
      const Index v = a.tail(from.halfedges[i]);
      map_.edges[v] = to.halfedges[k];
      map_.points[v] = edgePoint(to.halfedges[k], t);
      edges.push_back(static_cast<Index>(k) +
                      static_cast<Index>(turns) * static_cast<Index>(to.halfedges.size()));
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Index next =
          i + 1 < edges.size() ? edges[i + 1] : edges[0] + static_cast<Index>(to.halfedges.size());
      map_.steps[from.halfedges[i]] = next - edges[i];
    }
  }

  const TriangleMesh& a_;
  const TriangleMesh& b_;
  const std::vector<SurfacePoint>& points_;
  EdgeGraph graph_;
  std::vector<Loop> loops_a_, loops_b_;
  std::vector<std::vector<double>> distances_;  ///< From each loop of B, per vertex.
  BoundaryMap map_;
};

}  // namespace

Result<BoundaryMap> fitBoundary(const TriangleMesh& a, const TriangleMesh& b,
                                const std::vector<SurfacePoint>& points) {
  return BoundaryFit(a, b, points).run();
}

}  // namespace moduli
