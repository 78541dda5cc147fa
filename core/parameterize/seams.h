#pragma once

#include <vector>

#include "core/mesh/connectivity.h"

/// Where a surface is cut open before it is laid out.
namespace moduli {

/// What a seam costs per edge: its length, and more the more pointed the surface is there, so that
/// seams keep away from tips and corners where they can. At a vertex with the curvature per area of
/// the round sphere of the same area (averaged over its faces and its neighbours') an edge counts
/// twice its length; the factor ends at 11. lengths: per edge, proper triangles; multiplying them
/// all changes nothing but the unit. O(F).
std::vector<double> seamCosts(const Connectivity& surface, const std::vector<double>& lengths);

/// Edges along which to cut a connected surface into a disk with all vertices of `through` on its
/// rim: paths between those, the boundary and the given seams, and loops around handles. Every
/// path and loop taken is the cheapest that the shortest paths from these ends offer, so that the
/// cost of the whole is at most twice the least possible on a surface without handles (Mehlhorn
/// 1988), and loops are a shortest basis of those through the ends (Erickson and Whittlesey 2005).
/// Boundary edges are seams, and so are the given ones, which may cut the surface into several
/// pieces; every piece is a disk then. through: per vertex. given: per edge; empty: none. costs:
/// per edge, >= 0. A closed surface with neither is cut through its most expensive vertex.
/// O(E log V).
std::vector<bool> chooseSeams(const Connectivity& surface, const std::vector<double>& costs,
                              const std::vector<bool>& through, const std::vector<bool>& given);

}  // namespace moduli
