#include "core/linalg/dense_eigen.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace moduli {
namespace {

/// 2 on the diagonal, -1 beside it: the second difference.
Eigen::MatrixXd secondDifference(Eigen::Index n) {
  Eigen::MatrixXd matrix = 2 * Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index i = 1; i < n; ++i) matrix(i, i - 1) = -1;
  return matrix;
}

TEST(DenseEigen, OfSecondDifferencesAreSines) {
  const Eigen::Index n = 150;
  const auto pairs = denseEigenpairs(secondDifference(n));
  ASSERT_TRUE(pairs.ok()) << pairs.status().toString();
  for (Eigen::Index k = 0; k < n; ++k) {
    const double angle = static_cast<double>(k + 1) * std::numbers::pi / static_cast<double>(n + 1);
    // The algorithm is backward stable: some n units in the last place of the norm, 4.
    EXPECT_NEAR(pairs->values[k], 2 - 2 * std::cos(angle), 4 * 150 * 0x1p-52);
    Eigen::VectorXd sine(n);
    for (Eigen::Index i = 0; i < n; ++i) sine[i] = std::sin(angle * static_cast<double>(i + 1));
    // The gap between values is at least 3 (pi / 151)^2 = 1.3e-3.
    EXPECT_NEAR(std::abs(sine.normalized().dot(pairs->vectors.col(k))), 1, 1e-9);
  }
}

TEST(DenseEigen, ReadsTheLowerTriangleAndLeavesMultipletsOrthonormal) {
  // A reflection: -1 once, 1 for the rest.
  const Eigen::Index n = 60;
  const Eigen::VectorXd axis = Eigen::VectorXd::LinSpaced(n, 1, 2).normalized();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(n, n) - 2 * axis * axis.transpose();
  matrix.triangularView<Eigen::StrictlyUpper>().setConstant(7);
  const auto pairs = denseEigenpairs(matrix);
  ASSERT_TRUE(pairs.ok()) << pairs.status().toString();
  EXPECT_NEAR(pairs->values[0], -1, 60 * 0x1p-52);
  EXPECT_NEAR(std::abs(pairs->vectors.col(0).dot(axis)), 1, 60 * 0x1p-52);
  EXPECT_NEAR(pairs->values[1], 1, 60 * 0x1p-52);
  EXPECT_NEAR(pairs->values[n - 1], 1, 60 * 0x1p-52);
  const Eigen::MatrixXd unit = pairs->vectors.transpose() * pairs->vectors;
  EXPECT_LT((unit - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(), 60 * 0x1p-52);
}

TEST(DenseEigen, TakesEmptyMatricesAndSingleNumbers) {
  EXPECT_EQ(denseEigenpairs(Eigen::MatrixXd(0, 0))->values.size(), 0);
  const auto pairs = denseEigenpairs(Eigen::MatrixXd::Constant(1, 1, -3));
  ASSERT_TRUE(pairs.ok());
  EXPECT_EQ(pairs->values[0], -3);
  EXPECT_EQ(std::abs(pairs->vectors(0, 0)), 1);
}

TEST(DenseEigen, RefusesWhatIsNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Eigen::MatrixXd matrix = secondDifference(30);
    matrix(20, 3) = bad;
    EXPECT_EQ(denseEigenpairs(matrix).status().reason(), Reason::kNoConvergence);
  }
}

}  // namespace
}  // namespace moduli
