#include "core/optimize/formula_objective.h"

#include <vector>

namespace moduli {

Status FormulaObjective::moveTo(Context& context, const Eigen::VectorXd& x) {
  RETURN_IF_ERROR(context.check());
  if (x.size() != dimension_) {
    return {Reason::kInvalidOption, name_ + " has " + std::to_string(dimension_) +
                                        " unknowns, the point " + std::to_string(x.size())};
  }
  x_ = x;
  value_ = evaluate(gradient_);
  return {};
}

const SparseMatrix& FormulaObjective::hessian() {
  hessian_ = secondDerivatives();
  return hessian_;
}

SparseMatrix lowerOf(const Eigen::MatrixXd& matrix) {
  const Eigen::Index n = matrix.rows();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(n * (n + 1) / 2));
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i) {
      entries.emplace_back(static_cast<int>(i), static_cast<int>(j), matrix(i, j));
    }
  }
  SparseMatrix lower(n, n);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

SparseMatrix diagonalMatrix(const Eigen::VectorXd& diagonal) {
  SparseMatrix result(diagonal.size(), diagonal.size());
  result.reserve(Eigen::VectorXi::Ones(diagonal.size()));
  for (Eigen::Index i = 0; i < diagonal.size(); ++i) result.insert(i, i) = diagonal[i];
  result.makeCompressed();
  return result;
}

}  // namespace moduli
