#include "core/signature/soft_bins.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace moduli {
namespace {

TEST(QuantileMeans, OfEqualWeightsAreMeansOfSortedGroups) {
  const std::vector<double> means = quantileMeans({5, 1, 4, 2, 3, 6}, {1, 1, 1, 1, 1, 1}, 3);
  EXPECT_DOUBLE_EQ(means[0], 1.5);
  EXPECT_DOUBLE_EQ(means[1], 3.5);
  EXPECT_DOUBLE_EQ(means[2], 5.5);
}

TEST(QuantileMeans, ShareAValueAmongTheParts) {
  // 1 on the first 3/4, 5 on the rest: halves have means 1 and 3.
  const std::vector<double> means = quantileMeans({5, 1}, {1, 3}, 2);
  EXPECT_DOUBLE_EQ(means[0], 1);
  EXPECT_DOUBLE_EQ(means[1], 3);
  const std::vector<double> constant = quantileMeans({7}, {0.1}, 16);
  for (const double mean : constant) EXPECT_NEAR(mean, 7, 1e-13);
}

TEST(QuantileMeans, MoveNoMoreThanTheValues) {
  // Wasserstein: root mean square of the change bounds that of the means, also where values pass
  // each other and weights are uneven.
  std::vector<double> values, weights, moved;
  for (int i = 0; i < 200; ++i) {
    values.push_back(std::sin(7.0 * i));
    weights.push_back(1.5 + std::sin(3.0 * i));
    moved.push_back(values.back() + 0.01 * std::cos(11.0 * i));
  }
  const std::vector<double> before = quantileMeans(values, weights, 8);
  const std::vector<double> after = quantileMeans(moved, weights, 8);
  double change = 0, allowed = 0;
  for (int i = 0; i < 8; ++i) change += (before[i] - after[i]) * (before[i] - after[i]) / 8;
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (int i = 0; i < 200; ++i) {
    allowed += weights[i] / total * (values[i] - moved[i]) * (values[i] - moved[i]);
  }
  EXPECT_LE(change, allowed);
  EXPECT_GT(change, 0);
}

TEST(QuantileMeans, WithTailsHaveTheSameMean) {
  std::vector<double> values(64);
  std::iota(values.begin(), values.end(), 0.0);
  const std::vector<double> means = tailedQuantileMeans(values, std::vector<double>(64, 1.0));
  ASSERT_EQ(means.size(), std::size_t{kTailedParts});
  EXPECT_DOUBLE_EQ(means[0], 3.5);
  EXPECT_DOUBLE_EQ(means[2], 23.5);
  EXPECT_DOUBLE_EQ((means[0] + means[1] + 2 * means[2] + 2 * means[3] + means[4] + means[5]) / 8,
                   31.5);
}

TEST(SoftHistogram, SharesBetweenTheNearestNodes) {
  SoftHistogram histogram(10, 11);
  histogram.add(2.25, 4);
  histogram.add(12, 2);
  histogram.add(-1, 2);
  const std::vector<double> shares = histogram.shares();
  EXPECT_DOUBLE_EQ(shares[2], 3.0 / 8);
  EXPECT_DOUBLE_EQ(shares[3], 1.0 / 8);
  EXPECT_DOUBLE_EQ(shares[10], 0.25);
  EXPECT_DOUBLE_EQ(shares[0], 0.25);
  EXPECT_DOUBLE_EQ(std::accumulate(shares.begin(), shares.end(), 0.0), 1);
}

TEST(SoftHistogram, KeepsTheMeanOfItsValues) {
  SoftHistogram histogram(3, 17);
  double sum = 0;
  for (int i = 0; i < 50; ++i) {
    const double value = 1.5 + std::sin(5.0 * i);
    histogram.add(value, 1);
    sum += value / 50;
  }
  const std::vector<double> means = histogram.quantileMeans(4);
  EXPECT_NEAR(std::accumulate(means.begin(), means.end(), 0.0) / 4, sum, 1e-14);
}

}  // namespace
}  // namespace moduli
