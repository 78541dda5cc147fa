#include "core/linalg/spd_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/linalg/factor_backend.h"
#include "core/linalg/selected_inverse.h"

namespace moduli {
namespace {

constexpr int kRefinements = 2;
/// Refinement cannot improve a residual below this: x itself is rounded.
constexpr double kRounding = 2 * std::numeric_limits<double>::epsilon();
constexpr double kAccepted = 1e-12;

Status checkMatrix(const SparseMatrix& matrix, bool values_too = true) {
  if (matrix.rows() != matrix.cols() || !matrix.isCompressed()) {
    return {Reason::kInvalidOption, "the matrix is not square or not compressed"};
  }
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(matrix, column); it; ++it) {
      if (it.row() < column) {
        return {Reason::kInvalidOption, "column " + std::to_string(column) +
                                            " of the matrix has an entry above the diagonal"};
      }
      if (values_too && !std::isfinite(it.value())) return notPositiveDefinite(column);
    }
  }
  return {};
}

bool samePattern(const SparseMatrix& a, const SparseMatrix& b) {
  return a.rows() == b.rows() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr());
}

/// The largest absolute value, infinity where there is a NaN.
double largest(const Eigen::Ref<const Eigen::VectorXd>& x) {
  double result = 0;
  for (const double value : x) {
    if (std::isnan(value)) return std::numeric_limits<double>::infinity();
    result = std::max(result, std::abs(value));
  }
  return result;
}

/// The diagonal of matrix * inverse must be 1, and needs no entries of the inverse but these.
Status judgeInverse(const SparseMatrix& matrix, const SparseMatrix& inverse) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(matrix.rows());
  Eigen::VectorXd sizes = sums;
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    SparseMatrix::InnerIterator entry(inverse, column);
    for (SparseMatrix::InnerIterator it(matrix, column); it; ++it, ++entry) {
      const double product = it.value() * entry.value();
      sums[it.row()] += product;
      sizes[it.row()] += std::abs(product);
      if (it.row() == column) continue;
      sums[column] += product;
      sizes[column] += std::abs(product);
    }
  }
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    const double relative = std::abs(sums[row] - 1) / sizes[row];
    if (relative <= kAccepted) continue;
    return {Reason::kResidualTooLarge,
            "the inverse leaves a relative residual of " + shortestDouble(relative) + " in row " +
                std::to_string(row) + " where 1e-12 is allowed",
            "check that the BLAS library computes correctly"};
  }
  return {};
}

struct ColumnResidual {
  Eigen::Index column = 0;
  double relative = 0;
};

}  // namespace

double maximumNorm(const SparseMatrix& lower) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(lower.rows());
  for (Eigen::Index column = 0; column < lower.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(lower, column); it; ++it) {
      sums[it.row()] += std::abs(it.value());
      if (it.row() != column) sums[column] += std::abs(it.value());
    }
  }
  return sums.size() == 0 ? 0 : sums.maxCoeff();
}

struct SpdSolver::Factor {
  std::unique_ptr<FactorBackend> backend;
  SparseMatrix matrix;
  double norm = 0;
  double largest_residual = 0;
  bool ready = false;  ///< The last factorization succeeded.

  Status factorize(Context& context) {
    const Context::Stage stage(context, "factorize");
    ready = false;
    RETURN_IF_ERROR(context.check());
    norm = maximumNorm(matrix);
    if (matrix.rows() > 0) RETURN_IF_ERROR(backend->factorize(matrix));
    ready = true;
    return context.check();
  }

  /// The worst column by |residual| / (|A| |x| + |b|).
  ColumnResidual judge(const Eigen::MatrixXd& b, const Eigen::MatrixXd& x,
                       const Eigen::MatrixXd& residual) const {
    ColumnResidual worst;
    for (Eigen::Index j = 0; j < b.cols(); ++j) {
      const double left = largest(residual.col(j));
      if (left == 0) continue;
      const double relative = left / (norm * largest(x.col(j)) + largest(b.col(j)));
      // An overflow of the scale must not pass as a small residual.
      const double judged =
          std::isfinite(relative) && std::isfinite(left) && std::isfinite(largest(x.col(j)))
              ? relative
              : std::numeric_limits<double>::infinity();
      if (judged > worst.relative) worst = {j, judged};
    }
    return worst;
  }
};

SpdSolver::SpdSolver(std::unique_ptr<Factor> factor) : factor_(std::move(factor)) {}
SpdSolver::~SpdSolver() = default;
SpdSolver::SpdSolver(SpdSolver&&) noexcept = default;
SpdSolver& SpdSolver::operator=(SpdSolver&&) noexcept = default;

Result<SpdSolver> SpdSolver::make(Context& context, const SparseMatrix& matrix) {
  return make(context, matrix, makeBackend(availableBackends().front()));
}

Result<SpdSolver> SpdSolver::make(Context& context, const SparseMatrix& matrix,
                                  std::unique_ptr<FactorBackend> backend) {
  RETURN_IF_ERROR(checkMatrix(matrix));
  auto factor = std::make_unique<Factor>();
  factor->backend = std::move(backend);
  factor->matrix = matrix;
  {
    const Context::Stage stage(context, "analyse");
    RETURN_IF_ERROR(context.check());
    if (matrix.rows() > 0) RETURN_IF_ERROR(factor->backend->analyze(factor->matrix));
  }
  RETURN_IF_ERROR(factor->factorize(context));
  return SpdSolver(std::move(factor));
}

Status SpdSolver::refactorize(Context& context, const SparseMatrix& matrix) {
  RETURN_IF_ERROR(checkMatrix(matrix));
  if (!samePattern(matrix, factor_->matrix)) {
    return {Reason::kInvalidOption, "the matrix has another pattern than the one analysed"};
  }
  factor_->matrix = matrix;
  return factor_->factorize(context);
}

Status SpdSolver::reanalyze(Context& context, const SparseMatrix& matrix) {
  RETURN_IF_ERROR(checkMatrix(matrix));
  if (matrix.rows() != factor_->matrix.rows()) {
    return {Reason::kInvalidOption, "the matrix has another size than the one analysed"};
  }
  factor_->ready = false;
  factor_->matrix = matrix;
  {
    const Context::Stage stage(context, "analyse");
    RETURN_IF_ERROR(context.check());
    if (matrix.rows() > 0) RETURN_IF_ERROR(factor_->backend->reanalyze(factor_->matrix));
  }
  return factor_->factorize(context);
}

Status SpdSolver::checkReady() const {
  if (factor_->ready) return {};
  return {Reason::kInvalidOption, "the last factorization failed: there is none to use"};
}

Status SpdSolver::checkSide(const Eigen::MatrixXd& b) const {
  RETURN_IF_ERROR(checkReady());
  if (b.rows() == factor_->matrix.rows()) return {};
  return {Reason::kInvalidOption, "the right-hand side has " + std::to_string(b.rows()) +
                                      " rows, the matrix " +
                                      std::to_string(factor_->matrix.rows())};
}

Result<Eigen::MatrixXd> SpdSolver::solveUnjudged(Context& context, const Eigen::MatrixXd& b) const {
  const Context::Stage stage(context, "solve");
  RETURN_IF_ERROR(checkSide(b));
  RETURN_IF_ERROR(context.check());
  if (b.size() == 0) return b;
  return factor_->backend->solve(b);
}

Result<Eigen::MatrixXd> SpdSolver::solve(Context& context, const Eigen::MatrixXd& b) const {
  const Context::Stage stage(context, "solve");
  Factor& factor = *factor_;
  RETURN_IF_ERROR(checkSide(b));
  RETURN_IF_ERROR(context.check());
  if (b.size() == 0) return b;
  const auto whole = factor.matrix.selfadjointView<Eigen::Lower>();
  ASSIGN_OR_RETURN(Eigen::MatrixXd x, factor.backend->solve(b));
  Eigen::MatrixXd residual = b - whole * x;
  ColumnResidual worst = factor.judge(b, x, residual);
  for (int step = 0; step < kRefinements && worst.relative > kRounding; ++step) {
    RETURN_IF_ERROR(context.check());
    ASSIGN_OR_RETURN(const Eigen::MatrixXd correction, factor.backend->solve(residual));
    Eigen::MatrixXd refined = x + correction;
    Eigen::MatrixXd remaining = b - whole * refined;
    const ColumnResidual judged = factor.judge(b, refined, remaining);
    if (!(judged.relative < worst.relative)) break;
    x = std::move(refined);
    residual = std::move(remaining);
    worst = judged;
  }
  factor.largest_residual = std::max(factor.largest_residual, worst.relative);
  if (worst.relative <= kAccepted) return x;
  return Status{Reason::kResidualTooLarge,
                "the solution of right-hand side " + std::to_string(worst.column) +
                    " leaves a relative residual of " + shortestDouble(worst.relative) +
                    " where 1e-12 is allowed",
                "check that the BLAS library computes correctly"};
}

Result<SparseMatrix> SpdSolver::inverseOnPattern(Context& context,
                                                 const SparseMatrix& pattern) const {
  const Context::Stage stage(context, "invert");
  RETURN_IF_ERROR(checkReady());
  RETURN_IF_ERROR(checkMatrix(pattern, false));
  const SparseMatrix& matrix = factor_->matrix;
  if (pattern.rows() != matrix.rows()) {
    return Status{Reason::kInvalidOption, "the pattern has " + std::to_string(pattern.rows()) +
                                              " rows, the matrix " + std::to_string(matrix.rows())};
  }
  RETURN_IF_ERROR(context.check());
  if (matrix.rows() == 0) return pattern;
  ASSIGN_OR_RETURN(BlockFactor blocks, factor_->backend->blocks());
  RETURN_IF_ERROR(invertBlocks(context, blocks));
  ASSIGN_OR_RETURN(const SparseMatrix there, entriesOnPattern(blocks, matrix));
  RETURN_IF_ERROR(judgeInverse(matrix, there));
  if (samePattern(pattern, matrix)) return there;
  return entriesOnPattern(blocks, pattern);
}

double SpdSolver::largestResidual() const {
  return factor_->largest_residual;
}

}  // namespace moduli
