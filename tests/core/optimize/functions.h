#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "core/optimize/elementary_objectives.h"
#include "core/optimize/exponential_objectives.h"
#include "core/optimize/formula_objective.h"
#include "core/optimize/named_objectives.h"
#include "core/optimize/normal_deviates.h"
#include "core/optimize/tangent_inverse.h"

/// Functions and wrappers for the tests of minimizers.
namespace moduli {

/// y - phi(x) on the plane: its level sets are translates of the graph of phi.
class GraphOf : public FormulaObjective {
 public:
  /// phi(x, k): the k-th derivative, k = 0..3.
  explicit GraphOf(std::function<double(double, int)> phi)
      : FormulaObjective("graph", 2), phi_(std::move(phi)) {}
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override {
    return Eigen::Vector2d(-phi_(x()[0], 3) * weights.coeff(0, 0), 0);
  }

 protected:
  double evaluate(Eigen::VectorXd& gradient) override {
    gradient = Eigen::Vector2d(-phi_(x()[0], 1), 1);
    return x()[1] - phi_(x()[0], 0);
  }
  SparseMatrix secondDerivatives() const override {
    return lowerOf(Eigen::Vector2d(-phi_(x()[0], 2), 0).asDiagonal().toDenseMatrix());
  }

 private:
  std::function<double(double, int)> phi_;
};

/// c.x, all of whose level sets are flat.
class Linear : public FormulaObjective {
 public:
  explicit Linear(Eigen::VectorXd c) : FormulaObjective("linear", c.size()), c_(std::move(c)) {}
  Eigen::VectorXd thirdContraction(const SparseMatrix& /*weights*/) const override {
    return Eigen::VectorXd::Zero(dimension());
  }

 protected:
  double evaluate(Eigen::VectorXd& gradient) override {
    gradient = c_;
    return c_.dot(x());
  }
  SparseMatrix secondDerivatives() const override {
    return diagonalMatrix(Eigen::VectorXd::Zero(dimension()));
  }

 private:
  Eigen::VectorXd c_;
};

/// Sum over a ring of exp(x_i - x_{i+1}) + b_i (x_i - x_{i+1}): constants change nothing.
/// With `pinned` the last unknown is 0 and no unknown.
class Ring : public FormulaObjective {
 public:
  Ring(Eigen::VectorXd b, bool pinned)
      : FormulaObjective("ring", b.size() - (pinned ? 1 : 0)), b_(std::move(b)), pinned_(pinned) {}
  bool constantsInKernel() const override { return !pinned_; }
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override {
    const Eigen::MatrixXd P = denseOf(weights);
    Eigen::VectorXd tau = Eigen::VectorXd::Zero(b_.size());
    for (Eigen::Index i = 0; i < b_.size(); ++i) {
      const Eigen::Index j = next(i);
      const auto at = [&](Eigen::Index r, Eigen::Index s) {
        return r < P.rows() && s < P.rows() ? P(r, s) : 0;
      };
      const double along =
          std::exp(entry(i) - entry(j)) * (at(i, i) + at(j, j) - at(i, j) - at(j, i));
      tau[i] += along;
      tau[j] -= along;
    }
    return tau.head(dimension());
  }

 protected:
  double evaluate(Eigen::VectorXd& gradient) override {
    Eigen::VectorXd whole = Eigen::VectorXd::Zero(b_.size());
    double value = 0;
    for (Eigen::Index i = 0; i < b_.size(); ++i) {
      const double step = entry(i) - entry(next(i));
      value += std::exp(step) + b_[i] * step;
      whole[i] += std::exp(step) + b_[i];
      whole[next(i)] -= std::exp(step) + b_[i];
    }
    gradient = whole.head(dimension());
    return value;
  }
  SparseMatrix secondDerivatives() const override {
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(b_.size(), b_.size());
    for (Eigen::Index i = 0; i < b_.size(); ++i) {
      const Eigen::Index j = next(i);
      const double e = std::exp(entry(i) - entry(j));
      whole(i, i) += e;
      whole(j, j) += e;
      whole(i, j) -= e;
      whole(j, i) -= e;
    }
    return lowerOf(whole.topLeftCorner(dimension(), dimension()));
  }

 private:
  Eigen::Index next(Eigen::Index i) const { return (i + 1) % b_.size(); }
  double entry(Eigen::Index i) const { return i < dimension() ? x()[i] : 0; }

  Eigen::VectorXd b_;
  bool pinned_;
};

/// Passes everything on; tests change a part of it. Owns what it wraps.
class Wrapped : public Objective {
 public:
  explicit Wrapped(std::unique_ptr<Objective> inner) : inner_(std::move(inner)) {}
  Eigen::Index dimension() const override { return inner_->dimension(); }
  std::string name() const override { return inner_->name(); }
  bool constantsInKernel() const override { return inner_->constantsInKernel(); }
  Status moveTo(Context& context, const Eigen::VectorXd& x) override {
    if (on_move) on_move(x);
    return inner_->moveTo(context, x);
  }
  double value() const override { return change ? change(inner_->value()) : inner_->value(); }
  const Eigen::VectorXd& gradient() const override {
    gradient_ = gradient_scale * inner_->gradient();
    return gradient_;
  }
  const SparseMatrix& hessian() override { return inner_->hessian(); }
  bool hasThirdDerivatives() const override { return third; }
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override {
    return random_third ? NormalDeviates(random_third).vector(dimension())
                        : inner_->thirdContraction(weights);
  }

  std::function<void(const Eigen::VectorXd&)> on_move;
  std::function<double(double)> change;
  double gradient_scale = 1;
  bool third = true;
  std::uint64_t random_third = 0;  ///< A seed: the third derivatives are made up.

 private:
  std::unique_ptr<Objective> inner_;
  mutable Eigen::VectorXd gradient_;
};

inline NamedObjective named(const std::string& name, Eigen::Index n, double condition = 100,
                            std::uint64_t seed = 1) {
  ObjectiveOptions options;
  options.dimension = n;
  options.condition = condition;
  options.seed = seed;
  return *makeObjective(name, options);
}

/// A well-conditioned random matrix.
inline Eigen::MatrixXd randomMap(Eigen::Index n, std::uint64_t seed) {
  return NormalDeviates(seed).matrix(n, n) +
         2 * std::sqrt(static_cast<double>(n)) * Eigen::MatrixXd::Identity(n, n);
}

}  // namespace moduli
