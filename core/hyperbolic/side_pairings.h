#pragma once

#include <vector>

#include "core/hyperbolic/developing.h"
#include "core/topology/homotopy_basis.h"

namespace moduli {

/// Generators of the group of a surface in its disk, and their one relation.
struct SidePairings {
  std::vector<Index> edges;  ///< 2 g of them, ascending; letter k crosses edge k.
  /// letters[k] = placed[a] crossing[h] placed[b]^-1 for h = halfedge(edges[k]), a the face of h
  /// and b that beyond: it carries the placed faces to the copy of them that lies beyond h.
  std::vector<Su11> letters;
  /// A word of 4 g letters that is +-1 in the group, each once with either sign.
  Word relation;
  double longest = 0;  ///< The largest displacement of 0 by a letter.
};

/// The loops in the dual graph of a layout that cross one edge and otherwise follow its tree, of as
/// many edges as generate the group: the shortest ones that do, by the displacement of 0. The other
/// edges that the layout does not cross are a tree of the vertices, of the longest edges in this
/// sense; the relation runs once around it, clockwise.
/// O(E log E). Source: Erickson and Whittlesey 2005, in the dual; MATH 7.2.
SidePairings findSidePairings(const Connectivity& surface, const Development& development);

}  // namespace moduli
