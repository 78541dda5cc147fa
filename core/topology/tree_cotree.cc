#include "core/topology/tree_cotree.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace moduli {
namespace {

Status checkClosed(const Connectivity& surface) {
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (surface.twin(h) != kNone) continue;
    return {Reason::kUnsupportedTopology,
            "the surface has a boundary, at face " + std::to_string(h / 3)};
  }
  return {};
}

// Breadth-first over the vertices; marks the tree's edges.
std::vector<Index> growVertexTree(const Connectivity& surface, std::vector<bool>& in_tree) {
  std::vector<Index> parent(surface.vertexCount(), kNone);
  std::vector<Index> queue = {0};
  queue.reserve(surface.vertexCount());
  for (std::size_t at = 0; at < queue.size(); ++at) {
    const Index first = surface.outgoing(queue[at]);
    Index h = first;
    do {
      const Index v = surface.head(h);
      if (v != 0 && parent[v] == kNone) {
        parent[v] = h;
        in_tree[surface.edge(h)] = true;
        queue.push_back(v);
      }
      h = surface.rotate(h);
    } while (h != first);
  }
  return parent;
}

// Breadth-first over the faces, across edges outside the vertex tree; marks the edges crossed.
std::vector<Index> growFaceTree(const Connectivity& surface, const std::vector<bool>& in_tree,
                                std::vector<bool>& crossed) {
  std::vector<Index> parent(surface.faceCount(), kNone);
  std::vector<Index> queue = {0};
  queue.reserve(surface.faceCount());
  for (std::size_t at = 0; at < queue.size(); ++at) {
    for (Index h = 3 * queue[at]; h < 3 * queue[at] + 3; ++h) {
      const Index entry = surface.twin(h);
      const Index f = Connectivity::faceOf(entry);
      if (f == 0 || parent[f] != kNone || in_tree[surface.edge(h)]) continue;
      parent[f] = entry;
      crossed[surface.edge(h)] = true;
      queue.push_back(f);
    }
  }
  return parent;
}

// Adds `times` the crossings of the path from face f to the root of the face tree.
void addPathToRoot(const Connectivity& surface, const TreeCotree& trees, Index f, int times,
                   std::vector<int>& cochain) {
  for (Index h = trees.face_parent[f]; h != kNone; h = trees.face_parent[f]) {
    cochain[surface.edge(h)] += times * surface.sign(h);
    f = Connectivity::faceOf(surface.twin(h));
  }
}

long long along(const Connectivity& surface, const std::vector<int>& cochain, Index h) {
  return static_cast<long long>(surface.sign(h)) * cochain[surface.edge(h)];
}

}  // namespace

Result<TreeCotree> computeTreeCotree(const Connectivity& surface) {
  RETURN_IF_ERROR(checkClosed(surface));
  std::vector<bool> in_tree(surface.edgeCount(), false);
  std::vector<bool> crossed(surface.edgeCount(), false);
  TreeCotree trees;
  trees.vertex_parent = growVertexTree(surface, in_tree);
  const auto roots = std::count(trees.vertex_parent.begin(), trees.vertex_parent.end(), kNone);
  if (roots != 1) {
    const auto lost = std::find(trees.vertex_parent.begin() + 1, trees.vertex_parent.end(), kNone);
    return Status(Reason::kUnsupportedTopology,
                  "the surface is not connected: no path leads from vertex 0 to vertex " +
                      std::to_string(lost - trees.vertex_parent.begin()));
  }
  trees.face_parent = growFaceTree(surface, in_tree, crossed);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (!in_tree[e] && !crossed[e]) trees.leftover.push_back(e);
  }
  return trees;
}

std::vector<std::vector<int>> cohomologyBasis(const Connectivity& surface,
                                              const TreeCotree& trees) {
  std::vector<std::vector<int>> basis;
  for (const Index e : trees.leftover) {
    // The loop crosses e from left to right, goes to the root and comes back on the left.
    std::vector<int> cochain(surface.edgeCount(), 0);
    const Index h = surface.halfedge(e);
    cochain[e] = 1;
    addPathToRoot(surface, trees, Connectivity::faceOf(surface.twin(h)), 1, cochain);
    addPathToRoot(surface, trees, Connectivity::faceOf(h), -1, cochain);
    basis.push_back(std::move(cochain));
  }
  return basis;
}

long long intersectionNumber(const Connectivity& surface, const std::vector<int>& a,
                             const std::vector<int>& b) {
  long long twice = 0;
  for (Index h = 0; h < surface.halfedgeCount(); h += 3) {
    const long long a_12 = along(surface, a, h);
    const long long a_13 = -along(surface, a, h + 2);
    const long long b_12 = along(surface, b, h);
    const long long b_13 = -along(surface, b, h + 2);
    twice += a_12 * b_13 - a_13 * b_12;
  }
  return twice / 2;
}

}  // namespace moduli
