#pragma once

#include <Eigen/SparseCore>
#include <memory>

#include "core/base/context.h"
#include "core/base/status.h"

namespace moduli {

/// Column-major; of a symmetric matrix the lower triangle is stored.
using SparseMatrix = Eigen::SparseMatrix<double>;

/// Sparse symmetric positive definite systems: analyse once, factorize for each set of values,
/// solve for many right-hand sides at once.
///
///   ASSIGN_OR_RETURN(SpdSolver solver, SpdSolver::make(context, matrix));
///   ASSIGN_OR_RETURN(Eigen::MatrixXd x, solver.solve(context, b));
///
/// CHOLMOD's supernodal factorization by default, Eigen's LDL^T with -DMODULI_WITH_CHOLMOD=OFF.
/// Movable, not copyable. One thread at a time.
class SpdSolver {
 public:
  /// Analyses and factorizes. matrix: n x n, lower triangle.
  /// Fails with kNotPositiveDefinite (naming the column where known), kCancelled,
  /// kDeadlineExceeded. About n^1.5 for meshes.
  static Result<SpdSolver> make(Context& context, const SparseMatrix& matrix);

  ~SpdSolver();
  SpdSolver(SpdSolver&&) noexcept;
  SpdSolver& operator=(SpdSolver&&) noexcept;

  /// Factorizes other values on the same pattern, keeping the symbolic analysis.
  Status refactorize(Context& context, const SparseMatrix& matrix);

  /// Solves for all columns of b (n x k) together. Checks each column's residual
  /// |b - A x| <= 1e-9 (|A| |x| + |b|) in the maximum norm after at most two steps of iterative
  /// refinement, and fails with kResidualTooLarge otherwise: a broken BLAS gives an error, not
  /// numbers.
  Result<Eigen::MatrixXd> solve(Context& context, const Eigen::MatrixXd& b) const;

  /// The largest relative residual that solve() has left so far.
  double largestResidual() const;

 private:
  struct Factor;
  explicit SpdSolver(std::unique_ptr<Factor> factor);
  std::unique_ptr<Factor> factor_;
};

}  // namespace moduli
