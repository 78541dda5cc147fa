#pragma once

#include <array>

#include "core/base/status.h"

/// Lengths in right-angled hexagons and pentagons of curvature -1, and in the pairs of pants that
/// two equal hexagons make.
///
///   ASSIGN_OR_RETURN(const std::array<double, 3> seams, pantsSeams({1.0, 2.0, 3.0}));
///   seams[0];  // the distance of the cuffs of lengths 2 and 3
///
/// Every formula is evaluated without cancellation and without overflow, from cuffs of 1e-300 to
/// cuffs of 1000; results are right to some 1e-15 (1 + x) relative, x the longest length given,
/// which is what rounding the given lengths costs. Source: Buser 1992, Geometry and Spectra of
/// Compact Riemann Surfaces, chapter 2; MATH 7.7.
namespace moduli {

/// Sides a, b, c of a right-angled hexagon, no two of them neighbours, give every other side: this
/// is the one between a and b, opposite c: cosh d = (cosh c + cosh a cosh b) / (sinh a sinh b).
/// Precondition: a, b > 0, c >= 0 (c = 0: an ideal corner). O(1).
double hexagonSide(double a, double b, double c);

/// The seams of a pair of pants, the shortest paths between its cuffs: entry k is the one between
/// the cuffs k + 1 and k + 2 (mod 3). cuffs: their lengths. Fails with kInvalidOption unless all
/// are positive and finite. O(1).
Result<std::array<double, 3>> pantsSeams(const std::array<double, 3>& cuffs);

/// The cuffs of the pair of pants with these seams: the inverse of pantsSeams, for any positive
/// lengths. Fails with kInvalidOption unless all are positive and finite. O(1).
Result<std::array<double, 3>> pantsCuffs(const std::array<double, 3>& seams);

/// The sides of a right-angled pentagon in their order, from the first two, for which sinh a sinh b
/// > 1: sinh x_k sinh x_{k+1} = cosh x_{k+3}. Fails with kInvalidOption where there is no such
/// pentagon. The third to fifth are as sensitive to rounding as sinh a sinh b - 1 is near 0. O(1).
Result<std::array<double, 5>> pentagonSides(double a, double b);

/// Half the width of the annulus that every simple closed geodesic of this length has around it:
/// asinh(1 / sinh(length / 2)); those of disjoint geodesics are disjoint.
/// Precondition: length > 0. O(1). Source: Buser 1992, theorem 4.1.1.
double collarWidth(double length);

}  // namespace moduli
