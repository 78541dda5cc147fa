#include "core/topology/homology.h"

#include <algorithm>
#include <cstddef>

namespace moduli {
namespace {

/// From the root of v's tree to v.
Walk pathFromRoot(const Connectivity& surface, const TreeCotree& trees, Index v) {
  Walk path;
  for (Index h = trees.vertex_parent[v]; h != kNone; h = trees.vertex_parent[surface.tail(h)]) {
    path.push_back({surface.edge(h), surface.sign(h)});
  }
  std::reverse(path.begin(), path.end());
  return path;
}

/// Along `there` without its first `skipped` steps, the edge, and back along `back` but for these.
Walk throughEdge(const Walk& there, Index edge, const Walk& back, std::ptrdiff_t skipped) {
  Walk walk(there.begin() + skipped, there.end());
  walk.push_back({edge, 1});
  const Walk home = inverseWalk(back);
  walk.insert(walk.end(), home.begin(), home.end() - skipped);
  return walk;
}

}  // namespace

Walk inverseWalk(const Walk& walk) {
  Walk inverse(walk.rbegin(), walk.rend());
  for (Step& step : inverse) step.sign = -step.sign;
  return inverse;
}

std::vector<Walk> homologyBasis(const Connectivity& surface, const TreeCotree& trees) {
  std::vector<Walk> basis;
  for (const Index e : trees.leftover) {
    const Index h = surface.halfedge(e);
    const Walk there = pathFromRoot(surface, trees, surface.tail(h));
    const Walk back = pathFromRoot(surface, trees, surface.head(h));
    const auto parting = std::mismatch(there.begin(), there.end(), back.begin(), back.end());
    basis.push_back(throughEdge(there, e, back, parting.first - there.begin()));
  }
  return basis;
}

Walk basedLoop(const Connectivity& surface, const TreeCotree& trees, std::size_t k) {
  const Index h = surface.halfedge(trees.leftover[k]);
  return throughEdge(pathFromRoot(surface, trees, surface.tail(h)), trees.leftover[k],
                     pathFromRoot(surface, trees, surface.head(h)), 0);
}

Integer integrate(const Cochain& cochain, const Walk& walk) {
  Integer sum = 0;
  for (const Step& step : walk) {
    const auto term = std::lower_bound(
        cochain.begin(), cochain.end(), step.edge,
        [](const CochainTerm& candidate, Index edge) { return candidate.edge < edge; });
    if (term != cochain.end() && term->edge == step.edge) sum += step.sign * term->value;
  }
  return sum;
}

}  // namespace moduli
