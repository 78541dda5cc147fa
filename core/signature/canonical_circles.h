#pragma once

#include <vector>

#include "core/spherical/circle.h"

namespace moduli {

/// The circles of a circle domain in the place and order that Möbius maps and the order of its
/// boundary loops do not change: two domains are conformally equivalent where these are the same.
///
///   [0]  the unit circle: the circle that is nearest to all others on average, by the hyperbolic
///        distance of the planes over two circles, 2 pi times the modulus of the annulus between
///        them
///   [1]  around 0: the one nearest to [0], and so the largest hole
///   [2]  of the others the one of the largest radius, its centre on the positive real axis
///   and the others by decreasing radius.
///
/// Distances and radii within 1e-3 of each other, relative, count as equal: as discrete maps know
/// symmetric holes to be equal only up to the error of the mesh, less would leave the choice to the
/// order of vertices. Holes of equal radius are in the order of the angles of their centres in
/// [0, 2 pi), and of the domains that equal choices make the one is taken whose first number that
/// differs by 1e-4 is larger, of each circle in turn the radius, Re and Im of its centre. Mirrored
/// domains get mirrored circles, but where those choices are equal by symmetry.
///
/// circles: three at least; [0] encloses the others, which are disjoint. O(b^2) for b circles, and
/// O(b log b) for each of the equal choices.
std::vector<Circle> canonicalCircles(const std::vector<Circle>& circles);

}  // namespace moduli
