#pragma once

#include <array>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/spherical/surface_point.h"

namespace moduli {

/// A surface without edges that cut across it from boundary to boundary. Where a boundary is made
/// straight, such an edge would lie on it, and the faces that it cuts off would have no area.
struct ChordFreeMesh {
  TriangleMesh mesh;                    ///< Its first vertices are those of the surface.
  std::vector<Index> source;            ///< Per face the face of the surface that it is a part of.
  std::vector<Triangle> surface_faces;  ///< The surface's own.
  /// Per vertex that was added the ends of its edge, in the middle of which it is.
  std::vector<std::array<Index, 2>> ends;

  /// The same point on the surface. O(1).
  SurfacePoint onSurface(const SurfacePoint& point) const;
  /// The point of this mesh; of several the first part of its face. O(parts of the face).
  SurfacePoint fromSurface(const SurfacePoint& point) const;

  std::vector<Index> first_part;  ///< Per face of the surface; one more at the end.
};

/// Cuts every edge inside the surface whose ends are both on the boundary in its middle, and the
/// faces beside it. Fails as TriangleMesh::fromSoup does. O(V + F).
Result<ChordFreeMesh> splitChords(const TriangleMesh& surface);

}  // namespace moduli
