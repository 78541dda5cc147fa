#include "core/optimize/third_trace.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <optional>

#include "core/optimize/normal_deviates.h"
#include "core/optimize/tangent_inverse.h"

namespace moduli {
namespace {

constexpr int kMaxHalvings = 30;

/// Nothing where the value is infinite.
Result<std::optional<Eigen::VectorXd>> gradientAt(Context& context, Objective& objective,
                                                  const Eigen::VectorXd& x) {
  RETURN_IF_ERROR(context.check());
  const Status moved = objective.moveTo(context, x);
  if (moved.reason() == Reason::kNoConvergence) return std::optional<Eigen::VectorXd>();
  RETURN_IF_ERROR(moved);
  if (!std::isfinite(objective.value()) || !objective.gradient().allFinite()) {
    return std::optional<Eigen::VectorXd>();
  }
  return std::optional<Eigen::VectorXd>(objective.gradient());
}

Status noRoom() {
  return {Reason::kNoConvergence,
          "differences for third derivatives leave the domain of the objective",
          "take a smaller difference step"};
}

Result<Eigen::VectorXd> secondDifference(Context& context, Objective& objective,
                                         const Eigen::VectorXd& x, const Eigen::VectorXd& gradient,
                                         const Eigen::VectorXd& w, double step) {
  for (int n = 0; n < kMaxHalvings; ++n, step /= 2) {
    ASSIGN_OR_RETURN(const auto ahead, gradientAt(context, objective, x + step * w));
    if (!ahead) continue;
    ASSIGN_OR_RETURN(const auto behind, gradientAt(context, objective, x - step * w));
    if (!behind) continue;
    return Eigen::VectorXd(((*ahead - gradient) + (*behind - gradient)) / (step * step));
  }
  return noRoom();
}

Result<double> logDeterminantAt(Context& context, Objective& objective, const Eigen::VectorXd& x,
                                const Eigen::VectorXd& gradient, Eigen::Index fixed,
                                double isolated) {
  ASSIGN_OR_RETURN(const auto there, gradientAt(context, objective, x));
  if (!there) return noRoom();
  ASSIGN_OR_RETURN(const TangentInverse tangent,
                   tangentInverseBordered(denseHessian(objective, fixed, isolated), gradient));
  return tangent.log_determinant;
}

}  // namespace

EigenColumns eigenColumns(const Eigen::MatrixXd& P) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(P);
  const Eigen::ArrayXd values = spectrum.eigenvalues().array();
  EigenColumns result;
  result.columns = spectrum.eigenvectors() * values.abs().sqrt().matrix().asDiagonal();
  result.signs = (values < 0).select(-1.0, Eigen::ArrayXd::Ones(values.size()));
  return result;
}

Result<Eigen::VectorXd> tauAlong(Context& context, Objective& objective, const Eigen::VectorXd& x,
                                 const Eigen::VectorXd& gradient, const EigenColumns& along,
                                 double step) {
  // P is blind to the gradient: one eigenvalue is 0, and others may be as good as that.
  const double largest = along.columns.colwise().norm().maxCoeff();
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(x.size());
  for (Eigen::Index i = 0; i < along.columns.cols(); ++i) {
    const Eigen::VectorXd w = along.columns.col(i);
    if (!(w.norm() > 1e-7 * largest)) continue;
    ASSIGN_OR_RETURN(const Eigen::VectorXd second,
                     secondDifference(context, objective, x, gradient, w, step));
    tau += along.signs[i] * second;
  }
  return tau;
}

Result<Eigen::MatrixXd> tangentSamples(const SampleSpace& space, int count, std::uint64_t seed) {
  const Eigen::SimplicialLLT<SparseMatrix, Eigen::Lower> factor(space.hessian);
  if (factor.info() != Eigen::Success) {
    return Status{Reason::kNotPositiveDefinite, "the Hessian has no Cholesky factor to sample by"};
  }
  const double q = space.gradient.dot(space.newton);
  NormalDeviates deviates(seed);
  Eigen::MatrixXd samples = deviates.matrix(space.hessian.rows(), count);
  samples = factor.permutationPinv() * factor.matrixU().solve(samples).eval();
  if (space.fixed >= 0) samples.row(space.fixed).setZero();
  samples -= space.newton * (space.gradient.transpose() * samples / q);
  return samples;
}

Eigen::MatrixXd denseHessian(Objective& objective, Eigen::Index fixed, double isolated) {
  Eigen::MatrixXd hessian = denseOf(objective.hessian());
  if (fixed >= 0) {
    hessian.row(fixed).setZero();
    hessian.col(fixed).setZero();
    hessian(fixed, fixed) = isolated;
  }
  return hessian;
}

Result<Eigen::VectorXd> tauByLogDeterminant(Context& context, Objective& objective,
                                            const Eigen::VectorXd& x,
                                            const Eigen::VectorXd& gradient, Eigen::Index fixed,
                                            double step) {
  RETURN_IF_ERROR(objective.moveTo(context, x));
  const double isolated = denseOf(objective.hessian()).cwiseAbs().maxCoeff();
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (i == fixed) continue;
    const double h = step * (0.1 + std::abs(x[i]));
    std::array<double, 4> logs{};
    constexpr std::array<int, 4> kPlaces{-2, -1, 1, 2};
    for (std::size_t k = 0; k < 4; ++k) {
      Eigen::VectorXd there = x;
      there[i] += kPlaces[k] * h;
      ASSIGN_OR_RETURN(logs[k],
                       logDeterminantAt(context, objective, there, gradient, fixed, isolated));
    }
    tau[i] = (8 * (logs[2] - logs[1]) - (logs[3] - logs[0])) / (12 * h);
  }
  return tau;
}

}  // namespace moduli
