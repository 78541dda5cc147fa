#include "core/signature/spherical_harmonics.h"

#include <cmath>
#include <numbers>

namespace moduli {

SphericalHarmonics::SphericalHarmonics(int degree)
    : degree_(degree),
      start_(degree + 1),
      rise_(Eigen::MatrixXd::Zero(degree + 1, degree + 1)),
      drop_(Eigen::MatrixXd::Zero(degree + 1, degree + 1)) {
  double diagonal = 1 / std::sqrt(4 * std::numbers::pi);
  for (int m = 0; m <= degree; ++m) {
    if (m > 0) diagonal *= std::sqrt((2.0 * m + 1) / (2.0 * m));
    start_[m] = m > 0 ? std::numbers::sqrt2 * diagonal : diagonal;
    for (int l = m + 1; l <= degree; ++l) {
      const double l2 = static_cast<double>(l) * l;
      const double m2 = static_cast<double>(m) * m;
      const double before2 = static_cast<double>(l - 1) * (l - 1);
      rise_(l, m) = std::sqrt((4 * l2 - 1) / (l2 - m2));
      drop_(l, m) = rise_(l, m) * std::sqrt((before2 - m2) / (4 * before2 - 1));
    }
  }
}

void SphericalHarmonics::project(const Eigen::Ref<const Eigen::MatrixX3d>& points,
                                 const Eigen::Ref<const Eigen::MatrixXd>& values,
                                 Eigen::Ref<Eigen::MatrixXd> coefficients) const {
  const Eigen::Index n = points.rows();
  const Eigen::Index fields = values.cols();
  const Eigen::ArrayXd z = points.col(2);
  Eigen::ArrayXd cosine = Eigen::ArrayXd::Ones(n);  // sin^m cos(m phi)
  Eigen::ArrayXd sine = Eigen::ArrayXd::Zero(n);
  Eigen::MatrixXd legendre(n, degree_ + 1);
  Eigen::MatrixX2d waves(n, 2);
  for (int m = 0; m <= degree_; ++m) {
    if (m > 0) {
      const Eigen::ArrayXd turned = cosine * points.col(0).array() - sine * points.col(1).array();
      sine = cosine * points.col(1).array() + sine * points.col(0).array();
      cosine = turned;
    }
    legendre.col(m).setConstant(start_[m]);
    if (m < degree_) legendre.col(m + 1).array() = rise_(m + 1, m) * start_[m] * z;
    for (int l = m + 2; l <= degree_; ++l) {
      legendre.col(l).array() =
          rise_(l, m) * z * legendre.col(l - 1).array() - drop_(l, m) * legendre.col(l - 2).array();
    }
    // One field at a time: its coefficients do not depend, to the last bit, on who else is there.
    for (Eigen::Index k = 0; k < fields; ++k) {
      waves.col(0) = values.col(k).array() * cosine;
      waves.col(1) = values.col(k).array() * sine;
      const Eigen::MatrixX2d sums = legendre.rightCols(degree_ + 1 - m).transpose() * waves;
      for (int l = m; l <= degree_; ++l) {
        coefficients(index(l, m), k) += sums(l - m, 0);
        if (m > 0) coefficients(index(l, -m), k) += sums(l - m, 1);
      }
    }
  }
}

Eigen::VectorXd SphericalHarmonics::evaluate(const Eigen::Vector3d& point) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(count());
  project(point.transpose(), Eigen::MatrixXd::Ones(1, 1), result);
  return result;
}

}  // namespace moduli
