#pragma once

#include <string>

#include "core/optimize/objective.h"

namespace moduli {

/// An objective that counts its evaluations; does not own it. Moving to where it is costs nothing.
class CountedObjective : public Objective {
 public:
  explicit CountedObjective(Objective& inner) : inner_(inner) {}

  Eigen::Index dimension() const override { return inner_.dimension(); }
  std::string name() const override { return inner_.name(); }
  bool constantsInKernel() const override { return inner_.constantsInKernel(); }
  Status moveTo(Context& context, const Eigen::VectorXd& x) override {
    if (there_ && x_.size() == x.size() && x_ == x) return {};
    RETURN_IF_ERROR(context.check());
    ++evaluations_;
    there_ = false;
    RETURN_IF_ERROR(inner_.moveTo(context, x));
    x_ = x;
    there_ = true;
    return {};
  }
  double value() const override { return inner_.value(); }
  const Eigen::VectorXd& gradient() const override { return inner_.gradient(); }
  const SparseMatrix& hessian() override { return inner_.hessian(); }
  int patternVersion() const override { return inner_.patternVersion(); }
  bool hasThirdDerivatives() const override { return inner_.hasThirdDerivatives(); }
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override {
    return inner_.thirdContraction(weights);
  }

  int evaluations() const { return evaluations_; }

 private:
  Objective& inner_;
  Eigen::VectorXd x_;
  bool there_ = false;
  int evaluations_ = 0;
};

}  // namespace moduli
