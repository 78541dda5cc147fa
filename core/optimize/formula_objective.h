#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>

#include "core/optimize/objective.h"

namespace moduli {

/// What objectives given by a formula share: they keep the point, the value and the gradient. A
/// formula says how to fill them, and the Hessian when asked. It has third derivatives.
class FormulaObjective : public Objective {
 public:
  Eigen::Index dimension() const override { return dimension_; }
  std::string name() const override { return name_; }
  Status moveTo(Context& context, const Eigen::VectorXd& x) override;
  double value() const override { return value_; }
  const Eigen::VectorXd& gradient() const override { return gradient_; }
  const SparseMatrix& hessian() override;
  bool hasThirdDerivatives() const override { return true; }

 protected:
  FormulaObjective(std::string name, Eigen::Index dimension)
      : name_(std::move(name)),
        dimension_(dimension),
        x_(Eigen::VectorXd::Zero(dimension)),
        gradient_(Eigen::VectorXd::Zero(dimension)) {}

  const Eigen::VectorXd& x() const { return x_; }

  /// The value at x(); fills `gradient`, n entries. Infinite outside the domain; there the gradient
  /// is not looked at.
  virtual double evaluate(Eigen::VectorXd& gradient) = 0;
  /// The Hessian at x(), lower triangle, always of one pattern.
  virtual SparseMatrix secondDerivatives() const = 0;

 private:
  std::string name_;
  Eigen::Index dimension_;
  Eigen::VectorXd x_;
  double value_ = 0;
  Eigen::VectorXd gradient_;
  SparseMatrix hessian_;
};

/// The lower triangle of a symmetric matrix, all of it stored.
SparseMatrix lowerOf(const Eigen::MatrixXd& matrix);

/// A diagonal matrix.
SparseMatrix diagonalMatrix(const Eigen::VectorXd& diagonal);

}  // namespace moduli
