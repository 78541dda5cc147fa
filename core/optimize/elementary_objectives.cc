#include "core/optimize/elementary_objectives.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace moduli {

Quadratic::Quadratic(Eigen::MatrixXd A, Eigen::VectorXd center)
    : FormulaObjective("quadratic", center.size()), A_(std::move(A)), center_(std::move(center)) {}

double Quadratic::evaluate(Eigen::VectorXd& gradient) {
  gradient = A_ * (x() - center_);
  return 0.5 * gradient.dot(x() - center_);
}

SparseMatrix Quadratic::secondDerivatives() const {
  return lowerOf(A_);
}

Eigen::VectorXd Quadratic::thirdContraction(const SparseMatrix& /*weights*/) const {
  return Eigen::VectorXd::Zero(dimension());
}

Quartic::Quartic(Eigen::Index dimension) : FormulaObjective("quartic", dimension) {}

double Quartic::evaluate(Eigen::VectorXd& gradient) {
  gradient = 4 * x().array().cube();
  return x().array().square().square().sum();
}

SparseMatrix Quartic::secondDerivatives() const {
  return diagonalMatrix(12 * x().array().square());
}

Eigen::VectorXd Quartic::thirdContraction(const SparseMatrix& weights) const {
  return 24 * x().array() * weights.diagonal().array();
}

Rosenbrock::Rosenbrock(Eigen::Index dimension) : FormulaObjective("rosenbrock", dimension) {}

double Rosenbrock::evaluate(Eigen::VectorXd& gradient) {
  gradient.setZero();
  double value = 0;
  for (Eigen::Index i = 0; i + 1 < dimension(); ++i) {
    const double u = x()[i];
    const double off = x()[i + 1] - u * u;
    value += 100 * off * off + (1 - u) * (1 - u);
    gradient[i] -= 400 * u * off + 2 * (1 - u);
    gradient[i + 1] += 200 * off;
  }
  return value;
}

SparseMatrix Rosenbrock::secondDerivatives() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i + 1 < dimension(); ++i) {
    const double u = x()[i];
    entries.emplace_back(i, i, 1200 * u * u - 400 * x()[i + 1] + 2);
    entries.emplace_back(i + 1, i, -400 * u);
    entries.emplace_back(i + 1, i + 1, 200.0);
  }
  SparseMatrix result(dimension(), dimension());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

Eigen::VectorXd Rosenbrock::thirdContraction(const SparseMatrix& weights) const {
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(dimension());
  for (Eigen::Index i = 0; i + 1 < dimension(); ++i) {
    // f_uuu = 2400 u, f_uuv = -400.
    const double uu = weights.coeff(i, i);
    tau[i] += 2400 * x()[i] * uu - 800 * weights.coeff(i + 1, i);
    tau[i + 1] -= 400 * uu;
  }
  return tau;
}

LogBarrier::LogBarrier(Eigen::VectorXd c)
    : FormulaObjective("log-barrier", c.size()), c_(std::move(c)) {}

double LogBarrier::evaluate(Eigen::VectorXd& gradient) {
  if (!(x().minCoeff() > 0)) return std::numeric_limits<double>::infinity();
  gradient = c_ - x().cwiseInverse();
  return c_.dot(x()) - x().array().log().sum();
}

SparseMatrix LogBarrier::secondDerivatives() const {
  return diagonalMatrix(x().array().square().inverse());
}

Eigen::VectorXd LogBarrier::thirdContraction(const SparseMatrix& weights) const {
  return -2 * weights.diagonal().array() / x().array().cube();
}

}  // namespace moduli
