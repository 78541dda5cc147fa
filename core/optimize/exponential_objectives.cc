#include "core/optimize/exponential_objectives.h"

#include <cmath>
#include <utility>

namespace moduli {
namespace {

/// Sum over k of e_k a_k a_k^T.
SparseMatrix secondMoments(const Eigen::MatrixXd& a, const Eigen::VectorXd& e) {
  return lowerOf(a * e.asDiagonal() * a.transpose());
}

/// Sum over k of e_k (a_k^T P a_k) a_k.
Eigen::VectorXd thirdMoments(const Eigen::MatrixXd& a, const Eigen::VectorXd& e,
                             const SparseMatrix& weights) {
  const Eigen::MatrixXd image = weights.selfadjointView<Eigen::Lower>() * a;
  const Eigen::VectorXd squares = a.cwiseProduct(image).colwise().sum().transpose();
  return a * e.cwiseProduct(squares);
}

}  // namespace

ExponentialSum::ExponentialSum(Eigen::MatrixXd a, Eigen::VectorXd b)
    : FormulaObjective("exp-sum", a.rows()), a_(std::move(a)), b_(std::move(b)) {}

double ExponentialSum::evaluate(Eigen::VectorXd& gradient) {
  terms_ = (a_.transpose() * x() + b_).array().exp();
  gradient = a_ * terms_;
  return terms_.sum();
}

SparseMatrix ExponentialSum::secondDerivatives() const {
  return secondMoments(a_, terms_);
}

Eigen::VectorXd ExponentialSum::thirdContraction(const SparseMatrix& weights) const {
  return thirdMoments(a_, terms_, weights);
}

LogSumExp::LogSumExp(Eigen::MatrixXd a, Eigen::VectorXd b)
    : FormulaObjective("log-sum-exp", a.rows()), a_(std::move(a)), b_(std::move(b)) {}

double LogSumExp::evaluate(Eigen::VectorXd& gradient) {
  const Eigen::VectorXd exponents = a_.transpose() * x() + b_;
  const double largest = exponents.maxCoeff();
  shares_ = (exponents.array() - largest).exp();
  const double sum = shares_.sum();
  shares_ /= sum;
  gradient = a_ * shares_;
  centered_ = a_.colwise() - gradient;
  return largest + std::log(sum);
}

SparseMatrix LogSumExp::secondDerivatives() const {
  return secondMoments(centered_, shares_);
}

Eigen::VectorXd LogSumExp::thirdContraction(const SparseMatrix& weights) const {
  return thirdMoments(centered_, shares_, weights);
}

}  // namespace moduli
