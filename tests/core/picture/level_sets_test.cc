#include "core/picture/level_sets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

template <typename Function>
GridValues gridOf(int columns, int rows, const Function& f) {
  GridValues grid{columns, rows, {}};
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) grid.values.push_back(f(i, j));
  }
  return grid;
}

double lengthOf(const Outline& line) {
  double length = 0;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    length += std::hypot(line[k + 1][0] - line[k][0], line[k + 1][1] - line[k][1]);
  }
  return length;
}

double doubledArea(const Outline& line) {
  double area = 0;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    area += line[k][0] * line[k + 1][1] - line[k + 1][0] * line[k][1];
  }
  return area;
}

TEST(LevelSets, OfALinearFunctionIsTheExactLineFromBorderToBorder) {
  const GridValues grid = gridOf(7, 5, [](int i, int j) { return i + 2 * j; });
  const auto lines = levelSet(grid, 3.5);
  ASSERT_EQ(lines.size(), 1U);
  for (const auto& point : lines[0]) EXPECT_NEAR(point[0] + 2 * point[1], 3.5, 1e-14);
  // From (3.5, 0) to (0, 1.75), the larger values on its left or right: always on the left.
  EXPECT_NEAR(lengthOf(lines[0]), std::hypot(3.5, 1.75), 1e-13);
  const auto& first = lines[0].front();
  const auto& last = lines[0].back();
  const double left = (last[0] - first[0]) * 2 - (last[1] - first[1]) * 1;
  EXPECT_GT(left, 0) << "the gradient (1, 2) points to the left of the line";
}

TEST(LevelSets, OfAConeIsACircleUpToTheSquareOfTheStep) {
  double before = 0;
  for (const int n : {20, 40, 80}) {
    const double middle = n / 2.0 + 0.13, radius = 0.37 * n;
    const auto lines = levelSet(
        gridOf(n + 1, n + 1, [&](int i, int j) { return std::hypot(i - middle, j - middle); }),
        radius);
    ASSERT_EQ(lines.size(), 1U);
    EXPECT_EQ(lines[0].front(), lines[0].back());
    // What is above lies outside, on the left of a clockwise circle.
    EXPECT_LT(doubledArea(lines[0]), 0);
    const double error = std::abs(-doubledArea(lines[0]) / (2 * kPi * radius * radius) - 1);
    if (before > 0) {
      // A quarter of it; the phase of the grid makes it vary.
      EXPECT_LT(error, before / 2.5);
    }
    before = error;
  }
  EXPECT_LT(before, 1e-3);
}

TEST(LevelSets, ASaddlesMeanTellsWhichCornersAreJoined) {
  // Values 1 at (0, 0) and (1, 1), `other` at the other corners.
  const auto lines = [](double other) {
    return levelSet(gridOf(2, 2, [&](int i, int j) { return i == j ? 1.0 : other; }), 0);
  };
  const auto joined = lines(-0.5);
  ASSERT_EQ(joined.size(), 2U);
  for (const Outline& line : joined) {
    // Each cuts one of the low corners off: both of its ends are near (1, 0), or near (0, 1).
    ASSERT_EQ(line.size(), 2U);
    EXPECT_EQ(line[0][0] > line[0][1], line[1][0] > line[1][1]);
  }
  for (const Outline& line : lines(-2)) {
    ASSERT_EQ(line.size(), 2U);
    EXPECT_EQ(line[0][0] + line[0][1] > 1, line[1][0] + line[1][1] > 1);
  }
}

TEST(LevelSets, SquaresWithoutValuesAreLeftOut) {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto lines =
      levelSet(gridOf(5, 5, [&](int i, int j) { return i < 2 ? infinity : j - 1.5; }), 0);
  ASSERT_EQ(lines.size(), 1U);
  for (const auto& point : lines[0]) {
    EXPECT_GE(point[0], 2);
    EXPECT_EQ(point[1], 1.5);
  }
  EXPECT_TRUE(levelSet(GridValues(), 0).empty());
  EXPECT_TRUE(levelSet(gridOf(3, 3, [](int, int) { return 1.0; }), 2).empty());
}

}  // namespace
}  // namespace moduli
