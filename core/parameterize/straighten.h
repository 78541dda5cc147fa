#pragma once

#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/hyperbolic/straight_faces.h"
#include "core/intrinsic/subdivide.h"
#include "core/ricci/uniformize.h"

namespace moduli {

/// Faces before they are cut.
struct WholeFaces {
  HyperbolicTriangles triangles;  ///< With straight edges; angles negative where they fold.
  /// Per new vertex of a subdivision, in the frame of the straight edge (from its own tail) that it
  /// stands for a point of.
  std::vector<Complex> places;
};

/// The faces of a surface as triangles of a hyperbolic metric of it.
struct StraightSurface {
  HyperbolicTriangles triangles;                ///< Of the surface, with its boundary.
  std::optional<Subdivision> subdivision = {};  ///< Where faces were cut.
  Index folded = 0;                             ///< Faces that are turned over.
  std::optional<WholeFaces> whole = {};         ///< Where faces were cut.
};

/// Lays the faces of a surface into its uniformization, as they are.
StraightSurface straighten(const Connectivity& surface, const Uniformization& uniformization);

/// The same with those faces cut along the edges of the uniformization's triangulation that turn
/// over, and no more of the others than it takes (subdivide.h); new vertices lie on edges, where
/// they cross the triangulation's. Fails with kCancelled and kDeadlineExceeded, and with
/// kFoldedMap where a face has a vertex twice. O(F + crossings).
Result<StraightSurface> straightenRefined(Context& context, const Connectivity& surface,
                                          const Uniformization& uniformization);

/// Puts counts[e] new vertices evenly on each part of an edge of the given surface, between its
/// ends and the vertices that cut it, and cuts the faces beside them anew. Fails with kFoldedMap
/// where a face has a vertex twice, or is folded but for vertices on its sides. O(F).
Result<StraightSurface> splitStraight(const StraightSurface& surface,
                                      const std::vector<int>& counts);

/// Per edge of the given surface the length of its longest part. O(F).
std::vector<double> longestParts(const StraightSurface& surface);

}  // namespace moduli
