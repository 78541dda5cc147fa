#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/forms/period_matrix.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// A number between certified bounds.
struct BoundedNumber {
  double value = 0;
  double lower = 0;
  double upper = 0;
};

/// The conformal invariants of a surface with boundary: the periods of its double.
struct BorderedPeriods {
  /// Of the double, whose genus is 2 g + b - 1.
  PeriodMatrix periods;
  /// (b - 1) x (b - 1): inner products of the differentials of the harmonic functions u_k that are
  /// 1 on boundary loop k and 0 on the others, k = 1 .. b - 1: the reduced flux matrix of the
  /// loops. Exact <= this (Loewner).
  Eigen::MatrixXd capacity;
  /// Annulus (g = 0, b = 2): log(r_out / r_in) / (2 pi), the height of the conformal cylinder of
  /// circumference 1.
  std::optional<BoundedNumber> modulus;
  double solver_residual = 0;
};

/// Periods of the double of a connected surface with b > 0 boundary loops under a metric (lengths
/// per edge, proper triangles), from the surface alone: the harmonic forms of the double that its
/// reflection keeps are tangential to the boundary, those that it negates are normal to it.
/// Bounds and exactness as computePeriods. Fails with kUnsupportedTopology (closed; a disk, all of
/// which are conformally one; several components) and as computePeriods. One symbolic and two
/// numerical factorizations, 2 (2 g + b - 1) back-substitutions. Stages "cohomology", "period" and
/// those of SpdSolver. Source: MATH 5.1, 5.3.
Result<BorderedPeriods> computeBorderedPeriods(Context& context, const Connectivity& surface,
                                               const std::vector<double>& lengths);

}  // namespace moduli
