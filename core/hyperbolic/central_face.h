#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/hyperbolic/developing.h"
#include "core/hyperbolic/su11.h"

namespace moduli {

/// A face from whose centre those of the others are not far in the disk, were they laid out from
/// it in the order of their distances: a root for develop().
///
/// crossing: as in Development; centre: per face, from 0 to its centre in its coordinates. Faces
/// are gathered into patches of the size that some thousand have; `candidates` of them are tried:
/// the first, then each the farthest from those before, and at last the middles of what these see.
/// The radius about the face found is the smallest of theirs up to the size of two patches, some
/// percent of it; one of real surfaces was 4 % above the best of all. Fails as the context does.
/// O(F + candidates P log P) for P patches.
Result<Index> findCentralFace(Context& context, const HyperbolicTriangles& triangles,
                              const std::vector<Su11>& crossing, const std::vector<Su11>& centre,
                              int candidates);

}  // namespace moduli
