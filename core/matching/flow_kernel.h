#pragma once

/// What flows to landmarks have in common: flowToLandmarks and flowOnHemisphere.
namespace moduli {

/// Of a kernel, in ways that its landmark has before it at first.
inline constexpr double kFlowReach = 6;
/// And at least, in edges.
inline constexpr double kFlowEdges = 3;
/// Of a kernel's reach: how far a landmark goes in one step.
inline constexpr double kFlowStep = 0.1;
/// Of an edge.
inline constexpr double kFlowMet = 1e-7;
inline constexpr int kMostFlowSteps = 200, kMostFlowHalvings = 12;

/// Smooth, 1 at 0 and 0 from 1 on (Wendland 1995).
inline double flowKernel(double x) {
  if (!(x < 1)) return 0;
  const double rest = (1 - x) * (1 - x);
  return rest * rest * (4 * x + 1);
}

}  // namespace moduli
