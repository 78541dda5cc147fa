#pragma once

#include <optional>

#include "core/base/context.h"
#include "core/hyperbolic/straight_faces.h"
#include "core/intrinsic/subdivide.h"
#include "core/ricci/uniformize.h"

namespace moduli {

/// The faces of a surface as triangles of a hyperbolic metric of it.
struct StraightSurface {
  HyperbolicTriangles triangles;                ///< Of the surface, with its boundary.
  std::optional<Subdivision> subdivision = {};  ///< Where faces were cut.
  Index folded = 0;                             ///< Faces that are turned over.
};

/// Lays the faces of a surface into its uniformization, as they are.
StraightSurface straighten(const Connectivity& surface, const Uniformization& uniformization);

/// The same with those faces cut along the edges of the uniformization's triangulation that turn
/// over, and no more of the others than it takes (subdivide.h); new vertices lie on edges, where
/// they cross the triangulation's. Fails with kCancelled and kDeadlineExceeded, and with
/// kFoldedMap where a face has a vertex twice. O(F + crossings).
Result<StraightSurface> straightenRefined(Context& context, const Connectivity& surface,
                                          const Uniformization& uniformization);

/// Puts counts[e] new vertices evenly on each edge of a surface that is not cut yet, and cuts the
/// faces beside them. Fails with kFoldedMap where a face is folded or has a vertex twice. O(F).
Result<StraightSurface> splitStraight(const HyperbolicTriangles& triangles,
                                      const std::vector<int>& counts);

}  // namespace moduli
