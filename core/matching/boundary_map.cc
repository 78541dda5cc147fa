#include "core/matching/boundary_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/intrinsic/edge_graph.h"
#include "core/matching/rim_targets.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// Of an even map, so that no two vertices share a place.
constexpr double kEvenShare = 1e-3;
/// A step of more than this part of a turn goes back by rounding.
constexpr double kRounding = 1 - 1e-9;

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

/// Places along a loop, in order and once around, near the targets. All but the result as shares of
/// the loops' lengths; at: of the vertices on theirs, ascending. The result counts turns, too.
std::vector<double> inOrder(const std::vector<double>& at, const std::vector<double>& targets) {
  std::vector<double> places = orderedAroundCircle(at, targets);
  double middle = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i > 0) {
      const double step = places[i] - places[i - 1];
      const double on = step - std::floor(step);
      places[i] = places[i - 1] + (on < kRounding ? on : 0);
    }
    middle += (places[i] - at[i]) / static_cast<double>(places.size());
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i] = (1 - kEvenShare) * places[i] + kEvenShare * (middle + at[i]);
  }
  return places;
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

  /// known: as fitBoundary has it.
  Result<BoundaryMap> run(const std::vector<Index>& known) {
    if (loops_a_.size() != loops_b_.size() || loops_a_.empty()) {
      return Status(Reason::kUnsupportedTopology, "the surfaces differ in their boundary loops");
    }
    for (const Loop& loop : loops_b_) {
      std::vector<Index> vertices;
      for (const Index h : loop.halfedges) vertices.push_back(b_.connectivity().tail(h));
      distances_.push_back(graph_.distances(vertices));
    }
    map_.loops = known;
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

  /// Of those that are not known the nearest pairs first.
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
    map_.loops.resize(n, kNone);
    std::vector<bool> taken(n, false);
    for (const Index j : map_.loops) {
      if (j != kNone) taken[j] = true;
    }
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
    std::vector<double> targets, at;
    for (std::size_t i = 0; i < from.halfedges.size(); ++i) {
      const Index foot = footOf(nearestCorner(a.tail(from.halfedges[i])), distances_[j]);
      targets.push_back(starts[foot] / to.length);
      at.push_back(from.starts[i] / from.length);
    }
    const std::vector<double> places = inOrder(at, targets);
    std::vector<Index> edges;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double turns = std::floor(places[i]);
      const double along = (places[i] - turns) * to.length;
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
                                const std::vector<SurfacePoint>& points,
                                const std::vector<Index>& loops) {
  return BoundaryFit(a, b, points).run(loops);
}

}  // namespace moduli
