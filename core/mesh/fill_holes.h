#pragma once

#include "core/base/context.h"
#include "core/mesh/triangle_soup.h"

namespace moduli {

/// Closes the boundary loops that are shorter than `fraction` of the square root of their
/// component's area, with new faces behind all others. Existing vertices and faces stay as they are
/// to the last bit. A loop of up to 256 edges is triangulated without new vertices where that
/// makes no edge that is there already; otherwise a new vertex at its centre meets all its edges.
/// The surface stays an oriented manifold. soup: an oriented manifold (a valid Inspection).
/// fraction: above 0. Returns how many loops were closed. Fails only with kCancelled,
/// kDeadlineExceeded or kInternal. O(F), and O(n^3) for a loop of n <= 256 edges.
Result<Index> fillHoles(Context& context, double fraction, TriangleSoup& soup);

}  // namespace moduli
