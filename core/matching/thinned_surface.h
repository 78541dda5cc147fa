#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/ring_mesh.h"
#include "core/mesh/triangle_mesh.h"
#include "core/spherical/surface_point.h"

namespace moduli {

/// A closed surface of fewer vertices that stands for one of many: what is smooth on a surface is
/// as well seen on a tenth of its vertices, at a tenth of the cost.
struct ThinnedSurface {
  RingMesh rings;               ///< Of the whole surface; restore() leads back to it.
  TriangleMesh mesh;            ///< Of the vertices that stayed, where they were.
  std::vector<Index> vertices;  ///< Per vertex of `mesh` its number in the whole; ascending.
};

/// By thinEvenly, down to `wanted` vertices or as few as that leaves. Fails as RingMesh::make does
/// (not closed, doubled edges) and as Connectivity::fromFaces, with kCancelled and
/// kDeadlineExceeded. O(V log V). Stage: "thin".
Result<ThinnedSurface> thinSurface(Context& context, const TriangleMesh& mesh, Index wanted);

/// What vertices of the whole have of something, such as area, given to those that stayed: the sum
/// is the same. values: per vertex of the whole; the result is per vertex of thinned.mesh. A vertex
/// leaves its share to its ring, near ones more. O(V).
std::vector<double> gathered(const TriangleMesh& whole, const ThinnedSurface& thinned,
                             std::vector<double> values);

/// Per point of the thinned mesh the nearest one of the whole surface in space, by a walk from the
/// nearest corner: vertices stay where they are. O(edges on the way).
std::vector<SurfacePoint> onWhole(const TriangleMesh& whole, const ThinnedSurface& thinned,
                                  const std::vector<SurfacePoint>& points);

}  // namespace moduli
