#include "core/signature/farthest_sample.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "tests/core/spherical/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

/// Chosen points as coordinates, sorted, to compare choices that renumbering permutes.
std::vector<double> distancesOf(const Eigen::MatrixXd& points,
                                const std::vector<Eigen::Index>& chosen) {
  std::vector<double> distances;
  for (const Eigen::Index a : chosen) {
    for (const Eigen::Index b : chosen) {
      distances.push_back((points.col(a) - points.col(b)).norm());
    }
  }
  std::sort(distances.begin(), distances.end());
  return distances;
}

Eigen::MatrixXd cloud(int count) {
  Eigen::MatrixXd points(3, count);
  for (int i = 0; i < count; ++i) {
    points.col(i) =
        Eigen::Vector3d(std::sin(3.1 * i), 2 * std::sin(5.3 * i + 1), std::cos(7.7 * i));
  }
  return points;
}

TEST(FarthestSample, OfALineHalvesTheLargestGap) {
  Eigen::MatrixXd points(1, 9);
  for (int i = 0; i < 9; ++i) points(0, i) = i - 3.0;  // -3 .. 5
  Context context;
  const std::vector<double> weights(9, 1.0);
  const auto chosen = farthestSample(context, points, weights, 3);
  ASSERT_OK(chosen);
  EXPECT_EQ(*chosen, (std::vector<Eigen::Index>{8, 0, 4}));
  // 5, 4 and half of 3; -3, -2 and half of -1; the rest.
  const auto shares = nearestWeights(context, points, weights, *chosen);
  ASSERT_OK(shares);
  EXPECT_EQ(*shares, (std::vector<double>{2.5, 2.5, 4}));
}

TEST(FarthestSample, DoesNotDependOnOrderOrPlace) {
  Context context;
  const Eigen::MatrixXd points = cloud(500);
  Eigen::MatrixXd turned(3, 500);
  const Eigen::Matrix3d turn = surfaces::rotation(4);
  for (Eigen::Index i = 0; i < 500; ++i) turned.col(i) = turn * points.col((i * 7 + 3) % 500);
  const std::vector<double> weights(500, 0.002);
  const auto one = farthestSample(context, points, weights, 60);
  const auto two = farthestSample(context, turned, weights, 60);
  ASSERT_OK(one);
  ASSERT_OK(two);
  const auto first = nearestWeights(context, points, weights, *one);
  const auto second = nearestWeights(context, turned, weights, *two);
  ASSERT_OK(first);
  ASSERT_OK(second);
  for (int k = 0; k < 60; ++k) {
    EXPECT_EQ(((*two)[k] * 7 + 3) % 500, (*one)[k]);
    EXPECT_NEAR((*first)[k], (*second)[k], 1e-15);
  }
  EXPECT_NEAR(std::accumulate(first->begin(), first->end(), 0.0), 1, 1e-12);
}

TEST(FarthestSample, OfASymmetricCloudIsTheSameUpToSymmetry) {
  // A grid on a cube: ties all the way.
  Eigen::MatrixXd points(3, 0);
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j < 7; ++j) {
      for (int side = 0; side < 6; ++side) {
        Eigen::Vector3d p;
        p[side / 2] = side % 2 == 0 ? -3 : 3;
        p[(side / 2 + 1) % 3] = i - 3;
        p[(side / 2 + 2) % 3] = j - 3;
        points.conservativeResize(3, points.cols() + 1);
        points.col(points.cols() - 1) = p;
      }
    }
  }
  const Eigen::Index n = points.cols();
  Context context;
  const std::vector<double> weights(n, 1.0);
  const auto one = farthestSample(context, points, weights, 14);
  ASSERT_OK(one);
  for (const unsigned seed : {1U, 2U, 3U}) {
    Eigen::MatrixXd turned(3, n);
    const Eigen::Matrix3d turn = surfaces::rotation(seed);
    for (Eigen::Index i = 0; i < n; ++i) turned.col(i) = turn * points.col((i * 11 + seed) % n);
    const auto two = farthestSample(context, turned, weights, 14);
    ASSERT_OK(two);
    const auto a = distancesOf(points, *one), b = distancesOf(turned, *two);
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-12) << seed;
  }
}

TEST(FarthestSample, TakesNoCopiesAndNotMoreThanThereAre) {
  Context context;
  Eigen::MatrixXd points(2, 4);
  points << 1, 1, 0, 0, 0, 0, 2, 2;
  const auto chosen = farthestSample(context, points, {1, 2, 3, 4}, 10);
  ASSERT_OK(chosen);
  ASSERT_EQ(chosen->size(), 2U);
  const auto shares = nearestWeights(context, points, {1, 2, 3, 4}, *chosen);
  ASSERT_OK(shares);
  EXPECT_EQ(*shares, (std::vector<double>{7, 3}));
}

TEST(FarthestSample, StopsWhenCancelled) {
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(farthestSample(context, cloud(10), std::vector<double>(10, 1.0), 5),
              FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
