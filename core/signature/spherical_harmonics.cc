#include "core/signature/spherical_harmonics.h"

#include <algorithm>
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
  for (Eigen::Index begin = 0; begin < points.rows(); begin += kBatch) {
    const Eigen::Index n = std::min<Eigen::Index>(kBatch, points.rows() - begin);
    // A short last batch is filled up with points that carry nothing.
    std::array<Batch, 3> point;
    for (int k = 0; k < 3; ++k) {
      point[k].setZero();
      point[k].head(n) = points.col(k).segment(begin, n).array();
    }
    std::vector<Wave> waves(values.cols());
    for (Eigen::Index k = 0; k < values.cols(); ++k) {
      waves[k].cosine.setZero();
      waves[k].cosine.head(n) = values.col(k).segment(begin, n).array();
      waves[k].sine.setZero();
    }
    projectBatch(point, waves, coefficients);
  }
}

// The sums of a field do not depend, to the last bit, on what other fields are there.
void SphericalHarmonics::projectBatch(const std::array<Batch, 3>& point, std::vector<Wave>& waves,
                                      Eigen::Ref<Eigen::MatrixXd> coefficients) const {
  const auto& [x, y, z] = point;
  for (int m = 0; m <= degree_; ++m) {
    if (m > 0) {
      for (Wave& wave : waves) {
        const Batch turned = wave.cosine * x - wave.sine * y;
        wave.sine = wave.cosine * y + wave.sine * x;
        wave.cosine = turned;
      }
    }
    Batch before = Batch::Zero();
    Batch legendre = Batch::Constant(start_[m]);
    for (int l = m; l <= degree_; ++l) {
      if (l > m) {
        const double rise = rise_(l, m);
        const double drop = drop_(l, m);
        before = rise * (z * legendre) - drop * before;
        before.swap(legendre);
      }
      for (std::size_t k = 0; k < waves.size(); ++k) {
        const auto column = static_cast<Eigen::Index>(k);
        coefficients(index(l, m), column) += legendre.matrix().dot(waves[k].cosine.matrix());
        if (m > 0) {
          coefficients(index(l, -m), column) += legendre.matrix().dot(waves[k].sine.matrix());
        }
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
