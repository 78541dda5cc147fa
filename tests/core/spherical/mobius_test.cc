#include "core/spherical/mobius.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

/// Two hundred points crowded towards one side, with uneven weights.
struct Skewed {
  Points3 points;
  std::vector<double> weights;
};

Skewed skewedPoints(double crowding, int count = 200, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.2, 1);
  Skewed result;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d p(normal(random), normal(random), normal(random));
    p = p.normalized() + crowding * Eigen::Vector3d(0.6, 0.5, -0.4);
    result.points.push_back(p.normalized());
    result.weights.push_back(uniform(random));
  }
  return result;
}

Eigen::Vector3d mean(const Points3& points, const std::vector<double>& weights) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum += weights[i] * points[i];
    total += weights[i];
  }
  return sum / total;
}

Points3 centered(const Points3& points, const std::vector<double>& weights) {
  Context context;
  auto result = centerByMobius(context, points, weights);
  EXPECT_OK(result);
  return result->points;
}

TEST(BallTranslate, CarriesItsCentreToTheOriginAndKeepsTheSphere) {
  const Eigen::Vector3d center(0.3, -0.5, 0.6);
  EXPECT_LT(ballTranslate(center, center).norm(), 1e-15);
  EXPECT_LT((ballTranslate(center, Eigen::Vector3d::Zero()) + center).norm(), 1e-15);
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Eigen::Vector3d p = surfaces::rotation(seed).col(0);
    EXPECT_NEAR(ballTranslate(center, p).norm(), 1, 1e-14);
    // T_{-c} undoes T_c. 1e-14: the map stretches by up to (1 + |c|) / (1 - |c|) = 10.
    EXPECT_LT((ballTranslate(-center, ballTranslate(center, p)) - p).norm(), 1e-14);
  }
}

TEST(CenterByMobius, ReachesTheCentreToRoundingInTenSteps) {
  const Skewed skewed = skewedPoints(0.8);
  ASSERT_GT(mean(skewed.points, skewed.weights).norm(), 0.4);
  Context context;
  const auto result = centerByMobius(context, skewed.points, skewed.weights);
  ASSERT_OK(result);
  EXPECT_LE(result->iterations, 10);
  EXPECT_LT(mean(result->points, skewed.weights).norm(), 1e-14);
  EXPECT_LT(result->residual, 1e-14);
  for (const Eigen::Vector3d& p : result->points) EXPECT_NEAR(p.norm(), 1, 4e-16);
}

TEST(CenterByMobius, IsIdempotent) {
  const Skewed skewed = skewedPoints(0.8);
  const Points3 once = centered(skewed.points, skewed.weights);
  const Points3 twice = centered(once, skewed.weights);
  for (std::size_t i = 0; i < once.size(); ++i) EXPECT_LT((once[i] - twice[i]).norm(), 1e-14);
}

TEST(CenterByMobius, CommutesWithRotations) {
  const Skewed skewed = skewedPoints(0.8);
  const Eigen::Matrix3d turn = surfaces::rotation(3);
  Points3 turned = skewed.points;
  for (Eigen::Vector3d& p : turned) p = turn * p;
  const Points3 a = centered(skewed.points, skewed.weights);
  const Points3 b = centered(turned, skewed.weights);
  // 1e-13: rounding of the points (1e-16) stretched by the map (below 100) a few times.
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT((turn * a[i] - b[i]).norm(), 1e-13);
}

TEST(CenterByMobius, ForgetsAMobiusMapUpToARotation) {
  const Skewed skewed = skewedPoints(0.3);
  Points3 squeezed = skewed.points;
  for (Eigen::Vector3d& p : squeezed) {
    p = ballTranslate({-0.5, 0.6, 0.3}, surfaces::rotation(7) * p).normalized();
  }
  const double left = surfaces::distanceUpToRotation(
      centered(squeezed, skewed.weights), centered(skewed.points, skewed.weights), skewed.weights);
  EXPECT_LT(left, 1e-14);
}

TEST(CenterByMobius, ConvergesFromExtremeCrowding) {
  // Squeezed by a map that leaves almost all points within 1e-8 of one: the potential is still
  // strictly convex. What comes back is limited by the rounding of the squeezed points, 1e-16 /
  // 1e-8.
  const Skewed skewed = skewedPoints(0.3);
  Points3 squeezed = skewed.points;
  const Eigen::Vector3d direction = Eigen::Vector3d(1, 2, -2) / 3;
  for (int i = 0; i < 4; ++i) {
    for (Eigen::Vector3d& p : squeezed) p = ballTranslate(-0.98 * direction, p).normalized();
  }
  const double left = surfaces::distanceUpToRotation(
      centered(squeezed, skewed.weights), centered(skewed.points, skewed.weights), skewed.weights);
  EXPECT_LT(left, 1e-6);
}

TEST(CenterByMobius, IgnoresPointsWithoutWeight) {
  Skewed skewed = skewedPoints(0.8);
  const Points3 without = centered(skewed.points, skewed.weights);
  skewed.points.push_back(Eigen::Vector3d::UnitZ());
  skewed.weights.push_back(0);
  const Points3 with = centered(skewed.points, skewed.weights);
  for (std::size_t i = 0; i < without.size(); ++i) EXPECT_EQ(with[i], without[i]);
}

TEST(CenterByMobius, RefusesWhatHasNoCentre) {
  Context context;
  const Points3 points = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_THAT(centerByMobius(context, points, {1, 1}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(centerByMobius(context, points, {0, 0, 0}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(centerByMobius(context, points, {-1, 2, 2}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(centerByMobius(context, points, {1, 1, 2}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(centerByMobius(context, {{1, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {1, 1, 1}),
              FailsWith(Reason::kNoConvergence));
}

}  // namespace
}  // namespace moduli
