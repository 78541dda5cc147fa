#pragma once

#include <vector>

#include "core/base/status.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// A spanning tree of the vertices, a spanning tree of the faces that crosses none of its edges,
/// and the edges left over: 2 g on a closed surface of genus g.
struct TreeCotree {
  std::vector<Index>
      vertex_parent;               ///< Per vertex the halfedge that leads to it; kNone at the root.
  std::vector<Index> face_parent;  ///< Per face the halfedge of it through which it was entered;
                                   ///< kNone at the root.
  std::vector<Index> leftover;     ///< Edges, ascending.
};

/// Breadth-first from vertex 0 and face 0. surface: closed and connected (kUnsupportedTopology
/// otherwise). O(V + F). Source: Eppstein 2003; MATH 1.
Result<TreeCotree> computeTreeCotree(const Connectivity& surface);

/// Closed integer cochains (per edge, along its direction), one per leftover edge: +-1 on the edges
/// that its dual loop crosses. They are a basis of H^1(M; Z). Source: MATH 1.
std::vector<std::vector<int>> cohomologyBasis(const Connectivity& surface, const TreeCotree& trees);

/// Intersection number of two closed integer cochains, the integral of their wedge product.
long long intersectionNumber(const Connectivity& surface, const std::vector<int>& a,
                             const std::vector<int>& b);

}  // namespace moduli
