#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/cover_map.h"

namespace moduli {

/// Faces around which the product of transitions is not 1.
std::vector<Index> openFaces(const Connectivity& surface, const std::vector<Motion>& transitions);

/// Changes transitions so that faces close: where an edge went around a thin limb on the wrong
/// side, the faces beside it are open, and their products are inverse to each other. Of an open
/// face one transition is changed so that it closes, and so on from face to face until one closes
/// by itself; of all such ways, those on both sides of handles among them, the one whose changed
/// edges become least longer in the plane, nearest pairs first. Edges of a boundary stay. Fails with
/// kCancelled and kDeadlineExceeded. Where faces stay open, none was found. O(open faces) searches
/// of at most 20,000 steps.
Result<std::vector<Motion>> closeLinks(Context& context, const Connectivity& surface,
                                       const CoverPlane& plane,
                                       const std::vector<Eigen::Vector3d>& places,
                                       std::vector<Motion> transitions);

}  // namespace moduli
