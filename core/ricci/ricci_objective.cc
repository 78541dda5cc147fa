#include "core/ricci/ricci_objective.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace moduli {
namespace {

/// Of an integral: far below what a line search asks of values. The rule doubles its exact degrees
/// with each step, so that its last change is about the square root of its error.
constexpr double kStands = 1e-9;
constexpr int kMostPieces = 64;

/// Clenshaw and Curtis' weight of the node (1 - cos(pi k / n)) / 2 on [0, 1], n even.
double clenshawCurtisWeight(int k, int n) {
  double sum = 1;
  for (int j = 1; j <= n / 2; ++j) {
    const double share = 2 * j == n ? 1 : 2;
    sum -= share * std::cos(2 * std::numbers::pi * j * k / n) / (4.0 * j * j - 1);
  }
  return (k == 0 || k == n ? 1 : 2) * sum / (2 * n);
}

}  // namespace

RicciObjective::RicciObjective(CurvatureModel& model, Eigen::VectorXd target, Eigen::VectorXd start,
                               const std::vector<bool>& fixed)
    : model_(model),
      target_(std::move(target)),
      start_(std::move(start)),
      least_gradient_(std::numeric_limits<double>::infinity()) {
  for (Eigen::Index n = 0; n < model.size(); ++n) {
    if (fixed.empty() || !fixed[static_cast<std::size_t>(n)]) free_.push_back(n);
  }
}

Eigen::VectorXd RicciObjective::unknowns(const Eigen::VectorXd& x) const {
  Eigen::VectorXd u = start_;
  for (std::size_t n = 0; n < free_.size(); ++n) u[free_[n]] = x[static_cast<Eigen::Index>(n)];
  return u;
}

Eigen::VectorXd RicciObjective::variables(const Eigen::VectorXd& u) const {
  Eigen::VectorXd x(dimension());
  for (std::size_t n = 0; n < free_.size(); ++n) x[static_cast<Eigen::Index>(n)] = u[free_[n]];
  return x;
}

Eigen::VectorXd RicciObjective::gradientThere() const {
  Eigen::VectorXd gradient = variables(model_.curvature() - target_);
  if (constantsInKernel()) gradient.array() -= gradient.mean();
  return gradient;
}

Status RicciObjective::moveTo(Context& context, const Eigen::VectorXd& x) {
  if (x_.size() == x.size() && x_ == x) return {};
  x_.resize(0);
  RETURN_IF_ERROR(model_.moveTo(context, unknowns(x)));
  gradient_ = gradientThere();
  valued_ = false;
  if (!model_.hasEnergy()) {
    double value = 0;
    if (anchor_.size() == x.size()) {
      const Eigen::VectorXd step = x - anchor_;
      ASSIGN_OR_RETURN(
          const double change,
          integral(context, anchor_, x, anchor_gradient_.dot(step), gradient_.dot(step)));
      value = anchor_value_ + change;
      RETURN_IF_ERROR(model_.moveTo(context, unknowns(x)));
    }
    anchor_ = x;
    anchor_gradient_ = gradient_;
    anchor_value_ = value_ = value;
    valued_ = true;
  }
  x_ = x;
  if (gradient_.norm() < least_gradient_) {
    least_gradient_ = gradient_.norm();
    model_.accept();
  }
  return {};
}

/// Of the slope from `from` to `to`, by nested rules.
Result<double> RicciObjective::integral(Context& context, const Eigen::VectorXd& from,
                                        const Eigen::VectorXd& to, double first_slope,
                                        double last_slope) {
  std::vector<double> slopes{first_slope, last_slope};
  double result = (first_slope + last_slope) / 2;
  for (int pieces = 2; pieces <= kMostPieces; pieces *= 2) {
    std::vector<double> finer(static_cast<std::size_t>(pieces) + 1);
    double sum = 0, size = 0;
    for (int k = 0; k <= pieces; ++k) {
      const auto n = static_cast<std::size_t>(k);
      if (k % 2 == 0) {
        finer[n] = slopes[n / 2];
      } else {
        const double t = (1 - std::cos(std::numbers::pi * k / pieces)) / 2;
        RETURN_IF_ERROR(model_.moveTo(context, unknowns(from + t * (to - from))));
        finer[n] = gradientThere().dot(to - from);
      }
      const double weight = clenshawCurtisWeight(k, pieces);
      sum += weight * finer[n];
      size += weight * std::abs(finer[n]);
    }
    slopes = std::move(finer);
    const double change = std::abs(sum - result);
    result = sum;
    if (change <= kStands * size) break;
  }
  return result;
}

double RicciObjective::value() const {
  if (!valued_) {
    // The mean that the gradient lacks.
    const double mean = constantsInKernel() ? (model_.curvature() - target_).mean() : 0;
    const Eigen::VectorXd u = unknowns(x_);
    value_ = model_.energy() - target_.dot(u) - mean * u.sum();
    valued_ = true;
  }
  return value_;
}

const SparseMatrix& RicciObjective::hessian() {
  const SparseMatrix& whole = model_.hessian();
  if (dimension() == model_.size()) return whole;
  if (selected_version_ != model_.patternVersion()) {
    selectFree(whole);
    selected_version_ = model_.patternVersion();
  }
  for (std::size_t n = 0; n < place_.size(); ++n) {
    hessian_.valuePtr()[n] = whole.valuePtr()[place_[n]];
  }
  return hessian_;
}

void RicciObjective::selectFree(const SparseMatrix& whole) {
  std::vector<Eigen::Index> variable(static_cast<std::size_t>(model_.size()), -1);
  for (std::size_t n = 0; n < free_.size(); ++n) {
    variable[static_cast<std::size_t>(free_[n])] = static_cast<Eigen::Index>(n);
  }
  whole_pattern_ = whole;
  whole_pattern_.coeffs().setZero();
  hessian_ = SparseMatrix(dimension(), dimension());
  place_.clear();
  for (Eigen::Index column = 0; column < dimension(); ++column) {
    const Eigen::Index unknown = free_[static_cast<std::size_t>(column)];
    hessian_.startVec(column);
    for (int at = whole.outerIndexPtr()[unknown]; at < whole.outerIndexPtr()[unknown + 1]; ++at) {
      const Eigen::Index row = variable[static_cast<std::size_t>(whole.innerIndexPtr()[at])];
      if (row < 0) continue;
      hessian_.insertBack(row, column) = 0;
      place_.push_back(at);
    }
  }
  hessian_.finalize();
}

Eigen::VectorXd RicciObjective::thirdContraction(const SparseMatrix& weights) const {
  if (dimension() == model_.size()) return model_.thirdContraction(weights);
  SparseMatrix whole = whole_pattern_;
  for (std::size_t n = 0; n < place_.size(); ++n) {
    whole.valuePtr()[place_[n]] = weights.valuePtr()[n];
  }
  return variables(model_.thirdContraction(whole));
}

}  // namespace moduli
