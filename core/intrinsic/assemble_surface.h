#pragma once

#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/intrinsic/intrinsic_surface.h"

namespace moduli {

/// A surface as someone states it, before anyone has judged it. Halfedge h = 3 f + c runs in face f
/// from corner c to corner (c + 1) % 3.
struct SurfaceTables {
  Geometry geometry = Geometry::kEuclidean;
  Index vertex_count = 0;
  std::vector<Triangle> faces;
  /// Per halfedge the opposite one, kNone on the boundary. Empty: faces are glued as
  /// Connectivity::fromFaces does.
  std::optional<std::vector<Index>> twin;
  std::vector<double> lengths;  ///< Per halfedge.
};

/// Makes a connected oriented manifold surface of tables. Both halfedges of an edge have the same
/// length up to 1e-12 of it; that of the lower one counts. twin, lengths: three entries a face (not
/// checked).
///
/// Fails, naming the element and what to do, with kEmpty, kMeshTooLarge, kCountTooLarge (more
/// vertices than corners), kIndexOutOfRange, kDegenerateFace (without a gluing: a face that repeats
/// a vertex), kNonManifoldEdge, kInvalidGluing (no involution, or halfedges whose ends do not
/// match), kInconsistentOrientation, kNonOrientable, kNonManifoldVertex, kMultipleComponents,
/// kInvalidMetric (a length that is not finite and positive, two for one edge, sides that break the
/// triangle inequality or, on the sphere, go all round it) and as the context does. O(V + F).
Result<IntrinsicSurface> assembleSurface(Context& context, SurfaceTables tables);

}  // namespace moduli
