#include "core/matching/space_mobius.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/mesh/sample_tools.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

Vector3d randomPoint(SampleRandom& random) {
  return {random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5};
}

std::vector<Vector3d> cloud(int count, unsigned seed) {
  SampleRandom random(seed);
  std::vector<Vector3d> points;
  for (int i = 0; i < count; ++i) points.push_back(randomPoint(random));
  return points;
}

TEST(SpaceMobius, MapsAsItsNamesSay) {
  const Vector3d x(0.3, -1.2, 2);
  // Lifts are as long as 5, and their rounding 1e-15; a few of that.
  EXPECT_LT((SpaceMobius()(x) - x).norm(), 1e-13);
  EXPECT_LT((SpaceMobius::translation({1, 2, 3})(x) - Vector3d(1.3, 0.8, 5)).norm(), 1e-13);
  EXPECT_LT((SpaceMobius::scaling(3)(x) - 3 * x).norm(), 1e-13);
  EXPECT_LT((SpaceMobius::inversion()(x) - x / x.squaredNorm()).norm(), 1e-13);
  const Eigen::Matrix3d mirror = Vector3d(-1, 1, 1).asDiagonal();
  EXPECT_LT((SpaceMobius::orthogonal(mirror)(x) - Vector3d(-0.3, -1.2, 2)).norm(), 1e-13);
}

TEST(SpaceMobius, ProductsApplyTheRightFactorFirst) {
  const Vector3d x(0.3, -1.2, 2);
  const SpaceMobius a = SpaceMobius::translation({1, 0, 0}), b = SpaceMobius::scaling(2);
  EXPECT_LT(((a * b)(x)-a(b(x))).norm(), 1e-13);
}

TEST(SpaceMobius, KeepsCrossRatiosOfDistances) {
  const SpaceMobius map = SpaceMobius::scaling(0.7) * SpaceMobius::inversion() *
                          SpaceMobius::translation({0.9, 0.2, -1});
  const auto p = cloud(4, 3);
  const auto ratio = [](const Vector3d& a, const Vector3d& b, const Vector3d& c,
                        const Vector3d& d) {
    return (a - b).norm() * (c - d).norm() / ((a - c).norm() * (b - d).norm());
  };
  EXPECT_NEAR(ratio(map(p[0]), map(p[1]), map(p[2]), map(p[3])), ratio(p[0], p[1], p[2], p[3]),
              1e-13);
}

/// An inversion in a sphere whose centre stands off the cloud, then moved and mirrored.
SpaceMobius sample() {
  return SpaceMobius::translation({5, -3, 2}) * SpaceMobius::scaling(7) *
         SpaceMobius::orthogonal(
             Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()).toRotationMatrix()) *
         SpaceMobius::orthogonal(Vector3d(-1, 1, 1).asDiagonal()) * SpaceMobius::inversion() *
         SpaceMobius::translation({0.9, 0.4, -0.8});
}

TEST(FitSpaceMobius, FindsAnExactOneToRounding) {
  const auto points = cloud(60, 1);
  std::vector<Vector3d> targets;
  for (const Vector3d& p : points) targets.push_back(sample()(p));
  const auto fit = fitSpaceMobius(points, targets);
  ASSERT_TRUE(fit.ok());
  // Some ten matrices, of a condition of some hundred.
  for (const Vector3d& p : cloud(20, 2)) EXPECT_LT((fit->map(p) - sample()(p)).norm(), 1e-9);
  EXPECT_LT(fit->median, 1e-9);
}

TEST(FitSpaceMobius, FindsASimilarity) {
  const SpaceMobius truth = SpaceMobius::translation({5, -3, 2}) * SpaceMobius::scaling(7);
  const auto points = cloud(60, 1);
  std::vector<Vector3d> targets;
  for (const Vector3d& p : points) targets.push_back(truth(p));
  const auto fit = fitSpaceMobius(points, targets);
  ASSERT_TRUE(fit.ok());
  for (const Vector3d& p : cloud(20, 2)) EXPECT_LT((fit->map(p) - truth(p)).norm(), 1e-9);
}

/// One target in ten goes anywhere; of the others the mean error of 10 parameters from 180 targets
/// is sqrt(10 / (3 * 180)) = 0.14 of their own, inside the cloud; thrice that.
TEST(FitSpaceMobius, EvensOutErrorsAndIgnoresOutliers) {
  const auto points = cloud(200, 1);
  SampleRandom random(5);
  std::vector<Vector3d> targets;
  const double error = 0.05;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d noise = 2 * error * randomPoint(random);
    targets.push_back(sample()(points[i]) + noise);
    if (i % 10 == 0) targets.back() = Vector3d(5, -3, 2) + 10 * randomPoint(random);
  }
  const auto fit = fitSpaceMobius(points, targets);
  ASSERT_TRUE(fit.ok());
  double sum = 0;
  for (const Vector3d& p : points) sum += (fit->map(p) - sample()(p)).norm() / 200;
  RecordProperty("error", std::to_string(sum));
  EXPECT_LT(sum, 0.14 * 3 * error);
}

TEST(FitSpaceMobius, RefusesTooFewPoints) {
  EXPECT_EQ(fitSpaceMobius(cloud(7, 1), cloud(7, 2)).status().reason(), Reason::kInvalidOption);
  EXPECT_EQ(fitSpaceMobius(cloud(9, 1), cloud(8, 2)).status().reason(), Reason::kInvalidOption);
  const std::vector<Vector3d> same(9, Vector3d(1, 2, 3));
  EXPECT_EQ(fitSpaceMobius(same, cloud(9, 2)).status().reason(), Reason::kNoConvergence);
}

}  // namespace
}  // namespace moduli
