#include "core/optimize/hessian_factor.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace moduli {
namespace {

/// Of the norm: below, rounding alone can make a Hessian indefinite.
constexpr double kRoundingShift = 1e-12;
constexpr double kFirstShift = 1e-4;
constexpr double kShiftGrowth = 4;

}  // namespace

void isolate(SparseMatrix& lower, Eigen::Index index) {
  for (Eigen::Index column = 0; column < lower.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(lower, column); it; ++it) {
      if (it.row() != index && column != index) continue;
      it.valueRef() = it.row() == column ? 1 : 0;
    }
  }
}

Eigen::Index fixedUnknown(const Objective& objective, const SparseMatrix& hessian) {
  if (!objective.constantsInKernel() || hessian.rows() == 0) return -1;
  Eigen::Index stiffest = 0;
  const Eigen::VectorXd diagonal = hessian.diagonal();
  diagonal.maxCoeff(&stiffest);
  return stiffest;
}

void HessianFactor::take(Objective& objective) {
  const SparseMatrix& hessian = objective.hessian();
  if (solver_ && hessian.rows() != matrix_.rows()) solver_.reset();
  same_pattern_ =
      objective.patternVersion() == pattern_version_ && hessian.nonZeros() == matrix_.nonZeros();
  pattern_version_ = objective.patternVersion();
  matrix_ = hessian;
  matrix_.makeCompressed();
  norm_ = maximumNorm(matrix_);
  fixed_ = fixedUnknown(objective, matrix_);
  if (fixed_ >= 0) isolate(matrix_, fixed_);
}

Status HessianFactor::attempt(Context& context) {
  ++factorizations_;
  if (solver_) {
    const bool same = std::exchange(same_pattern_, true);
    return same ? solver_->refactorize(context, matrix_) : solver_->reanalyze(context, matrix_);
  }
  Result<SpdSolver> made = SpdSolver::make(context, matrix_);
  if (!made.ok()) return made.status();
  solver_ = *std::move(made);
  return {};
}

/// Makes the shift the given one; every column starts with its diagonal entry.
void HessianFactor::addShift(double shift) {
  for (Eigen::Index n = 0; n < matrix_.rows(); ++n) {
    if (n != fixed_) matrix_.valuePtr()[matrix_.outerIndexPtr()[n]] += shift - shift_;
  }
  shift_ = shift;
}

Status HessianFactor::factorize(Context& context, Objective& objective, Indefinite indefinite) {
  take(objective);
  shift_ = 0;
  Status status = attempt(context);
  if (indefinite == Indefinite::kFail || !std::isfinite(norm_)) return status;
  const double scale = norm_ > 0 ? norm_ : 1;
  double share = kRoundingShift;
  while (status.reason() == Reason::kNotPositiveDefinite && share < 2 * kShiftGrowth) {
    addShift(share * scale);
    status = attempt(context);
    share = std::max(kFirstShift, kShiftGrowth * share);
  }
  return status;
}

Result<Eigen::VectorXd> HessianFactor::solve(Context& context, const Eigen::VectorXd& b) {
  if (!solver_) return Status{Reason::kInvalidOption, "there is no factorized Hessian to use"};
  Eigen::VectorXd side = b;
  if (fixed_ >= 0 && side.size() > fixed_) side[fixed_] = 0;
  ASSIGN_OR_RETURN(const Eigen::MatrixXd solution, solver_->solve(context, side));
  return Eigen::VectorXd(solution.col(0));
}

Result<SparseMatrix> HessianFactor::inverse(Context& context) {
  if (!solver_) return Status{Reason::kInvalidOption, "there is no factorized Hessian to use"};
  ASSIGN_OR_RETURN(SparseMatrix inverse, solver_->inverseOnPattern(context, matrix_));
  if (fixed_ >= 0) {
    isolate(inverse, fixed_);
    inverse.coeffRef(fixed_, fixed_) = 0;
  }
  return inverse;
}

}  // namespace moduli
