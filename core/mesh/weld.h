#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/mesh/triangle_soup.h"

namespace moduli {

/// Per vertex the one to use in its place: the lowest with exactly equal coordinates, or itself
/// where welding would make an edge with more than two faces or a one-sided surface.
/// Fails only with kCancelled or kDeadlineExceeded. O(V + F) per round; a handful of rounds.
Result<std::vector<Index>> planWeld(Context& context, const TriangleSoup& soup);

}  // namespace moduli
