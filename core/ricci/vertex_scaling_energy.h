#pragma once

#include "core/intrinsic/geometry.h"

namespace moduli {

/// The energy of one face under vertex scaling, by which the angles become a gradient: its
/// derivative by u_i is pi less the angle at corner i. The energy of a surface with wanted angle
/// sums Theta_v is the sum over faces of this less pi times the sum of the face's u, plus the sum
/// over vertices of Theta_v u_v.
///
/// half_chords: before scaling, positive; entry c belongs to the side opposite corner c. u: per
/// corner; half chords are multiplied by e^{(u_i + u_j) / 2}. Convex and once continuously
/// differentiable for all u: where scaling breaks the triangle inequality, the angles are pi and
/// 0, 0, and the energy goes on as a linear function. Euclidean or hyperbolic; NaN for the sphere,
/// where there is no convex energy. The rounding error is that of pi times the largest |log x|.
/// O(1). Source: MATH 6.5; Bobenko, Pinkall and Springborn 2015, sections 4 to 6.
double vertexScalingEnergy(Geometry geometry, const TriangleValues& half_chords,
                           const TriangleValues& u);

/// The same where the angles are known: of the triangle whose half chords, scaled, have these
/// logarithms.
double vertexScalingEnergyOf(Geometry geometry, const TriangleValues& logarithms,
                             const TriangleValues& angles);

}  // namespace moduli
