#pragma once

#include <Eigen/Core>

#include "core/optimize/formula_objective.h"

/// Test functions whose minimizers are known.
namespace moduli {

/// (x - center)^T A (x - center) / 2. A: n x n symmetric, of any signature.
class Quadratic : public FormulaObjective {
 public:
  Quadratic(Eigen::MatrixXd A, Eigen::VectorXd center);
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override;

 protected:
  double evaluate(Eigen::VectorXd& gradient) override;
  SparseMatrix secondDerivatives() const override;

 private:
  Eigen::MatrixXd A_;
  Eigen::VectorXd center_;
};

/// Sum of x_i^4: convex, with a Hessian that vanishes at the minimizer 0.
class Quartic : public FormulaObjective {
 public:
  explicit Quartic(Eigen::Index dimension);
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override;

 protected:
  double evaluate(Eigen::VectorXd& gradient) override;
  SparseMatrix secondDerivatives() const override;
};

/// Sum over i of 100 (x_{i+1} - x_i^2)^2 + (1 - x_i)^2, chained; 0 at (1, ..., 1). n >= 2.
class Rosenbrock : public FormulaObjective {
 public:
  explicit Rosenbrock(Eigen::Index dimension);
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override;

 protected:
  double evaluate(Eigen::VectorXd& gradient) override;
  SparseMatrix secondDerivatives() const override;
};

/// c.x - sum of log x_i, for positive x; least at x_i = 1 / c_i where c is positive, unbounded
/// below otherwise.
class LogBarrier : public FormulaObjective {
 public:
  explicit LogBarrier(Eigen::VectorXd c);
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override;

 protected:
  double evaluate(Eigen::VectorXd& gradient) override;
  SparseMatrix secondDerivatives() const override;

 private:
  Eigen::VectorXd c_;
};

}  // namespace moduli
