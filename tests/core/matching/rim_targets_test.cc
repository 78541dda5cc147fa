#include "core/matching/rim_targets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace moduli {
namespace {

std::vector<double> shares(std::size_t count) {
  std::vector<double> result;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(count);
    result.push_back(t + 0.05 * std::sin(2 * std::numbers::pi * t) *
                             std::sin(2 * std::numbers::pi * t));  // Uneven.
  }
  return result;
}

/// A map that goes round once: turned, and faster here than there.
double truth(double t) {
  const double value = t + 0.37 + 0.1 * std::sin(2 * std::numbers::pi * t);
  return value - std::floor(value);
}

double apart(double a, double b) {
  return std::abs(a - b - std::round(a - b));
}

/// Steps forward, in turns, all together; infinite where one goes back.
double turns(const std::vector<double>& values) {
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    double step = values[(i + 1) % values.size()] - values[i];
    if (step < -1e-12) step += 1;
    sum += step;
  }
  return sum;
}

TEST(OrderedAroundCircle, LeavesWhatIsInOrder) {
  const std::vector<double> from = shares(100);
  std::vector<double> to;
  for (const double t : from) to.push_back(truth(t));
  const std::vector<double> ordered = orderedAroundCircle(from, to);
  for (std::size_t i = 0; i < from.size(); ++i) EXPECT_LT(apart(ordered[i], to[i]), 1e-14);
}

TEST(OrderedAroundCircle, DoesNotMindASixthOfNonsense) {
  const std::vector<double> from = shares(300);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform;
  std::vector<double> to;
  for (std::size_t i = 0; i < from.size(); ++i) {
    to.push_back(i % 6 == 3 ? uniform(random) : truth(from[i]));
  }
  const std::vector<double> ordered = orderedAroundCircle(from, to);
  double largest = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    largest = std::max(largest, apart(ordered[i], truth(from[i])));
  }
  // Between its neighbours: some 1.6 / 300 apart each.
  EXPECT_LT(largest, 0.02);
  EXPECT_NEAR(turns(ordered), 1, 1e-12);
}

TEST(OrderedAroundCircle, GoesRoundOnceWhateverIsGiven) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform;
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<double> from = shares(40);
    std::vector<double> to;
    for (std::size_t i = 0; i < from.size(); ++i) to.push_back(uniform(random));
    const std::vector<double> ordered = orderedAroundCircle(from, to);
    // All at one value is a step of none.
    const double sum = turns(ordered);
    EXPECT_LT(std::min(std::abs(sum), std::abs(sum - 1)), 1e-12);
    for (const double value : ordered) {
      EXPECT_GE(value, 0);
      EXPECT_LT(value, 1);
    }
  }
}

TEST(OrderedAroundCircle, FindsNothingInNothing) {
  EXPECT_TRUE(orderedAroundCircle({}, {}).empty());
  EXPECT_EQ(orderedAroundCircle({0.2}, {0.7}).size(), 1U);
}

}  // namespace
}  // namespace moduli
