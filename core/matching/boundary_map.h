#pragma once

#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/spherical/surface_point.h"

namespace moduli {

/// A map of the boundary of a surface onto that of another: loops go to loops, once around each.
struct BoundaryMap {
  std::vector<Index> loops;  ///< Per loop of A the one of B, both numbered as computeTopology does.
  std::vector<Index> edges;  ///< Per vertex of A the boundary halfedge of B it is on; kNone inside.
  std::vector<SurfacePoint> points;  ///< Per vertex of A, on that halfedge; of no use inside.
  /// Per halfedge of A, of use on the boundary: how many edges further on than that of its tail the
  /// edge of its head is.
  std::vector<Index> steps;
};

/// The boundary map that is nearest to where boundary vertices of A ought to go: each loop of A
/// goes to the loop of B that is nearest to its targets, and each of its vertices to the point
/// there that is nearest to its own, as far as these keep their order (orderedAroundCircle).
///
/// points: per vertex of A its target on B. loops: where known, per loop of A the one of B that it
/// goes to; kNone elsewhere, and empty where nothing is known. Fails with kUnsupportedTopology
/// (numbers of loops differ or are 0). O(loops E log V).
Result<BoundaryMap> fitBoundary(const TriangleMesh& a, const TriangleMesh& b,
                                const std::vector<SurfacePoint>& points,
                                const std::vector<Index>& loops = {});

}  // namespace moduli
