#pragma once

#include <vector>

#include "core/base/status.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// A surface some of whose boundary loops are closed by caps.
///
/// Faces and vertices of the original come first and keep their numbers; one apex per loop and one
/// face per halfedge of the loops follow, in the order of the loops. As edges are numbered by their
/// lowest halfedge, the original edges keep their numbers too, those of the loops included. The
/// spokes follow: spoke k of a loop, from the tail of its halfedge k to its apex, is edge E + (the
/// halfedges of the loops before it) + k.
struct CappedSurface {
  Connectivity connectivity;
  std::vector<double> lengths;  ///< Per edge; all faces of the caps are proper triangles.
  std::vector<Index> apex;      ///< Per loop its new vertex.
  Index face_count = 0;         ///< Of the original: caps are the faces from here on.
};

/// Radius of the caps' spokes for a loop with these sides (all > 0, one at least): the circumradius
/// of the closed polygon with its corners on a circle where its centre lies inside, so that the cap
/// is flat; but never less than 17/32 of the longest side, which keeps all triangles proper (their
/// angles at the apex stay below 141 degrees). O(n). Units of the sides.
double capRadius(const std::vector<double>& sides);

/// Closes boundary loops, each by a fan of isosceles triangles around one new vertex.
///
///   computeTopology(surface).boundary_loops -> some of them -> capLoops
///
/// lengths: per edge, > 0. loops: each the halfedges of one boundary loop in order, as
/// computeTopology gives them; a loop may consist of one or two edges. Fails with kInvalidOption
/// where a loop is none, where it comes twice and where sizes differ, naming the loop. O(V + F).
Result<CappedSurface> capLoops(const Connectivity& surface, const std::vector<double>& lengths,
                               const std::vector<std::vector<Index>>& loops);

}  // namespace moduli
