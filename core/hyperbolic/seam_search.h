#pragma once

#include <limits>
#include <vector>

#include "core/base/context.h"
#include "core/hyperbolic/cut_surface.h"

/// The common perpendiculars of the cuffs of a piece.
namespace moduli {

/// The shortest one from a cuff to another: where it starts, along the cuff from the frame's 0, and
/// its length.
struct Seam {
  double foot = 0;
  double length = std::numeric_limits<double>::infinity();
};

/// A copy of a part beside an axis over a curve.
struct SeamStart {
  Su11 frame;       ///< Carries the diameter to the axis, with the part on the left.
  double foot = 0;  ///< Where along the diameter the part touches it.
  Su11 copy;        ///< The copy of the polygon.
  int part = 0;
};

/// Per curve of a surface that is cut, starts on its left and on its right with frames that differ
/// by a half turn about one point: 2 n for n curves. Fails with kResidualTooLarge where a curve has
/// no part on a side. O(n) in the parts.
Result<std::vector<SeamStart>> seamStarts(const OrbitPolygon& polygon, const CutSurface& cut,
                                          std::size_t curves);

/// The seams from one side of a curve of the given length to the other sides that bound its pair of
/// pants; infinite for all others. From part to part of the copies of the polygon within the pants,
/// nearest to the axis first, as far as the longer of the two. Fails with kResidualTooLarge where
/// a million parts do not suffice. O(n log n) for n parts, some ten thousand for cuffs of 1e-3.
/// Precondition: the side bounds a pair of pants.
Result<std::vector<Seam>> findSeams(Context& context, const OrbitPolygon& polygon,
                                    const CutSurface& cut, int side, const SeamStart& start,
                                    double length);

}  // namespace moduli
