#include "core/optimize/tangent_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "core/optimize/normal_deviates.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Eigen::MatrixXd randomSymmetric(Eigen::Index n, std::uint64_t seed) {
  const Eigen::MatrixXd a = NormalDeviates(seed).matrix(n, n);
  return a + a.transpose();
}

TEST(TangentInverse, InvertsTheHessianOnTheTangentSpaceAndNothingElse) {
  // P g = 0, and P H w = w modulo g for tangent w: exactly what P is. Random indefinite Hessians.
  for (const Eigen::Index n : {2, 3, 8, 25}) {
    const Eigen::MatrixXd H = randomSymmetric(n, 3);
    const Eigen::VectorXd g = 1e3 * NormalDeviates(4).vector(n);
    const Eigen::MatrixXd U = tangentBasis(g);
    for (const auto& by : {tangentInverseBordered, tangentInverseByBasis}) {
      const auto tangent = by(H, g);
      ASSERT_OK(tangent);
      const double size = tangent->P.norm();
      EXPECT_LE((tangent->P * g.normalized()).norm(), 1e-13 * size) << n;
      const Eigen::MatrixXd back = U.transpose() * tangent->P * H * U;
      EXPECT_LE((back - Eigen::MatrixXd::Identity(n - 1, n - 1)).norm(), 1e-12 * size * H.norm());
      const double determinant = (U.transpose() * H * U).determinant();
      EXPECT_NEAR(tangent->log_determinant, std::log(std::abs(determinant)), 1e-11);
    }
  }
}

TEST(TangentInverse, KnowsWhetherTheLevelSetIsConvexThere) {
  // diag(1, 2, -1): convex where the gradient is along the last axis, not along the first.
  const Eigen::MatrixXd H = Eigen::Vector3d(1, 2, -1).asDiagonal();
  for (const auto& by : {tangentInverseBordered, tangentInverseByBasis}) {
    EXPECT_TRUE(by(H, Eigen::Vector3d(0.1, 0, 1))->positive);
    EXPECT_FALSE(by(H, Eigen::Vector3d(1, 0, 0.1))->positive);
    EXPECT_FALSE(by(-H, Eigen::Vector3d(0, 0, 1))->positive);
  }
}

TEST(TangentInverse, ScalesWithTheInverseOfTheHessianAndNotWithTheGradient) {
  const Eigen::MatrixXd H = randomSymmetric(5, 7);
  const Eigen::VectorXd g = NormalDeviates(8).vector(5);
  for (const auto& by : {tangentInverseBordered, tangentInverseByBasis}) {
    const Eigen::MatrixXd P = by(H, g)->P;
    for (const double scale : {1e-100, 1e-8, 1e8, 1e100}) {
      EXPECT_LE((scale * by(scale * H, g)->P - P).norm(), 1e-12 * P.norm()) << scale;
      EXPECT_LE((by(H, scale * g)->P - P).norm(), 1e-12 * P.norm()) << scale;
    }
  }
}

TEST(TangentInverse, RefusesFlatLevelSets) {
  const Eigen::MatrixXd H = Eigen::Vector3d(0, 1, 1).asDiagonal();
  for (const auto& by : {tangentInverseBordered, tangentInverseByBasis}) {
    EXPECT_OK(by(H, Eigen::Vector3d(1, 0, 0)));  // Singular, but not on the tangent space.
    EXPECT_THAT(by(H, Eigen::Vector3d(0, 1, 0)), FailsWith(Reason::kNotPositiveDefinite));
    EXPECT_THAT(by(0 * H, Eigen::Vector3d(0, 1, 0)), FailsWith(Reason::kNotPositiveDefinite));
    EXPECT_OK(by(Eigen::MatrixXd::Zero(1, 1), Eigen::VectorXd::Ones(1)));  // No tangent space.
  }
}

TEST(TangentInverse, BasisIsOrthonormalWhereverTheGradientPoints) {
  for (const Eigen::Vector3d& g : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0),
                                   Eigen::Vector3d(0, 0, -2), Eigen::Vector3d(-1e-9, 1, 3)}) {
    const Eigen::MatrixXd U = tangentBasis(g);
    EXPECT_LE((U.transpose() * U - Eigen::Matrix2d::Identity()).norm(), 1e-15);
    EXPECT_LE((U.transpose() * g.normalized()).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace moduli
