#pragma once

#include <Eigen/SparseCore>
#include <memory>

#include "core/base/context.h"
#include "core/base/status.h"

namespace moduli {

class FactorBackend;

/// Column-major; of a symmetric matrix the lower triangle is stored.
using SparseMatrix = Eigen::SparseMatrix<double>;

/// The largest sum of absolute values in a row of the whole symmetric matrix of a lower triangle:
/// no eigenvalue is larger (Gershgorin).
double maximumNorm(const SparseMatrix& lower);

/// Sparse symmetric positive definite systems: analyse once, factorize for each set of values,
/// solve for many right-hand sides at once.
///
///   ASSIGN_OR_RETURN(SpdSolver solver, SpdSolver::make(context, matrix));
///   ASSIGN_OR_RETURN(Eigen::MatrixXd x, solver.solve(context, b));
///
/// CHOLMOD's supernodal factorization by default, Eigen's LDL^T with -DMODULI_WITH_CHOLMOD=OFF.
/// The same input gives the same bytes on any number of threads: OpenBLAS is told, for the whole
/// process, to use one. Movable, not copyable. One thread at a time; several solvers may work on
/// several threads. Stages: "analyse", "factorize", "solve",
/// "invert".
class SpdSolver {
 public:
  /// Analyses and factorizes. matrix: n x n, lower triangle; n = 0 is allowed.
  /// Fails with kInvalidOption (not square, or entries above the diagonal), kNotPositiveDefinite
  /// (naming the column; non-finite entries too), kMeshTooLarge (no memory), kCancelled,
  /// kDeadlineExceeded. About n^1.5 for meshes.
  static Result<SpdSolver> make(Context& context, const SparseMatrix& matrix);

  /// The same on a given back end (core/linalg/factor_backend.h).
  static Result<SpdSolver> make(Context& context, const SparseMatrix& matrix,
                                std::unique_ptr<FactorBackend> backend);

  ~SpdSolver();
  SpdSolver(SpdSolver&&) noexcept;
  SpdSolver& operator=(SpdSolver&&) noexcept;

  /// Factorizes other values on the same pattern, keeping the symbolic analysis. Fails as make
  /// does, and with kInvalidOption for another pattern. After a failure solve() fails too, until a
  /// refactorize() succeeds.
  Status refactorize(Context& context, const SparseMatrix& matrix);

  /// Factorizes a matrix of the same size and another pattern, keeping the fill-reducing ordering
  /// where the back end can and it still serves (CHOLMOD: until a factorization costs a quarter
  /// more than the one it was found for). Fails as make does.
  Status reanalyze(Context& context, const SparseMatrix& matrix);

  /// Solves for all columns of b (n x k) together. Refines up to two times while the residual of
  /// a column is above rounding, then demands |b - A x| <= 1e-12 (|A| |x| + |b|) of each column in
  /// the maximum norm and fails with kResidualTooLarge otherwise: a broken BLAS gives an error,
  /// not numbers. (A correct Cholesky solve leaves about 1e-16, whatever the condition number.)
  /// Fails also with kInvalidOption (rows of b, no factorization), kCancelled, kDeadlineExceeded.
  Result<Eigen::MatrixXd> solve(Context& context, const Eigen::MatrixXd& b) const;

  /// The same without refinement, and without a look at the residual: half the time, for iterations
  /// that measure what they end with.
  Result<Eigen::MatrixXd> solveUnjudged(Context& context, const Eigen::MatrixXd& b) const;

  /// The entries of the inverse where `pattern` has some: n x n, lower triangle, its values do not
  /// matter. Places of the matrix itself are always there, and those that its factor fills.
  /// Demands |sum over j of A_ij Z_ij - 1| <= 1e-12 sum of |A_ij Z_ij| of every row of the result Z
  /// and fails with kResidualTooLarge otherwise. (About 1e-15 is left, whatever the condition.)
  /// Fails also with kInvalidOption (size, an entry outside the factor, no factorization),
  /// kMeshTooLarge (memory), kCancelled, kDeadlineExceeded. About as long as a factorization; as
  /// much memory as the factor. Stage "invert". Source: selected_inverse.h.
  Result<SparseMatrix> inverseOnPattern(Context& context, const SparseMatrix& pattern) const;

  /// The largest relative residual |b - A x| / (|A| |x| + |b|) that solve() has left so far, also
  /// where it failed.
  double largestResidual() const;

 private:
  struct Factor;
  Status checkReady() const;
  Status checkSide(const Eigen::MatrixXd& b) const;
  explicit SpdSolver(std::unique_ptr<Factor> factor);
  std::unique_ptr<Factor> factor_;
};

}  // namespace moduli
