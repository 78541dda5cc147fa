#pragma once

#include <vector>

#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/topology/cochain.h"

namespace moduli {

/// A spanning tree of the vertices, a spanning tree of the faces that crosses none of its edges,
/// and the edges left over, which carry the homology.
struct TreeCotree {
  std::vector<Index>
      vertex_parent;               ///< Per vertex the halfedge that leads to it; kNone at the root.
  std::vector<Index> face_parent;  ///< Per face the halfedge of it through which it was entered;
                                   ///< kNone at the root.
  std::vector<Index> leftover;     ///< Edges, ascending.
};

/// Trees of a connected surface (kUnsupportedTopology if it is not).
///
/// Closed: from vertex 0 and face 0; 2 g edges are left over. With b > 0 boundary loops: the faces'
/// tree is rooted in one more face, "outside", which lies beyond every boundary edge; 2 g + b - 1
/// edges are left over, and the tree's paths closed by each of them are a basis of H_1(M; Z).
/// O(V + F). Source: Eppstein 2003; Erickson and Whittlesey 2005; MATH 1.
Result<TreeCotree> computeTreeCotree(const Connectivity& surface);

/// The same for M with its boundary shrunk to a point. The vertices' tree grows from all boundary
/// vertices at once (all of them are roots) and, as the faces' tree, from inner edges alone; of
/// these 2 g + b - 1 are left over. Closed with the trees' paths they are a basis of the relative
/// homology H_1(M, dM; Z), of loops and of arcs from boundary to boundary. surface: connected, with
/// boundary (kUnsupportedTopology otherwise). O(V + F).
Result<TreeCotree> computeRelativeTreeCotree(const Connectivity& surface);

/// Closed cochains with values -1, 0 and 1, one per leftover edge: the crossings of its dual loop,
/// which crosses the leftover edge from left to right. Cochain k is 1 on leftover edge k and 0 on
/// the other ones and on the vertices' tree, so that they are a basis of H^1(M; Z), dual to the
/// loops of the leftover edges; for relative trees, of H^1(M, dM; Z), and then they vanish on the
/// boundary. O(E + length of the loops).
std::vector<Cochain> cohomologyBasis(const Connectivity& surface, const TreeCotree& trees);

}  // namespace moduli
