#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/spherical/circle.h"

namespace moduli {

struct CircleDomainCapacity {
  /// (b - 1) x (b - 1): inner products of the differentials of the harmonic functions u_k that are
  /// 1 on circle k and 0 on the others, k = 1 .. b - 1. Symmetrized.
  Eigen::MatrixXd capacity;
  /// The largest difference of a function from its boundary values, at points that were not asked
  /// for them: by the maximum principle no function is farther from the exact one anywhere.
  double residual = 0;
  /// The largest difference of two entries that should be equal by symmetry.
  double asymmetry = 0;
};

/// The reduced flux matrix of a disk with round holes, without a mesh: BorderedPeriods::capacity of
/// a surface is to equal that of its circle domain. Each function is a sum of logarithms and
/// multipoles around the holes and of a polynomial, found by least squares on the circles; the
/// error falls geometrically with their number, which grows as circles come close.
///
/// circles: [0] encloses the others, which are disjoint (two at least, kInvalidOption otherwise).
/// Fails with kUnsupportedContent where circles are so close that more than 3,000 coefficients were
/// needed, and kResidualTooLarge where the residual exceeds 1e-8. O(n^3) for n coefficients: some
/// 100 a circle, and 300 where a gap is a tenth of the radius. Source: MATH 5.3.
Result<CircleDomainCapacity> circleDomainCapacity(Context& context,
                                                  const std::vector<Circle>& circles);

}  // namespace moduli
