#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/cover_map.h"

/// Maps between covers at points that are no vertices of the source: faces go to straight triangles
/// of the other surface's metric, a combination of corners to that of their vectors.
namespace moduli {

/// Where a point of A goes. map: without folded faces. O(faces on the way from the first corner).
SurfacePoint imageOf(const Connectivity& surface, const CoverSurface& cover, const CoverMap& map,
                     const SurfacePoint& point);

/// Per vertex of B, the first so many if that is told, the point of A that goes there: its place in
/// the triangulation that A's faces are of B, found from a vertex of A that goes near. map: without
/// folded faces. Fails with kCancelled, kDeadlineExceeded and kFoldedMap (every image is beyond the
/// boundary). O(V_B steps).
Result<std::vector<SurfacePoint>> invertCoverMap(Context& context, const Connectivity& surface,
                                                 const CoverSurface& cover, const CoverMap& map,
                                                 Index vertices = kNone);

}  // namespace moduli
