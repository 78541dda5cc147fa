#include "core/topology/symplectic_cohomology.h"

#include <string>
#include <utility>

#include "core/topology/symplectic_basis.h"
#include "core/topology/tree_cotree.h"

namespace moduli {
namespace {

/// The symplectic combinations of cochains; the radical of their form is left out.
Result<std::vector<Cochain>> symplecticCombinations(const Connectivity& surface,
                                                    const std::vector<Cochain>& cochains) {
  ASSIGN_OR_RETURN(const SymplecticBasis reduced,
                   reduceSymplectic(intersectionMatrix(surface, cochains, cochains)));
  std::vector<Cochain> result;
  for (Eigen::Index row = 0; row < 2 * reduced.pairs; ++row) {
    ASSIGN_OR_RETURN(Cochain combined, combineCochains(cochains, reduced.basis, row));
    result.push_back(std::move(combined));
  }
  return result;
}

/// Breadth-first over the faces from `root`: per face the halfedge of it through which it was
/// entered, kNone at the root and where no path leads.
std::vector<Index> facesFrom(const Connectivity& surface, Index root) {
  std::vector<Index> parent(surface.faceCount(), kNone);
  std::vector<Index> queue{root};
  for (std::size_t at = 0; at < queue.size(); ++at) {
    for (Index h = 3 * queue[at]; h < 3 * queue[at] + 3; ++h) {
      const Index entry = surface.twin(h);
      if (entry == kNone) continue;
      const Index f = Connectivity::faceOf(entry);
      if (f == root || parent[f] != kNone) continue;
      parent[f] = entry;
      queue.push_back(f);
    }
  }
  return parent;
}

/// Crossings, from left to right, of a path that enters the surface through boundary halfedge
/// `from` and leaves it through `to`. parent: facesFrom the face of `from`.
Cochain crossingPath(const Connectivity& surface, const std::vector<Index>& parent, Index from,
                     Index to) {
  std::vector<CochainTerm> terms{{surface.edge(to), surface.sign(to)},
                                 {surface.edge(from), -surface.sign(from)}};
  for (Index h = parent[Connectivity::faceOf(to)]; h != kNone;
       h = parent[Connectivity::faceOf(surface.twin(h))]) {
    terms.push_back({surface.edge(h), -surface.sign(h)});
  }
  return gatherTerms(std::move(terms));
}

/// Adds to each cochain the combination of the handles that makes it meet none of them.
Result<std::vector<Cochain>> clearHandles(const Connectivity& surface,
                                          const std::vector<Cochain>& handles,
                                          const std::vector<Cochain>& cochains) {
  const IntegerMatrix met = intersectionMatrix(surface, cochains, handles);
  const auto genus = static_cast<Eigen::Index>(handles.size() / 2);
  IntegerMatrix coefficients(met.rows(), met.cols());
  coefficients << -met.rightCols(genus), met.leftCols(genus);
  std::vector<Cochain> result;
  for (std::size_t k = 0; k < cochains.size(); ++k) {
    ASSIGN_OR_RETURN(Cochain terms,
                     combineCochains(handles, coefficients, static_cast<Eigen::Index>(k)));
    terms.insert(terms.end(), cochains[k].begin(), cochains[k].end());
    result.push_back(gatherTerms(std::move(terms)));
  }
  return result;
}

}  // namespace

Result<std::vector<Cochain>> symplecticCohomology(const Connectivity& surface) {
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (!surface.isBoundaryEdge(e)) continue;
    return Status{Reason::kUnsupportedTopology,
                  "the surface has a boundary, at face " +
                      std::to_string(Connectivity::faceOf(surface.halfedge(e)))};
  }
  ASSIGN_OR_RETURN(const TreeCotree trees, computeTreeCotree(surface));
  return symplecticCombinations(surface, cohomologyBasis(surface, trees));
}

Result<BorderedCohomology> borderedCohomology(
    const Connectivity& surface, const std::vector<std::vector<Index>>& boundary_loops) {
  ASSIGN_OR_RETURN(const TreeCotree trees, computeRelativeTreeCotree(surface));
  BorderedCohomology result;
  ASSIGN_OR_RETURN(result.handles,
                   symplecticCombinations(surface, cohomologyBasis(surface, trees)));
  if (boundary_loops.size() < 2) return result;
  const Index start = boundary_loops[0][0];
  const std::vector<Index> parent = facesFrom(surface, Connectivity::faceOf(start));
  std::vector<Cochain> paths;
  for (std::size_t k = 1; k < boundary_loops.size(); ++k) {
    paths.push_back(crossingPath(surface, parent, start, boundary_loops[k][0]));
  }
  ASSIGN_OR_RETURN(result.loops, clearHandles(surface, result.handles, paths));
  return result;
}

}  // namespace moduli
