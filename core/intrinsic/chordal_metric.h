#pragma once

#include <vector>

#include "core/base/status.h"
#include "core/intrinsic/intrinsic_surface.h"

namespace moduli {

/// Per edge the length of its chord: twice the half chord, which is the length itself where the
/// surface is Euclidean. With these sides the faces are Euclidean triangles: those that a face of
/// the sphere spans in space, one of the hyperbolic plane in Minkowski's space.
///
/// Fails with kUnsupportedContent where a hyperbolic face has no circumscribed circle, and so no
/// such triangle (the faces of a Delaunay triangulation have one), and with kOverflow where a chord
/// exceeds a double; both name the element. O(F). Source: MATH 6.4.
Result<std::vector<double>> chordLengths(const IntrinsicSurface& surface);

}  // namespace moduli
