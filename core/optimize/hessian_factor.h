#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/linalg/spd_solver.h"
#include "core/optimize/objective.h"

namespace moduli {

/// The Hessian of an objective, factorized point after point.
///
/// Where constants are in the kernel one unknown is fixed (the one with the largest diagonal
/// entry): its row and column are those of the identity, and answers are 0 there. The symbolic
/// analysis stays while the pattern does, the fill-reducing ordering for good. One thread at a
/// time.
class HessianFactor {
 public:
  /// What to do with a Hessian that is not positive definite.
  enum class Indefinite { kFail, kShift };

  /// Factorizes the Hessian where the objective is. kShift: with the first multiple of the identity
  /// that makes it positive definite, from 1e-12 of its norm (which heals what rounding has done)
  /// over 1e-4 to the norm, which suffices. Fails with kNotPositiveDefinite (kFail, or entries that
  /// are not finite), and as SpdSolver does. One factorization, up to nine with a shift.
  Status factorize(Context& context, Objective& objective, Indefinite indefinite);

  /// The solution of (H + shift) x = b; b: n entries, taken as 0 at the fixed unknown.
  Result<Eigen::VectorXd> solve(Context& context, const Eigen::VectorXd& b);

  /// (H + shift)^{-1} on the pattern of H, lower triangle, 0 at the fixed unknown: about one
  /// factorization (SpdSolver::inverseOnPattern).
  Result<SparseMatrix> inverse(Context& context);

  /// H + shift with the fixed unknown isolated; lower triangle.
  const SparseMatrix& matrix() const { return matrix_; }
  double shift() const { return shift_; }
  /// The norm of H: no eigenvalue is larger.
  double norm() const { return norm_; }
  /// The unknown that is fixed, -1 for none.
  Eigen::Index fixed() const { return fixed_; }
  /// N: the unknowns that are free.
  Eigen::Index freedom() const { return matrix_.rows() - (fixed_ >= 0 ? 1 : 0); }
  /// All so far.
  int factorizations() const { return factorizations_; }

 private:
  void take(Objective& objective);
  Status attempt(Context& context);
  void addShift(double shift);

  std::optional<SpdSolver> solver_;
  SparseMatrix matrix_;
  double shift_ = 0;
  double norm_ = 0;
  Eigen::Index fixed_ = -1;
  int pattern_version_ = 0;
  bool same_pattern_ = false;  ///< As the solver's last one.
  int factorizations_ = 0;
};

/// Makes row and column `index` of a symmetric matrix (lower triangle) those of the identity.
void isolate(SparseMatrix& lower, Eigen::Index index);

/// The unknown to fix of an objective with constants in the kernel; -1 for other objectives.
Eigen::Index fixedUnknown(const Objective& objective, const SparseMatrix& hessian);

}  // namespace moduli
