#include "core/optimize/tangent_inverse.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace moduli {
namespace {

/// Of the largest entry of the Hessian: smaller curvatures of a level set are rounding.
constexpr double kFlat = 1e-14;

Status flatLevelSet() {
  return {Reason::kNotPositiveDefinite,
          "the Hessian is singular on the tangent space: the level set is flat in a direction and "
          "has no affine normal",
          "start elsewhere or take the method gradient"};
}

}  // namespace

Result<TangentInverse> tangentInverseBordered(const Eigen::MatrixXd& hessian,
                                              const Eigen::VectorXd& gradient) {
  const Eigen::Index n = gradient.size();
  const double scale = hessian.cwiseAbs().maxCoeff();
  TangentInverse result;
  if (n == 1) return TangentInverse{Eigen::MatrixXd::Zero(1, 1), 0, true};
  if (!(scale > 0) || !std::isfinite(scale)) return flatLevelSet();
  // Both blocks of size 1, so that pivots compare.
  Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + 1, n + 1);
  bordered.topLeftCorner(n, n) = hessian / scale;
  bordered.col(n).head(n) = gradient.normalized();
  bordered.row(n).head(n) = gradient.normalized().transpose();
  // Its eigenvalues are known to Sylvester: 1 positive and 1 negative more than those of U^T H U.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(bordered, Eigen::EigenvaluesOnly);
  if (!(spectrum.eigenvalues().cwiseAbs().minCoeff() > kFlat)) return flatLevelSet();
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(bordered);
  Eigen::MatrixXd inverse = lu.inverse();
  // One step of Newton's iteration for inverses takes the pivoting's rounding away.
  inverse += inverse * (Eigen::MatrixXd::Identity(n + 1, n + 1) - bordered * inverse);
  result.P = inverse.topLeftCorner(n, n) / scale;
  result.P = (0.5 * (result.P + result.P.transpose())).eval();
  result.log_determinant = lu.matrixLU().diagonal().cwiseAbs().array().log().sum() +
                           static_cast<double>(n - 1) * std::log(scale);
  result.positive = spectrum.eigenvalues()[1] > 0;
  return result;
}

Eigen::MatrixXd tangentBasis(const Eigen::VectorXd& gradient) {
  const Eigen::Index n = gradient.size();
  // The reflection that takes the first axis to -sign(nu_0) nu; its other columns span nu^perp.
  Eigen::VectorXd v = gradient.normalized();
  v[0] += v[0] < 0 ? -1.0 : 1.0;
  const Eigen::MatrixXd reflection =
      Eigen::MatrixXd::Identity(n, n) - (2 / v.squaredNorm()) * v * v.transpose();
  return reflection.rightCols(n - 1);
}

Result<TangentInverse> tangentInverseByBasis(const Eigen::MatrixXd& hessian,
                                             const Eigen::VectorXd& gradient) {
  if (gradient.size() == 1) return TangentInverse{Eigen::MatrixXd::Zero(1, 1), 0, true};
  const double scale = hessian.cwiseAbs().maxCoeff();
  if (!(scale > 0) || !std::isfinite(scale)) return flatLevelSet();
  const Eigen::MatrixXd basis = tangentBasis(gradient);
  const Eigen::MatrixXd restricted = basis.transpose() * hessian * basis;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(restricted);
  const Eigen::VectorXd& values = spectrum.eigenvalues();
  if (!(values.cwiseAbs().minCoeff() > kFlat * scale)) return flatLevelSet();
  const Eigen::MatrixXd columns = basis * spectrum.eigenvectors();
  TangentInverse result;
  result.P = columns * values.cwiseInverse().asDiagonal() * columns.transpose();
  result.log_determinant = values.cwiseAbs().array().log().sum();
  result.positive = values[0] > 0;
  return result;
}

Eigen::MatrixXd denseOf(const SparseMatrix& lower) {
  return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
}

SparseMatrix onPattern(const Eigen::MatrixXd& matrix, const SparseMatrix& pattern) {
  SparseMatrix result = pattern;
  for (Eigen::Index column = 0; column < result.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(result, column); it; ++it) {
      it.valueRef() = matrix(it.row(), column);
    }
  }
  return result;
}

}  // namespace moduli
