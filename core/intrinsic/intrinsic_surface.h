#pragma once

#include <vector>

#include "core/intrinsic/geometry.h"
#include "core/mesh/connectivity.h"
#include "core/mesh/inspect.h"
#include "core/mesh/triangle_mesh.h"

namespace moduli {

/// A surface that is known from within alone: triangles, how they are glued, and the lengths of
/// their edges. Loops and double edges are allowed.
struct IntrinsicSurface {
  Connectivity connectivity;
  std::vector<double> lengths;  ///< Per edge, > 0; every face a proper triangle of `geometry`.
  Geometry geometry = Geometry::kEuclidean;

  /// Side c runs from corner c to the next one.
  TriangleValues sides(Index f) const {
    return {lengths[connectivity.edge(3 * f)], lengths[connectivity.edge(3 * f + 1)],
            lengths[connectivity.edge(3 * f + 2)]};
  }
};

/// What a mesh is without its positions. Its faces must have area. O(F).
IntrinsicSurface forgetPositions(const TriangleMesh& mesh);

/// Area in the surface's geometry: squared units of the lengths where it is Euclidean. O(F).
double surfaceArea(const IntrinsicSurface& surface);

/// The report on a connected surface. There is nothing wrong with one: what would be, keeps it from
/// being made. O(F).
Inspection inspectSurface(const IntrinsicSurface& surface);

}  // namespace moduli
