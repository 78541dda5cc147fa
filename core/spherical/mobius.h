#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"

/// Möbius maps of the unit ball, and the one that centres points on the sphere.
namespace moduli {

using Points3 = std::vector<Eigen::Vector3d>;

/// The Möbius map of the closed unit ball that carries `center` (|center| < 1) to 0 without
/// turning: T_c(x) = ((1 - |c|^2) x - (1 - 2 x.c + |x|^2) c) / (1 - 2 x.c + |c|^2 |x|^2). Source:
/// MATH 2.7.
Eigen::Vector3d ballTranslate(const Eigen::Vector3d& center, const Eigen::Vector3d& x);

struct MobiusCentering {
  Points3 points;  ///< On the unit sphere, with weighted mean 0.
  int iterations = 0;
  double residual = 0;  ///< |weighted mean| that is left.
};

/// Moves points of the unit sphere by a Möbius map so that their weighted mean is 0. The result is
/// unique for given points and weights, and equivariant under rotations.
/// weights: >= 0, not all 0. Fails with kInvalidOption (a point carries half of the weight or more,
/// sizes differ) or kNoConvergence. Newton with Armijo's rule; 4 to 10 steps of O(n).
/// Source: Springborn 2005; Baden, Crane, Kazhdan 2018; MATH 2.7.
Result<MobiusCentering> centerByMobius(Context& context, Points3 points,
                                       const std::vector<double>& weights);

}  // namespace moduli
