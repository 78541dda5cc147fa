#pragma once

#include <cstddef>
#include <vector>

#include "core/mesh/connectivity.h"
#include "core/topology/cochain.h"
#include "core/topology/tree_cotree.h"

/// Paths along the edges of a surface, and those that carry its homology.
///
///   ASSIGN_OR_RETURN(const TreeCotree trees, computeTreeCotree(surface));
///   const std::vector<Cochain> forms = cohomologyBasis(surface, trees);
///   const std::vector<Walk> loops = homologyBasis(surface, trees);
///   integrate(forms[i], loops[k]);  // 1 if i == k, else 0
namespace moduli {

/// An edge as it is walked along.
struct Step {
  Index edge = kNone;
  int sign = 1;  ///< +1 along the edge's direction, -1 against it.
  bool operator==(const Step&) const = default;
};

/// Steps one after the other, each from where the last one ended.
using Walk = std::vector<Step>;

/// The same walk from its end to its start.
Walk inverseWalk(const Walk& walk);

/// The closed walks of the leftover edges: through the vertices' tree to the edge's tail, along the
/// edge, and back from its head; what the way there and the way back have in common is cut off.
///
/// One walk per leftover edge, in their order; none meets a vertex twice. Cochain i of
/// cohomologyBasis has the period 1 on walk i and 0 on the others. With the trees of
/// computeTreeCotree they are a basis of H_1(M; Z). With those of computeRelativeTreeCotree they
/// are a basis of H_1(M, dM; Z): a walk is then either a loop, where both ways part at an inner
/// vertex, or goes from a boundary vertex to another or the same one and meets the boundary there
/// alone. trees: those of the surface. O(steps of both ways of each edge).
/// Source: Erickson and Whittlesey 2005; MATH 1.
std::vector<Walk> homologyBasis(const Connectivity& surface, const TreeCotree& trees);

/// The whole loop of leftover edge k: from the root through the vertices' tree, along the edge and
/// back to the root; nothing is cut off. With the trees of computeTreeCotree the root is vertex 0,
/// and the loops generate the fundamental group there. trees: those of the surface; k < #leftover.
/// O(steps).
Walk basedLoop(const Connectivity& surface, const TreeCotree& trees, std::size_t k);

/// The period of a cochain: the sum of its values along a walk. A sum of more than 63 bits is not
/// noticed. O(n log m) for n steps and m terms.
Integer integrate(const Cochain& cochain, const Walk& walk);

}  // namespace moduli
