#include "core/topology/cut_graph.h"

namespace moduli {
namespace {

/// A set of edges that loses its dangling branches.
class PrunedGraph {
 public:
  PrunedGraph(const Connectivity& surface, const TreeCotree& trees)
      : surface_(surface), kept_(surface.edgeCount(), false), degree_(surface.vertexCount(), 0) {
    for (const Index h : trees.vertex_parent) {
      if (h != kNone) add(surface.edge(h));
    }
    for (const Index e : trees.leftover) add(e);
  }

  void prune() {
    for (Index end = 0; end < surface_.vertexCount(); ++end) {
      for (Index v = end; isDangling(v);) v = removeEdgeAt(v);
    }
  }

  std::vector<Index> edges() const {
    std::vector<Index> result;
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      if (kept_[e]) result.push_back(e);
    }
    return result;
  }

 private:
  void add(Index e) {
    const Index h = surface_.halfedge(e);
    kept_[e] = true;
    ++degree_[surface_.tail(h)];
    ++degree_[surface_.head(h)];
  }

  bool isDangling(Index v) const { return degree_[v] == 1 && !surface_.isBoundaryVertex(v); }

  /// Removes the only edge at an inner vertex; returns the edge's other end.
  Index removeEdgeAt(Index v) {
    Index h = surface_.outgoing(v);
    while (!kept_[surface_.edge(h)]) h = surface_.rotate(h);
    kept_[surface_.edge(h)] = false;
    --degree_[v];
    --degree_[surface_.head(h)];
    return surface_.head(h);
  }

  const Connectivity& surface_;
  std::vector<bool> kept_;
  std::vector<Index> degree_;
};

}  // namespace

std::vector<Index> cutGraph(const Connectivity& surface, const TreeCotree& trees) {
  PrunedGraph graph(surface, trees);
  graph.prune();
  return graph.edges();
}

}  // namespace moduli
