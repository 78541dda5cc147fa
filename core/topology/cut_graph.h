#pragma once

#include <vector>

#include "core/mesh/connectivity.h"
#include "core/topology/tree_cotree.h"

namespace moduli {

/// The edges, ascending, along which a surface is cut into a disk: the vertices' tree and the
/// leftover edges, without branches that end inside the surface.
///
/// surface: connected. trees: of computeTreeCotree if it is closed, of computeRelativeTreeCotree if
/// it has a boundary; then the cuts start and end on the boundary, and none runs along it. Closed
/// of genus g >= 1: a connected graph of chi = 1 - 2 g. Empty for the disk, which needs no cut, and
/// for the sphere, where every cut dangles. O(V + E). Source: MATH 1.
std::vector<Index> cutGraph(const Connectivity& surface, const TreeCotree& trees);

}  // namespace moduli
