#include "core/optimize/changed_objective.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <utility>

#include "core/optimize/formula_objective.h"
#include "core/optimize/tangent_inverse.h"

namespace moduli {

AffineChange::AffineChange(std::unique_ptr<Objective> inner, Eigen::MatrixXd B, Eigen::VectorXd c)
    : inner_(std::move(inner)), B_(std::move(B)), c_(std::move(c)) {}

Status AffineChange::moveTo(Context& context, const Eigen::VectorXd& x) {
  RETURN_IF_ERROR(inner_->moveTo(context, forward(x)));
  gradient_ = B_.transpose() * inner_->gradient();
  return {};
}

const SparseMatrix& AffineChange::hessian() {
  inner_pattern_ = inner_->hessian();
  hessian_ = lowerOf(B_.transpose() * denseOf(inner_pattern_) * B_);
  return hessian_;
}

Eigen::VectorXd AffineChange::thirdContraction(const SparseMatrix& weights) const {
  const Eigen::MatrixXd carried = B_ * denseOf(weights) * B_.transpose();
  return B_.transpose() * inner_->thirdContraction(onPattern(carried, inner_pattern_));
}

Eigen::VectorXd AffineChange::backward(const Eigen::VectorXd& y) const {
  return B_.partialPivLu().solve(y - c_);
}

MonotoneTransform::MonotoneTransform(std::unique_ptr<Objective> inner, Kind kind, double scale)
    : inner_(std::move(inner)), kind_(kind), scale_(scale) {}

std::string MonotoneTransform::name() const {
  switch (kind_) {
    case Kind::kExponential:
      return "exponential of " + inner_->name();
    case Kind::kSquareRoot:
      return "square root of " + inner_->name();
    case Kind::kLogarithm:
      return "logarithm of " + inner_->name();
  }
  return inner_->name();
}

Status MonotoneTransform::moveTo(Context& context, const Eigen::VectorXd& x) {
  RETURN_IF_ERROR(inner_->moveTo(context, x));
  const double f = inner_->value();
  const double base = 1 + scale_ * f;
  if (kind_ == Kind::kExponential) {
    const double e = std::exp(scale_ * f);
    phi_ = {e, scale_ * e, scale_ * scale_ * e, scale_ * scale_ * scale_ * e};
  } else if (kind_ == Kind::kSquareRoot) {
    const double r = std::sqrt(base);
    phi_ = {r, scale_ / (2 * r), -scale_ * scale_ / (4 * r * base),
            3 * scale_ * scale_ * scale_ / (8 * r * base * base)};
  } else {
    const double ratio = scale_ / base;
    phi_ = {std::log(base), ratio, -ratio * ratio, 2 * ratio * ratio * ratio};
  }
  const bool inside = kind_ == Kind::kExponential || base > 0;
  value_ = std::isinf(f) || !inside ? std::numeric_limits<double>::infinity() : phi_[0];
  gradient_ = phi_[1] * inner_->gradient();
  return {};
}

const SparseMatrix& MonotoneTransform::hessian() {
  inner_hessian_ = inner_->hessian();
  const Eigen::VectorXd& g = inner_->gradient();
  hessian_ = lowerOf(phi_[1] * denseOf(inner_hessian_) + phi_[2] * g * g.transpose());
  return hessian_;
}

Eigen::VectorXd MonotoneTransform::thirdContraction(const SparseMatrix& weights) const {
  const Eigen::MatrixXd P = denseOf(weights);
  const Eigen::MatrixXd H = denseOf(inner_hessian_);
  const Eigen::VectorXd& g = inner_->gradient();
  const Eigen::VectorXd Pg = P * g;
  return phi_[1] * inner_->thirdContraction(onPattern(P, inner_hessian_)) +
         phi_[2] * (H.cwiseProduct(P).sum() * g + 2 * (H * Pg)) + phi_[3] * g.dot(Pg) * g;
}

}  // namespace moduli
