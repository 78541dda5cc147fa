#include "core/topology/tree_cotree.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

namespace moduli {
namespace {

/// Which edges a tree may not use any more.
using EdgeMarks = std::vector<bool>;

Status notConnected(Index vertex) {
  return {Reason::kUnsupportedTopology,
          "the surface is not connected: no path leads from vertex 0 "
          "to vertex " +
              std::to_string(vertex)};
}

/// Breadth-first from the vertices in `roots`, across edges that are not barred; bars the tree's
/// edges. A boundary edge is taken in its own direction alone: its loop leads back all the same.
std::vector<Index> growVertexTree(const Connectivity& surface, std::vector<Index> roots,
                                  EdgeMarks& barred) {
  std::vector<Index> parent(surface.vertexCount(), kNone);
  std::vector<bool> reached(surface.vertexCount(), false);
  for (const Index root : roots) reached[root] = true;
  std::vector<Index> queue = std::move(roots);
  queue.reserve(surface.vertexCount());
  for (std::size_t at = 0; at < queue.size(); ++at) {
    const Index first = surface.outgoing(queue[at]);
    Index h = first;
    do {
      const Index v = surface.head(h);
      if (!reached[v] && !barred[surface.edge(h)]) {
        reached[v] = true;
        parent[v] = h;
        barred[surface.edge(h)] = true;
        queue.push_back(v);
      }
      h = surface.rotate(h);
    } while (h != first && h != kNone);
  }
  return parent;
}

/// Breadth-first over the faces, across edges that are not barred; bars the edges crossed. queue:
/// the faces to start from, whose parents are known.
void growFaceTree(const Connectivity& surface, std::vector<Index> queue, EdgeMarks& barred,
                  std::vector<Index>& parent) {
  std::vector<bool> reached(surface.faceCount(), false);
  for (const Index f : queue) reached[f] = true;
  queue.reserve(surface.faceCount());
  for (std::size_t at = 0; at < queue.size(); ++at) {
    for (Index h = 3 * queue[at]; h < 3 * queue[at] + 3; ++h) {
      const Index entry = surface.twin(h);
      if (entry == kNone || barred[surface.edge(h)]) continue;
      const Index f = Connectivity::faceOf(entry);
      if (reached[f]) continue;
      reached[f] = true;
      parent[f] = entry;
      barred[surface.edge(h)] = true;
      queue.push_back(f);
    }
  }
}

/// Enters faces from outside, through boundary edges that are not barred, one edge a face.
std::vector<Index> enterFromOutside(const Connectivity& surface, EdgeMarks& barred,
                                    std::vector<Index>& parent) {
  std::vector<Index> entered;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const Index f = Connectivity::faceOf(h);
    if (surface.twin(h) != kNone || barred[surface.edge(h)] || parent[f] != kNone) continue;
    parent[f] = h;
    barred[surface.edge(h)] = true;
    entered.push_back(f);
  }
  return entered;
}

std::vector<Index> unmarked(const EdgeMarks& barred) {
  std::vector<Index> edges;
  for (std::size_t e = 0; e < barred.size(); ++e) {
    if (!barred[e]) edges.push_back(static_cast<Index>(e));
  }
  return edges;
}

/// Appends `times` the crossings of the path from face f to the root of the face tree.
void addPathToRoot(const Connectivity& surface, const TreeCotree& trees, Index f, int times,
                   std::vector<CochainTerm>& terms) {
  for (Index h = trees.face_parent[f]; h != kNone; h = trees.face_parent[f]) {
    terms.push_back({surface.edge(h), times * surface.sign(h)});
    if (surface.twin(h) == kNone) return;
    f = Connectivity::faceOf(surface.twin(h));
  }
}

}  // namespace

Result<TreeCotree> computeTreeCotree(const Connectivity& surface) {
  EdgeMarks barred(surface.edgeCount(), false);
  TreeCotree trees;
  trees.vertex_parent = growVertexTree(surface, {0}, barred);
  const auto lost = std::find(trees.vertex_parent.begin() + 1, trees.vertex_parent.end(), kNone);
  if (lost != trees.vertex_parent.end()) {
    return notConnected(static_cast<Index>(lost - trees.vertex_parent.begin()));
  }
  trees.face_parent.assign(surface.faceCount(), kNone);
  std::vector<Index> entered = enterFromOutside(surface, barred, trees.face_parent);
  if (entered.empty()) entered = {0};
  growFaceTree(surface, std::move(entered), barred, trees.face_parent);
  trees.leftover = unmarked(barred);
  return trees;
}

Result<TreeCotree> computeRelativeTreeCotree(const Connectivity& surface) {
  EdgeMarks barred(surface.edgeCount(), false);
  for (Index e = 0; e < surface.edgeCount(); ++e) barred[e] = surface.isBoundaryEdge(e);
  std::vector<Index> roots;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (surface.isBoundaryVertex(v)) roots.push_back(v);
  }
  if (roots.empty()) {
    return Status(Reason::kUnsupportedTopology,
                  "the surface has no boundary and so no homology relative to it");
  }
  TreeCotree trees;
  trees.vertex_parent = growVertexTree(surface, std::move(roots), barred);
  trees.face_parent.assign(surface.faceCount(), kNone);
  growFaceTree(surface, {0}, barred, trees.face_parent);
  const auto lost = std::find(trees.face_parent.begin() + 1, trees.face_parent.end(), kNone);
  if (lost != trees.face_parent.end()) {
    return notConnected(surface.face(static_cast<Index>(lost - trees.face_parent.begin()))[0]);
  }
  trees.leftover = unmarked(barred);
  return trees;
}

std::vector<Cochain> cohomologyBasis(const Connectivity& surface, const TreeCotree& trees) {
  std::vector<Cochain> basis;
  for (const Index e : trees.leftover) {
    // The loop crosses e from left to right, goes to the root and comes back on the left.
    const Index h = surface.halfedge(e);
    std::vector<CochainTerm> terms{{e, 1}};
    if (surface.twin(h) != kNone) {
      addPathToRoot(surface, trees, Connectivity::faceOf(surface.twin(h)), 1, terms);
    }
    addPathToRoot(surface, trees, Connectivity::faceOf(h), -1, terms);
    basis.push_back(gatherTerms(std::move(terms)));
  }
  return basis;
}

}  // namespace moduli
