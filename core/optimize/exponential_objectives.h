#pragma once

#include <Eigen/Core>

#include "core/optimize/formula_objective.h"

/// Convex functions made of exponentials of linear forms; each has a minimizer where 0 lies inside
/// the convex hull of the forms.
namespace moduli {

/// Sum over k of exp(a_k.x + b_k). a: n x K, the columns are the a_k; b: K entries.
class ExponentialSum : public FormulaObjective {
 public:
  ExponentialSum(Eigen::MatrixXd a, Eigen::VectorXd b);
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override;

 protected:
  double evaluate(Eigen::VectorXd& gradient) override;
  SparseMatrix secondDerivatives() const override;

 private:
  Eigen::MatrixXd a_;
  Eigen::VectorXd b_;
  Eigen::VectorXd terms_;
};

/// log of the sum over k of exp(a_k.x + b_k); sizes as above. Without overflow.
class LogSumExp : public FormulaObjective {
 public:
  LogSumExp(Eigen::MatrixXd a, Eigen::VectorXd b);
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override;

 protected:
  double evaluate(Eigen::VectorXd& gradient) override;
  SparseMatrix secondDerivatives() const override;

 private:
  Eigen::MatrixXd a_;
  Eigen::VectorXd b_;
  Eigen::VectorXd shares_;    ///< Of the terms in the sum.
  Eigen::MatrixXd centered_;  ///< a_k less the mean by shares.
};

}  // namespace moduli
