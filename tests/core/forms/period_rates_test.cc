// At what order periods and moduli converge under refinement, down to fine meshes.

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "core/forms/quadrilateral.h"
#include "core/forms/siegel.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/forms/period_testing.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Result<BoundedNumber> modulusOf(const MetricSurface& mesh, const std::array<Index, 4>& corners) {
  Context context;
  return quadrilateralModulus(context, mesh.surface, mesh.lengths, corners);
}

/// The last two ratios of successive errors, each for half the mesh width, have this order.
void expectOrder(const std::vector<double>& errors, double order) {
  for (std::size_t k = errors.size() - 2; k < errors.size(); ++k) {
    EXPECT_NEAR(std::log2(errors[k - 1] / errors[k]), order, 0.25) << k;
  }
}

/// det E_h - 1 of glued surfaces as published (CHECKS D1 to D6), each for half the mesh width of
/// the one before, and the order that the largest cone angle theta allows, min(2, 4 pi / theta).
struct ConeSurface {
  std::string name;
  MetricSurface base;
  double order;
  int first_parts;
  std::vector<double> gaps;
};

TEST(RawEnergy, ConvergesAtTheOrderOfItsCones) {
  const std::vector<ConeSurface> surfaces{
      {"square-tiled L", squareTiledL(), 2 / 3.0, 4, {.868, .483, .282, .169, .1035}},
      {"octahedron cover", octahedronCover(), 1.5, 4, {.1019, .03488, .01219, .004295, .001516}},
      {"octagon", gluedPolygon(8), 2 / 3.0, 4, {1.137, .603, .344, .205, .124}},
      {"hexagon cover", hexagonCover(), 1.5, 4, {.0787, .0271, .00951, .00335, .00118}},
      {"decagon", gluedPolygon(10), 1, 4, {.424, .189, .090, .044, .0218}},
      {"Klein quartic", kleinQuartic(), 12 / 7.0, 2, {.1853, .0540, .01625, .00493}},
  };
  for (const ConeSurface& each : surfaces) {
    std::vector<double> gaps;
    for (std::size_t k = 0; k < each.gaps.size(); ++k) {
      const auto closed = closedPeriodsOf(subdivide(each.base, each.first_parts << k));
      ASSERT_OK(closed);
      gaps.push_back(closed->energy.determinant() - 1);
      // Published to three or four digits.
      EXPECT_NEAR(gaps[k] / each.gaps[k], 1, 1e-2) << each.name << k;
    }
    expectOrder(gaps, each.order);
  }
}

/// CHECKS E1. The polygons approach the circles at second order too.
TEST(AnnulusModulus, OfARoundAnnulusConvergesAtSecondOrder) {
  const double exact = std::log(2.5) / (2 * std::numbers::pi);
  std::vector<double> errors;
  for (const double resolution : {4.0, 8.0, 16.0, 32.0}) {
    const auto ring = borderedPeriodsOf(
        sampleSurface("annulus", {{"r", 2}, {"R", 5}, {"resolution", resolution}}));
    ASSERT_OK(ring);
    ASSERT_TRUE(ring->modulus);
    EXPECT_LT(ring->modulus->lower, ring->modulus->value);
    EXPECT_LT(ring->modulus->value, ring->modulus->upper);
    errors.push_back(std::abs(ring->modulus->value - exact));
  }
  expectOrder(errors, 2);
}

struct Frame {
  int half, hole;
  double capacity;
};

class SquareFrame : public testing::TestWithParam<Frame> {};

INSTANTIATE_TEST_SUITE_P(Ratios, SquareFrame,
                         testing::Values(Frame{2, 1, 10.23409256936805173},
                                         Frame{10, 1, 2.83977741905223667},
                                         Frame{10, 9, 74.2349151987788367}),
                         [](const auto& frame) {
                           return std::to_string(frame.param.hole) + "of" +
                                  std::to_string(frame.param.half);
                         });

/// CHECKS E3, E4, C8: cones of 3 pi at the inner corners of the double slow the raw energies down
/// to order 4/3; their errors cancel in the projected modulus.
TEST_P(SquareFrame, CapacityConvergesAtTheOrderOfItsCorners) {
  const auto [half, hole, exact] = GetParam();
  const MetricSurface frame = squareFrame(half, hole);
  std::vector<double> raw, projected;
  for (const int n : {1, 2, 4, 8}) {
    const auto periods = borderedPeriodsOf(subdivide(frame, n));
    ASSERT_OK(periods);
    raw.push_back(periods->capacity(0, 0) - exact);
    projected.push_back(std::abs(periods->modulus->value - 1 / exact));
    EXPECT_GT(raw.back(), 0);
    EXPECT_LE(periods->modulus->lower, 1 / exact);
    EXPECT_GE(periods->modulus->upper, 1 / exact);
  }
  expectOrder(raw, 4.0 / 3);
  EXPECT_LT(projected.back(), 0.1 * raw.back() / (exact * exact));
}

/// An L of three unit squares with arms along the axes.
MetricSurface lShape() {
  return fromPositions(
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {0, 2, 0}, {1, 2, 0}},
      {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {3, 4, 7}, {3, 7, 6}});
}

/// CHECKS E5: between the ends of its arms, with the lower bounds of a five-point scheme, which the
/// cotan scheme on right triangles is.
TEST(QuadrilateralModulus, OfTheLConvergesAtTheOrderOfItsCorner) {
  const double exact = 2.558523142342012932;
  const std::vector<double> published{2.538364, 2.550386, 2.555261, 2.557221, 2.558004};
  std::vector<double> errors, projected;
  for (std::size_t k = 0; k < published.size(); ++k) {
    const auto modulus = modulusOf(subdivide(lShape(), 8 << k), {6, 2, 5, 7});
    ASSERT_OK(modulus);
    EXPECT_NEAR(modulus->lower, published[k], 1e-6);
    EXPECT_GE(modulus->upper, exact);
    errors.push_back(exact - modulus->lower);
    projected.push_back(std::abs(modulus->value - exact));
  }
  for (std::size_t k = errors.size() - 2; k < errors.size(); ++k) {
    EXPECT_NEAR(std::log2(errors[k - 1] / errors[k]), 4.0 / 3, 0.25);
  }
  EXPECT_LT(projected.back(), errors.back());
}

/// CHECKS D6b and D11: two extrapolations of one genus-2 surface, by its double and by fluxes.
TEST(Capacity, AndTheDoubleExtrapolateToTheSameEnergies) {
  const MetricSurface base = plate(7, 3, {{1, 1}, {4, 1}});
  const std::vector<double> published{.34488, .36922, .66479, .76341};
  const std::vector<double> gaps{.2258, .0848, .0329};
  std::vector<double> least;
  Eigen::MatrixXd before, extrapolated;
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    const MetricSurface mesh = subdivide(base, 2 << k);
    const auto closed = closedPeriodsOf(doubled(mesh));
    ASSERT_OK(closed);
    EXPECT_NEAR((closed->energy.determinant() - 1) / gaps[k], 1, 5e-3);
    least.push_back(spectrum(closed->periods.energy)[0]);
    const auto bordered = borderedPeriodsOf(mesh);
    ASSERT_OK(bordered);
    const double ratio = std::pow(2, 4.0 / 3);
    if (k > 0) extrapolated = (ratio * bordered->capacity - before) / (ratio - 1);
    before = bordered->capacity;
  }
  // Projected values of the least energy as published for n = 2, 4, 8.
  EXPECT_NEAR(least[0], .345808, 2e-6);
  EXPECT_NEAR(least[1], .345099, 2e-6);
  EXPECT_NEAR(least[2], .344940, 2e-6);
  Eigen::MatrixXcd period = Eigen::MatrixXcd::Zero(2, 2);
  period.imag() = 2 * extrapolated.inverse();
  const auto energies = spectrum(energyOfPeriod(period));
  EXPECT_NEAR(energies[0], published[0], 5e-5);
  EXPECT_NEAR(energies[1], published[1], 5e-5);
  EXPECT_NEAR(energies[2], published[2], 1e-4);
  EXPECT_NEAR(energies[3], published[3], 1e-4);
  const double from_double = least[2] + (least[2] - least[1]) / 3;  // Order 2.
  EXPECT_NEAR(energies[0], from_double, 5e-5);
}

}  // namespace
}  // namespace moduli
