#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/base/status.h"
#include "core/linalg/selected_inverse.h"
#include "core/linalg/spd_solver.h"

/// What SpdSolver needs from a direct solver. Only core/linalg and the tests that
/// plant faults include this.
namespace moduli {

/// One sparse Cholesky factorization. The answers of a back end are not trusted: SpdSolver judges
/// them by their residuals. One thread at a time; different objects are independent.
class FactorBackend {
 public:
  virtual ~FactorBackend() = default;

  /// Orders the unknowns and finds the pattern of the factor. matrix: n x n, n >= 1, lower
  /// triangle, compressed. Fails with kMeshTooLarge (out of memory).
  virtual Status analyze(const SparseMatrix& matrix) = 0;

  /// Finds the pattern of the factor of another matrix of the size last analysed, with the ordering
  /// of then if the back end can give one. Fails as analyze does.
  virtual Status reanalyze(const SparseMatrix& matrix) { return analyze(matrix); }

  /// Factorizes values on the analysed pattern. Fails with kNotPositiveDefinite naming the column.
  virtual Status factorize(const SparseMatrix& matrix) = 0;

  /// Solves with the last factorization, which must have succeeded. b: n x k.
  virtual Result<Eigen::MatrixXd> solve(const Eigen::MatrixXd& b) = 0;

  /// A copy of the last factor, which must have succeeded. Fails with kMeshTooLarge (out of
  /// memory).
  virtual Result<BlockFactor> blocks() = 0;
};

enum class BackendKind { kCholmod, kEigen };

/// The back ends of this build, the default one first.
const std::vector<BackendKind>& availableBackends();

/// kind: one of availableBackends().
std::unique_ptr<FactorBackend> makeBackend(BackendKind kind);

/// The errors that every back end gives in the same words.
Status notPositiveDefinite(Eigen::Index column);
Status outOfMemory();

std::unique_ptr<FactorBackend> makeEigenBackend();
std::unique_ptr<FactorBackend> makeCholmodBackend();

}  // namespace moduli
