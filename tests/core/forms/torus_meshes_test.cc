// Periods of larger surfaces: convergence on smooth tori, doubles of plates, real meshes.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/forms/torus_period.h"
#include "core/mesh/read.h"
#include "core/mesh/triangle_mesh.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Result<TorusPeriod> periodOf(const MetricSurface& torus) {
  Context context;
  return computeTorusPeriod(context, torus.surface, torus.lengths);
}

void expectSecondOrder(const std::vector<double>& errors, const std::vector<double>& published) {
  for (std::size_t k = 0; k < errors.size(); ++k) {
    EXPECT_NEAR(errors[k] / published[k], 1, 2e-3) << k;
    if (k > 0) {
      EXPECT_GT(errors[k - 1] / errors[k], 3.9);
      EXPECT_LT(errors[k - 1] / errors[k], 4.1);
    }
  }
}

TEST(TorusPeriod, RevolutionTorusConvergesAtSecondOrder) {
  std::vector<double> errors;
  for (const int k : {16, 32, 64, 128}) {
    const auto period = periodOf(torusOfRevolution(2, 1, 2 * k, k));
    ASSERT_OK(period);
    errors.push_back(std::abs(period->tau - std::sqrt(3.0) * Complex(0, 1)));
    EXPECT_GT(period->determinant_gap, 0);
  }
  expectSecondOrder(errors, {1.387e-2, 3.475e-3, 8.69e-4, 2.17e-4});
}

TEST(TorusPeriod, CliffordTorusConvergesAtSecondOrder) {
  std::vector<double> errors;
  for (const int k : {16, 32, 64, 128}) {
    const auto period = periodOf(torusOfRevolution(std::sqrt(2.0), 1, 3 * k / 2, k));
    ASSERT_OK(period);
    errors.push_back(std::abs(period->tau - Complex(0, 1)));
  }
  expectSecondOrder(errors, {1.30e-2, 3.29e-3, 8.25e-4, 2.06e-4});
}

/// The period of the double is i C / 2 with the frame's capacity C; cone angles 3 pi at the inner
/// corners slow the energy down to rate 4/3, but the projection keeps rate 2.
TEST(TorusPeriod, DoubledSquareFrameConvergesAtItsRates) {
  const Complex exact(0, 5.11704628468402586);
  const MetricSurface frame = doubled(squareFrame(2, 1));
  const std::vector<int> parts{2, 4, 8, 16};
  const std::vector<double> errors{-1.254e-2, -3.154e-3, -7.93e-4, -1.99e-4};
  const std::vector<double> gaps{6.78e-2, 2.64e-2, 1.04e-2, 4.12e-3};
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto period = periodOf(subdivide(frame, parts[k]));
    ASSERT_OK(period);
    EXPECT_NEAR((period->tau - exact).imag() / errors[k], 1, 3e-3);
    EXPECT_NEAR(period->tau.real(), 0, 1e-12);
    EXPECT_NEAR(period->determinant_gap / gaps[k], 1, 3e-3);
    EXPECT_LE(std::abs(period->tau - exact), period->tau_error);
  }
}

class RealTorus : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Shared, RealTorus,
                         testing::Values("cfwen__torus.off", "ceaedf__Kitten.off",
                                         "cfwen__kitten.nf20k.off", "cfwen__knot.obj",
                                         "alec__rocker-arm.obj", "ceaedf__rocker-arm2500.off"),
                         [](const auto& name) {
                           std::string letters = name.param;
                           std::erase_if(letters, [](unsigned char c) { return !std::isalnum(c); });
                           return letters;
                         });

Result<TriangleSoup> readTorus(const std::string& path) {
  Context context;
  return readMeshFile(context, path);
}

MetricSurface metricOf(const TriangleSoup& soup) {
  return fromPositions(soup.vertices, soup.faces);
}

TEST_P(RealTorus, PeriodSurvivesNumberingMotionAndScale) {
  MODULI_NEED_SHARED_MESH(path, "genus1/" + GetParam());
  const auto soup = readTorus(path);
  ASSERT_OK(soup);
  const MetricSurface torus = metricOf(*soup);
  const auto period = periodOf(torus);
  ASSERT_OK(period);
  EXPECT_GT(period->determinant_gap, 0);
  EXPECT_LT(period->closure_residual, 1e-10);
  // Both are the square root of det E_h, up to rounding.
  EXPECT_NEAR(period->riemann_residual, std::sqrt(1 + period->determinant_gap) - 1, 1e-12);

  TriangleSoup moved = *soup;
  const Eigen::AngleAxisd turn(1.1, Eigen::Vector3d(1, 2, -1).normalized());
  const double size = (soup->vertices[0] - soup->vertices[soup->vertices.size() / 2]).norm();
  for (auto& p : moved.vertices) p = turn * p * 3.7 + size * Eigen::Vector3d(5, -3, 8);
  const std::vector<MetricSurface> others{renumber(torus, 1), renumber(torus, 2), metricOf(moved),
                                          scale(torus, 1e-7), renumber(metricOf(moved), 3)};
  for (const MetricSurface& other : others) {
    const auto again = periodOf(other);
    ASSERT_OK(again);
    EXPECT_LT(std::abs(again->tau - period->tau), 1e-10);
    EXPECT_NEAR(again->tau_error / period->tau_error, 1, 1e-6);
  }
  const auto image = periodOf(mirror(torus));
  ASSERT_OK(image);
  EXPECT_LT(std::abs(image->tau - reduceToFundamentalDomain(-std::conj(period->tau))->tau), 1e-10);
}

/// Other triangulations of the same polyhedral metric: every period lies within its bound of the
/// exact one, so any two lie within the sum of their bounds.
TEST_P(RealTorus, RetriangulationStaysWithinTheBounds) {
  MODULI_NEED_SHARED_MESH(path, "genus1/" + GetParam());
  const auto soup = readTorus(path);
  ASSERT_OK(soup);
  const MetricSurface torus = metricOf(*soup);
  const auto period = periodOf(torus);
  ASSERT_OK(period);
  EXPECT_LT(period->tau_error, 0.02 * period->tau.imag());
  const int flips = torus.surface.edgeCount();
  const std::vector<MetricSurface> others{flipEdges(torus, flips, 1), flipEdges(torus, flips, 2),
                                          subdivide(torus, 2),
                                          flipEdges(subdivide(torus, 2), 4 * flips, 3)};
  for (const MetricSurface& other : others) {
    const auto again = periodOf(other);
    ASSERT_OK(again);
    EXPECT_NE(again->tau, period->tau);
    EXPECT_LE(std::abs(again->tau - period->tau), again->tau_error + period->tau_error);
  }
  EXPECT_LT(periodOf(others[2])->determinant_gap, period->determinant_gap);
}

}  // namespace
}  // namespace moduli
