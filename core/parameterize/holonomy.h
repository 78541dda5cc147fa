#pragma once

#include <complex>
#include <vector>

#include "core/mesh/connectivity.h"

namespace moduli {

/// How a direction turns when it is carried along closed ways of a flat surface with cones: per
/// loop of cohomologyBasis(computeTreeCotree) (2 g of a closed surface), radians, in (-pi, pi].
/// Around a cone it turns by the curvature; loops that are equal but for cones passed on the other
/// side differ by these. From the layout's final points: corner as Parameterization::corner.
/// surface: closed and connected, the faces of the layout. O(F + length of the loops). Source: MATH
/// 10.
std::vector<double> handleTurns(const Connectivity& surface,
                                const std::vector<std::complex<double>>& points,
                                const std::vector<Index>& corner);

/// The largest distance of angles from whole multiples of a unit, radians; 0 for none.
double distanceFromMultiples(const std::vector<double>& angles, double unit);

}  // namespace moduli
