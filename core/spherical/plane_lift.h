#pragma once

#include <complex>
#include <utility>
#include <vector>

#include "core/spherical/mobius.h"

namespace moduli {

/// The value that half of the weight lies below. Takes pairs of a value and its weight, some > 0.
/// O(n log n).
double weightedMedian(std::vector<std::pair<double, double>> values_and_weights);

/// Moves and scales points of the plane so that half of the weight lies on each side of both axes
/// and of the unit circle, then lifts them to the sphere from the north pole. The plane keeps the
/// relative precision of a crowded region that the sphere's points could not. What runs
/// counter-clockwise in the plane runs clockwise on the sphere seen from outside. weights: >= 0,
/// not all 0. O(n log n).
Points3 balancedLift(const std::vector<std::complex<double>>& z,
                     const std::vector<double>& weights);

}  // namespace moduli
