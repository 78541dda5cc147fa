#pragma once

#include <complex>
#include <vector>

#include "core/base/context.h"
#include "core/spherical/mobius_map.h"

namespace moduli {

struct DiskCentering {
  std::vector<std::complex<double>> points;  ///< In the unit disk, with weighted mean 0.
  MobiusMap map;                             ///< Keeps the disk and carries the input to `points`.
  int iterations = 0;
  double residual = 0;  ///< |weighted mean| that is left.
};

/// Moves points of the closed unit disk by an automorphism of the disk so that their weighted mean
/// is 0. The result is unique for given points and weights up to a rotation of the disk, of which
/// none is preferred: it turns and mirrors with its input. What lies on the unit circle stays
/// there.
/// weights: >= 0, not all 0. Fails with kInvalidOption (a point of the circle carries half of the
/// weight or more, a point lies outside, sizes differ) or kNoConvergence. Newton with Armijo's
/// rule on the potential sum w 2 log cosh(d / 2) of the hyperbolic distances d, which is strictly
/// convex and whose gradient is the mean; some 5 steps of O(n). Source: MATH 2.7 with H^2.
Result<DiskCentering> centerDisk(Context& context, const std::vector<std::complex<double>>& points,
                                 const std::vector<double>& weights);

}  // namespace moduli
