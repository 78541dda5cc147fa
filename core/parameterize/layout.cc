#include "core/parameterize/layout.h"

#include <algorithm>
#include <queue>
#include <utility>

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// Shorter edges are judged by the mean length.
constexpr double kTinyEdge = 1e-6;

class Layout {
 public:
  Layout(const Connectivity& surface, const FlatCharts& charts)
      : surface_(surface),
        charts_(charts),
        placed_(surface.halfedgeCount()),
        seam_(surface.edgeCount(), true) {}

  PlanarLayout run(const std::vector<bool>& is_cone) {
    if (surface_.faceCount() == 0) return {};
    unfold();
    prune(is_cone);
    PlanarLayout layout;
    layout.closure = closure();
    nameCorners(layout);
    return layout;
  }

 private:
  Complex position(Index h) const { return placed_[h]; }

  /// Places a face so that its halfedge h starts at `start` and runs along `direction`.
  void place(Index h, Complex start, Complex direction) {
    Complex turn = direction / charts_[h];
    turn /= std::abs(turn);
    const Index h1 = Connectivity::next(h), h2 = Connectivity::previous(h);
    placed_[h] = start;
    placed_[h1] = start + turn * charts_[h];
    placed_[h2] = start - turn * charts_[h2];
  }

  /// Prim's tree of faces over the longest edges: short ones pass on a direction badly.
  void unfold() {
    std::vector<bool> seen(surface_.faceCount(), false);
    Index root = 0;
    for (Index h = 1; h < surface_.halfedgeCount(); ++h) {
      if (std::abs(charts_[h]) > std::abs(charts_[root])) root = h;
    }
    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry> queue;
    const auto leave = [&](Index h) {
      seen[Connectivity::faceOf(h)] = true;
      for (const Index g : {h, Connectivity::next(h), Connectivity::previous(h)}) {
        if (surface_.twin(g) != kNone) queue.push({std::abs(charts_[g]), g});
      }
    };
    place(root, 0, 1);
    leave(root);
    while (!queue.empty()) {
      const Index h = queue.top().second, twin = surface_.twin(h);
      queue.pop();
      if (seen[Connectivity::faceOf(twin)]) continue;
      const Complex from = position(Connectivity::next(h)), to = position(h);
      place(twin, from, to - from);
      seam_[surface_.edge(h)] = false;
      leave(twin);
    }
  }

  /// Takes seams away that end at a flat inner vertex.
  void prune(const std::vector<bool>& is_cone) {
    std::vector<Index> degree(surface_.vertexCount(), 0);
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      if (!seam_[e]) continue;
      ++degree[surface_.tail(surface_.halfedge(e))];
      ++degree[surface_.head(surface_.halfedge(e))];
    }
    std::vector<Index> ends;
    const auto consider = [&](Index v) {
      if (degree[v] == 1 && !is_cone[v] && !surface_.isBoundaryVertex(v)) ends.push_back(v);
    };
    for (Index v = 0; v < surface_.vertexCount(); ++v) consider(v);
    while (!ends.empty()) {
      const Index v = ends.back();
      ends.pop_back();
      Index h = surface_.outgoing(v);
      const Index first = h;
      while (!seam_[surface_.edge(h)]) {
        h = surface_.rotate(h);
        if (h == first) break;
      }
      if (!seam_[surface_.edge(h)]) continue;
      seam_[surface_.edge(h)] = false;
      --degree[v];
      const Index other = surface_.head(h);
      --degree[other];
      consider(other);
    }
  }

  double closure() const {
    double mean = 0;
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) mean += std::abs(charts_[h]);
    mean /= surface_.halfedgeCount();
    double largest = 0;
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      const Index h = surface_.halfedge(e), twin = surface_.twin(h);
      if (seam_[e] || twin == kNone) continue;
      const double gap = std::max(std::abs(position(h) - position(Connectivity::next(twin))),
                                  std::abs(position(Connectivity::next(h)) - position(twin)));
      const double length = std::abs(charts_[h]);
      largest = std::max(largest, gap / (length > kTinyEdge * mean ? length : mean));
    }
    return largest;
  }

  /// Corners around a vertex are one point as far as no seam comes between them.
  void nameCorners(PlanarLayout& layout) const {
    layout.corner.assign(surface_.halfedgeCount(), kNone);
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      if (layout.corner[h] != kNone) continue;
      const auto point = static_cast<Index>(layout.points.size());
      layout.points.push_back(position(h));
      // Counter-clockwise up to a seam, then clockwise from the start.
      for (Index g = h; g != kNone && layout.corner[g] == kNone;) {
        layout.corner[g] = point;
        const Index side = Connectivity::previous(g);
        g = seam_[surface_.edge(side)] ? kNone : surface_.twin(side);
      }
      for (Index g = h; !seam_[surface_.edge(g)] && surface_.twin(g) != kNone;) {
        g = Connectivity::next(surface_.twin(g));
        if (layout.corner[g] != kNone) break;
        layout.corner[g] = point;
      }
    }
  }

  const Connectivity& surface_;
  const FlatCharts& charts_;
  std::vector<Complex> placed_;  ///< Per halfedge the position of its tail in its face.
  std::vector<bool> seam_;       ///< Per edge; boundary edges too.
};

}  // namespace

PlanarLayout layOut(const Connectivity& surface, const FlatCharts& charts,
                    const std::vector<bool>& is_cone) {
  return Layout(surface, charts).run(is_cone);
}

}  // namespace moduli
