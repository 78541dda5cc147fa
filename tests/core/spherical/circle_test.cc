#include "core/spherical/circle.h"

#include <cmath>
#include <numbers>

#include "tests/core/testing.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

std::vector<Complex> pointsOf(const Circle& circle, int n) {
  std::vector<Complex> points;
  for (int k = 0; k < n; ++k) {
    points.push_back(circle.center + std::polar(circle.radius, 0.2 + 1.7 * k * k));
  }
  return points;
}

TEST(FitCircle, FindsTheCircleOfPointsOnOne) {
  for (const Circle& circle :
       {Circle{{0, 0}, 1}, Circle{{3, -7}, 1e-3}, Circle{{-0.2, 0.9}, 1e5}}) {
    for (const int n : {3, 4, 50}) {
      const std::vector<Complex> points = pointsOf(circle, n);
      const Circle found = fitCircle(points);
      const double rounding = 1e-13 * (circle.radius + std::abs(circle.center));
      EXPECT_LT(std::abs(found.center - circle.center), rounding);
      EXPECT_NEAR(found.radius, circle.radius, rounding);
      EXPECT_LT(roundnessError(found, points), rounding);
    }
  }
}

TEST(FitCircle, TellsHowFarPointsAreFromIt) {
  std::vector<Complex> points;
  for (int k = 0; k < 60; ++k) {
    const double angle = 2 * std::numbers::pi * k / 60;
    points.push_back(std::polar(1 + 0.01 * std::cos(3 * angle), angle));
  }
  EXPECT_NEAR(roundnessError(fitCircle(points), points), 0.01, 1e-4);
}

TEST(DiskTranslation, CarriesCirclesAsItCarriesTheirPoints) {
  const DiskTranslation map{{0.3, -0.6}};
  for (const Circle& circle : {Circle{{0.2, 0.1}, 0.5}, Circle{{0.3, -0.6}, 0.1}, Circle{0, 0.9}}) {
    std::vector<Complex> points = pointsOf(circle, 9);
    for (Complex& z : points) z = map(z);
    EXPECT_LT(roundnessError(map(circle), points), 1e-14);
  }
  EXPECT_EQ(map(Complex(0.3, -0.6)), Complex(0));
}

TEST(DiskTranslation, CentresCircles) {
  for (const Circle& circle :
       {Circle{{0.2, 0.1}, 0.5}, Circle{{-0.9, 0.3}, 0.01}, Circle{0, 0.9}}) {
    const Circle centered = centeringMap(circle)(circle);
    EXPECT_LT(std::abs(centered.center), 1e-14);
    EXPECT_NEAR(centered.radius, centeredRadius(circle), 1e-14);
  }
  // Through 1 / 2 and -1 / 4: (1/2 - m) / (1 - m/2) = (1/4 + m) / (1 + m/4), m^2 - 7 m + 1 = 0.
  const double m = (7 - std::sqrt(45.0)) / 2;
  EXPECT_NEAR(centeringMap({0.125, 0.375}).zero.real(), m, 1e-14);
  EXPECT_NEAR(centeredRadius({0.125, 0.375}), (0.5 - m) / (1 - m / 2), 1e-14);
}

}  // namespace
}  // namespace moduli
