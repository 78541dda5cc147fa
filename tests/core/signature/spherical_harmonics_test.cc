#include "core/signature/spherical_harmonics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

constexpr int kDegree = 32;

/// Nodes and weights of Gauss and Legendre on [-1, 1].
std::vector<std::pair<double, double>> gaussLegendre(int n) {
  std::vector<std::pair<double, double>> rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
    double slope = 1;
    for (int step = 0; step < 20; ++step) {
      slope = n * (x * std::legendre(n, x) - std::legendre(n - 1, x)) / (x * x - 1);
      x -= std::legendre(n, x) / slope;
    }
    rule.emplace_back(x, 2 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

TEST(SphericalHarmonics, AreOrthonormal) {
  const SphericalHarmonics harmonics(kDegree);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(harmonics.count(), harmonics.count());
  // Exact for products of two harmonics: degree 64 in z and in the angle.
  const int turns = 2 * kDegree + 2;
  for (const auto& [z, weight] : gaussLegendre(kDegree + 1)) {
    const double r = std::sqrt(1 - z * z);
    for (int k = 0; k < turns; ++k) {
      const double phi = 2 * std::numbers::pi * k / turns;
      const Eigen::VectorXd y = harmonics.evaluate({r * std::cos(phi), r * std::sin(phi), z});
      gram.selfadjointView<Eigen::Lower>().rankUpdate(y, weight * 2 * std::numbers::pi / turns);
    }
  }
  const Eigen::MatrixXd whole = gram.selfadjointView<Eigen::Lower>();
  const double error =
      (whole - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff();
  // Rounding of 33 steps of the recurrence and of 2178 terms.
  EXPECT_LT(error, 1e-12);
}

TEST(SphericalHarmonics, ObeyTheAdditionTheoremEverywhere) {
  const SphericalHarmonics harmonics(kDegree);
  const Eigen::Vector3d north(0, 0, 1);
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Eigen::Vector3d p = seed == 0 ? north : Eigen::Vector3d(surfaces::rotation(seed).col(0));
    const Eigen::Vector3d q = seed == 1 ? north : Eigen::Vector3d(surfaces::rotation(seed).col(1));
    const Eigen::VectorXd a = harmonics.evaluate(p);
    const Eigen::VectorXd b = harmonics.evaluate((p + 0.5 * q).normalized());
    const double cosine = p.dot((p + 0.5 * q).normalized());
    for (int l = 0; l <= kDegree; ++l) {
      const double sum = a.segment(l * l, 2 * l + 1).dot(b.segment(l * l, 2 * l + 1));
      const double exact = (2 * l + 1) / (4 * std::numbers::pi) * std::legendre(l, cosine);
      EXPECT_NEAR(sum, exact, 1e-12) << l;
    }
  }
}

TEST(SphericalHarmonics, StartWithTheCoordinates) {
  const SphericalHarmonics harmonics(1);
  const Eigen::Vector3d p = surfaces::rotation(2).col(0);
  const Eigen::VectorXd y = harmonics.evaluate(p);
  const double unit = std::sqrt(3 / (4 * std::numbers::pi));
  EXPECT_NEAR(y[SphericalHarmonics::index(0, 0)], 1 / std::sqrt(4 * std::numbers::pi), 1e-15);
  EXPECT_NEAR(y[SphericalHarmonics::index(1, -1)], unit * p.y(), 1e-15);
  EXPECT_NEAR(y[SphericalHarmonics::index(1, 0)], unit * p.z(), 1e-15);
  EXPECT_NEAR(y[SphericalHarmonics::index(1, 1)], unit * p.x(), 1e-15);
}

}  // namespace
}  // namespace moduli
