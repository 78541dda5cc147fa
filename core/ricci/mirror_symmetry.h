#pragma once

#include <vector>

#include "core/mesh/double_cover.h"
#include "core/ricci/vertex_scaling.h"

/// Bordered surfaces by their doubles: metrics that the mirror symmetry keeps, with the boundary as
/// the geodesics that it fixes.
namespace moduli {

/// One unknown per vertex of the original, shared with its mirror image.
Unknowns mirrorUnknowns(const DoubleCover& cover);

/// Per edge of the double its length. lengths: per edge of the original.
std::vector<double> lengthsOnDouble(const DoubleCover& cover, const std::vector<double>& lengths);

/// Per vertex of the double its curvature: that of the original, twice on the boundary.
std::vector<double> curvaturesOnDouble(const DoubleCover& cover,
                                       const std::vector<double>& curvatures);

}  // namespace moduli
