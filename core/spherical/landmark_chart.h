#pragma once

#include <array>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/beltrami_field.h"
#include "core/spherical/surface_point.h"

/// One chart's step towards landmarks. Internal to this room.
namespace moduli::spherical {

/// A point of the surface that is to be at a point of the sphere now.
struct Pin {
  SurfacePoint point;
  Eigen::Vector3d target;
};

/// What a chart needs to know of the map that it changes.
struct ChartProblem {
  const Connectivity& surface;
  const BeltramiField& field;
  const BeltramiCoefficients& mu;  ///< Of the map as it is, by field.measure().
  const BeltramiCoefficients& nu;  ///< That the map is to have.
  const std::vector<Pin>& pins;
  double stiffness = 0;  ///< Radians: how far a landmark's pull spreads.
};

/// Moves the vertices that the stereographic projection from -pole brings nearer than `reach` to
/// the origin (the equator is the unit circle), all others held. With the generalized Laplace
/// operator L of the coefficients nu (MATH 2.3 c) in that chart the new map u + i v minimizes
///
///   u' L u + v' L v + stiffness^2 (|L u|^2 + |L v|^2) (norms by the inverse vertex areas)
///
/// under the pins in the moving part. The first term is the linear Beltrami system with coefficient
/// nu; points have no capacity in the plane, so alone it would let a pinned vertex run ahead of its
/// neighbours and fold the map; the second spreads the pull over the given distance. It is 0 for
/// every solution of the system too. Where nu is the map's own coefficient and the pins are met,
/// nothing moves. Pins in the same hemisphere as the pole go to their targets, others stay.
/// Fails with kInvalidOption where the pins contradict each other, and as SpdSolver does.
Result<Points3> relaxChart(Context& context, const ChartProblem& problem, Points3 points,
                           const Eigen::Vector3d& pole, double reach);

}  // namespace moduli::spherical
