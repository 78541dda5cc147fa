#include "core/parameterize/packing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <utility>

#include "core/parameterize/flat.h"
#include "core/parameterize/overlaps.h"
#include "tests/core/parameterize/plane_targets.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// How far apart two rectangles are, along the axis that keeps them apart.
double distance(Complex a, Complex size_a, Complex b, Complex size_b) {
  const Complex ab = b - (a + size_a), ba = a - (b + size_b);
  return std::max({ab.real(), ab.imag(), ba.real(), ba.imag()});
}

/// The side of the square from 0 that holds all.
double sideOf(const std::vector<Complex>& corners, const std::vector<Complex>& sizes) {
  double side = 0;
  for (std::size_t n = 0; n < sizes.size(); ++n) {
    side = std::max({side, (corners[n] + sizes[n]).real(), (corners[n] + sizes[n]).imag()});
  }
  return side;
}

std::vector<Complex> someRectangles(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Complex> sizes;
  while (sizes.size() < count) {
    sizes.emplace_back(0.05 + uniform(random), 0.05 + uniform(random));
  }
  return sizes;
}

TEST(PackRectangles, LiesApartAndInTheBox) {
  for (const std::size_t count : {1, 2, 3, 7, 40, 300}) {
    for (const double gap : {0.0, 0.01, 0.3}) {
      const auto sizes = someRectangles(count, static_cast<unsigned>(count));
      const auto corners = packRectangles(sizes, gap);
      ASSERT_EQ(corners.size(), count);
      for (std::size_t a = 0; a < count; ++a) {
        EXPECT_GE(corners[a].real(), 0);
        EXPECT_GE(corners[a].imag(), 0);
        for (std::size_t b = 0; b < a; ++b) {
          EXPECT_GE(distance(corners[a], sizes[a], corners[b], sizes[b]), gap - 1e-12);
        }
      }
    }
  }
}

TEST(PackRectangles, OfSquaresThatMakeASquareIsThatSquare) {
  const std::vector<Complex> sizes(16, Complex(1, 1));
  EXPECT_NEAR(sideOf(packRectangles(sizes, 0), sizes), 4, 1e-12);
}

TEST(PackRectangles, FillsMostOfTheSquare) {
  // Many rectangles of all sizes: their own unevenness, not the box, is what is left.
  for (unsigned seed = 1; seed < 6; ++seed) {
    const auto sizes = someRectangles(200, seed);
    double area = 0;
    for (const Complex& size : sizes) area += size.real() * size.imag();
    const double side = sideOf(packRectangles(sizes, 0), sizes);
    EXPECT_GT(area / (side * side), 0.8);
  }
}

TEST(PackRectangles, OfNothingAndOfPointsIsSound) {
  EXPECT_TRUE(packRectangles({}, 1).empty());
  const auto corners = packRectangles({Complex(0, 0), Complex(0, 0)}, 0);
  EXPECT_EQ(corners.size(), 2U);
}

TEST(PackIslands, KeepsShapesAndCutsNoMoreThanBetweenIslands) {
  // A plate in two halves.
  const MetricSurface metric = plate(6, 4, {});
  Context context;
  const auto flat = parameterizeFlat(context, metric.surface, metric.lengths, {});
  ASSERT_OK(flat);
  std::vector<Complex> points = flat->points;
  std::vector<Index> corner = flat->corner, island;
  for (Index f = 0; f < metric.surface.faceCount(); ++f) {
    island.push_back(f < metric.surface.faceCount() / 2 ? 0 : 1);
  }
  packIslands(metric.surface, island, 0.05, points, corner);
  EXPECT_EQ(islandsOf(metric.surface, corner), island);
  EXPECT_EQ(countOverlaps(points, corner), 0);
  for (Index h = 0; h < metric.surface.halfedgeCount(); ++h) {
    const Index next = Connectivity::next(h);
    const Complex before = flat->points[flat->corner[next]] - flat->points[flat->corner[h]];
    EXPECT_LE(std::abs(points[corner[next]] - points[corner[h]] - before), 1e-13);
  }
  // Apart by a twentieth of the root of 24.
  std::array<Eigen::AlignedBox2d, 2> boxes;
  for (Index h = 0; h < metric.surface.halfedgeCount(); ++h) {
    const Complex p = points[corner[h]];
    boxes[island[Connectivity::faceOf(h)]].extend(Eigen::Vector2d(p.real(), p.imag()));
  }
  const auto low = [&](int n) { return Complex(boxes[n].min().x(), boxes[n].min().y()); };
  const auto size = [&](int n) { return Complex(boxes[n].sizes().x(), boxes[n].sizes().y()); };
  EXPECT_NEAR(distance(low(0), size(0), low(1), size(1)), 0.05 * std::sqrt(24), 1e-12);
  // By multiples of a grid, all parts of an island by the same one.
  std::vector<Complex> on_grid = flat->points;
  std::vector<Index> grid_corner = flat->corner;
  packIslands(metric.surface, island, 0.05, on_grid, grid_corner, 0.5);
  EXPECT_EQ(countOverlaps(on_grid, grid_corner), 0);
  std::array<std::set<std::pair<double, double>>, 2> shifts;
  for (Index h = 0; h < metric.surface.halfedgeCount(); ++h) {
    const Complex steps = (on_grid[grid_corner[h]] - flat->points[flat->corner[h]]) / 0.5;
    EXPECT_NEAR(steps.real(), std::round(steps.real()), 1e-12);
    EXPECT_NEAR(steps.imag(), std::round(steps.imag()), 1e-12);
    shifts[island[Connectivity::faceOf(h)]].insert(
        {std::round(steps.real()), std::round(steps.imag())});
  }
  EXPECT_EQ(shifts[0].size(), 1U);
  EXPECT_EQ(shifts[1].size(), 1U);
  EXPECT_NE(shifts[0], shifts[1]);
}

}  // namespace
}  // namespace moduli
