#pragma once

#include <complex>
#include <vector>

#include "core/mesh/connectivity.h"

/// Islands of a layout side by side.
namespace moduli {

/// Between islands, over the root of the area of the faces.
inline constexpr double kIslandMargin = 0.01;

/// Where to put the lower left corners of rectangles (width + i height, >= 0) so that they lie at
/// least `gap` apart in a nearly square box with its corner at 0: the tallest first, each as low as
/// the skyline of those before it allows, in the best of a few widths of the box.
/// O(n log n + n s), s the steps of the skyline (about the root of n).
std::vector<std::complex<double>> packRectangles(const std::vector<std::complex<double>>& sizes,
                                                 double gap);

/// Moves islands, without turning them, so that their bounding boxes lie side by side, `margin`
/// times the root of the area of all faces apart, and cuts them from one another. island: per face,
/// from 0 on; what is sewn within an island stays so. grid: if above 0, islands are moved by whole
/// multiples of it, so that its lines go on across the cuts, and lie at least that far apart.
/// O(F + n s).
void packIslands(const Connectivity& surface, const std::vector<Index>& island, double margin,
                 std::vector<std::complex<double>>& points, std::vector<Index>& corner,
                 double grid = 0);

}  // namespace moduli
