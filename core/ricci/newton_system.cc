#include "core/ricci/newton_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace moduli {
namespace {

/// Relative to each diagonal entry; each try is a thousand times the one before.
constexpr double kFirstShift = 1e-14;
constexpr double kShiftGrowth = 1e3;
constexpr int kMaxShifts = 4;

}  // namespace

Status NewtonSystem::factorize(Context& context, bool same_pattern) {
  if (!solver_) {
    Result<SpdSolver> made = SpdSolver::make(context, matrix_);
    if (!made.ok()) return made.status();
    solver_ = *std::move(made);
    return {};
  }
  return same_pattern ? solver_->refactorize(context, matrix_)
                      : solver_->reanalyze(context, matrix_);
}

/// Rows and columns of the identity.
void NewtonSystem::isolate(const std::vector<bool>& fixed) {
  for (int column = 0; column < matrix_.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(matrix_, column); it; ++it) {
      const auto row = static_cast<std::size_t>(it.row());
      if (fixed[row] || fixed[static_cast<std::size_t>(column)]) {
        it.valueRef() = it.row() == column ? 1 : 0;
      }
    }
  }
}

Result<Eigen::VectorXd> NewtonSystem::direction(Context& context, const SparseMatrix& matrix,
                                                int pattern_version, bool constants_in_kernel,
                                                const std::vector<bool>& fixed,
                                                const Eigen::VectorXd& gradient) {
  const bool same_pattern = solver_ && pattern_version == pattern_version_;
  if (same_pattern) {
    std::copy_n(matrix.valuePtr(), matrix.nonZeros(), matrix_.valuePtr());
  } else {
    matrix_ = matrix;
    pattern_version_ = pattern_version;
  }
  if (matrix_.rows() == 0) return Eigen::VectorXd();
  // Every column starts with its diagonal entry.
  const auto diagonal = [&](Eigen::Index n) -> double& {
    return matrix_.valuePtr()[matrix_.outerIndexPtr()[n]];
  };
  for (Eigen::Index n = 0; n < matrix_.rows(); ++n) {
    diagonal(n) += std::abs(gradient[n]) / reach_;
  }
  if (constants_in_kernel) {
    // With the gradient orthogonal to constants this pins the unknown exactly.
    Eigen::Index stiffest = 0;
    for (Eigen::Index n = 1; n < matrix_.rows(); ++n) {
      if (diagonal(n) > diagonal(stiffest)) stiffest = n;
    }
    diagonal(stiffest) *= 2;
  }
  if (!fixed.empty()) isolate(fixed);
  Status status = factorize(context, same_pattern);
  double shift = kFirstShift;
  for (int n = 0; n < kMaxShifts && status.reason() == Reason::kNotPositiveDefinite; ++n) {
    const double largest = matrix_.coeffs().abs().maxCoeff();
    for (Eigen::Index row = 0; row < matrix_.rows(); ++row) {
      diagonal(row) += shift * std::max(diagonal(row), kFirstShift * largest);
    }
    shift *= kShiftGrowth;
    status = factorize(context, static_cast<bool>(solver_));
  }
  RETURN_IF_ERROR(status);
  ASSIGN_OR_RETURN(const Eigen::MatrixXd solution, solver_->solve(context, -gradient));
  return Eigen::VectorXd(solution.col(0));
}

}  // namespace moduli
