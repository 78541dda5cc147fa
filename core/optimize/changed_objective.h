#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>

#include "core/optimize/objective.h"

/// Objectives seen through a change of variables or of values, for tests and tables of what methods
/// are blind to. Both own what they change, and have dense Hessians; neither keeps
/// constantsInKernel().
namespace moduli {

/// x -> f(B x + c).
class AffineChange : public Objective {
 public:
  /// B: n x n invertible; c: n entries.
  AffineChange(std::unique_ptr<Objective> inner, Eigen::MatrixXd B, Eigen::VectorXd c);

  Eigen::Index dimension() const override { return B_.cols(); }
  std::string name() const override { return "affine change of " + inner_->name(); }
  Status moveTo(Context& context, const Eigen::VectorXd& x) override;
  double value() const override { return inner_->value(); }
  const Eigen::VectorXd& gradient() const override { return gradient_; }
  const SparseMatrix& hessian() override;
  bool hasThirdDerivatives() const override { return inner_->hasThirdDerivatives(); }
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override;

  /// The point of f that x stands for.
  Eigen::VectorXd forward(const Eigen::VectorXd& x) const { return B_ * x + c_; }
  /// The x that stands for a point of f.
  Eigen::VectorXd backward(const Eigen::VectorXd& y) const;

 private:
  std::unique_ptr<Objective> inner_;
  Eigen::MatrixXd B_;
  Eigen::VectorXd c_;
  Eigen::VectorXd gradient_;
  SparseMatrix hessian_;
  SparseMatrix inner_pattern_;
};

/// phi(f), phi increasing.
class MonotoneTransform : public Objective {
 public:
  enum class Kind {
    kExponential,  ///< exp(scale f).
    kSquareRoot,   ///< sqrt(1 + scale f), for f > -1 / scale.
    kLogarithm,    ///< log(1 + scale f), for f > -1 / scale.
  };

  /// scale > 0.
  MonotoneTransform(std::unique_ptr<Objective> inner, Kind kind, double scale = 1);

  Eigen::Index dimension() const override { return inner_->dimension(); }
  std::string name() const override;
  Status moveTo(Context& context, const Eigen::VectorXd& x) override;
  double value() const override { return value_; }
  const Eigen::VectorXd& gradient() const override { return gradient_; }
  const SparseMatrix& hessian() override;
  bool hasThirdDerivatives() const override { return inner_->hasThirdDerivatives(); }
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override;

 private:
  std::unique_ptr<Objective> inner_;
  Kind kind_;
  double scale_;
  double value_ = 0;
  std::array<double, 4> phi_{};  ///< phi and its derivatives at f.
  Eigen::VectorXd gradient_;
  SparseMatrix hessian_;
  SparseMatrix inner_hessian_;
};

}  // namespace moduli
