#include "core/ricci/lobachevsky.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

/// x (1 - log 2x) less the integral of log(sin t / t), by Gauss's rule of five points on 64 parts,
/// in long double: the integrand is analytic up to t = pi, the error far below 1e-18 for x < 2.
double byQuadrature(double x) {
  constexpr std::array<long double, 3> kNode{0.0L, 0.538469310105683091036314420700208805L,
                                             0.906179845938663992797626878299392965L};
  constexpr std::array<long double, 3> kWeight{0.568888888888888888888888888888888889L,
                                               0.478628670499366468041291514835638193L,
                                               0.236926885056189087514264040719917363L};
  constexpr int kParts = 64;
  const auto f = [](long double t) { return std::log(std::sin(t) / t); };
  const long double half = static_cast<long double>(x) / (2 * kParts);
  long double sum = 0;
  for (int part = 0; part < kParts; ++part) {
    const long double middle = (2 * part + 1) * half;
    sum += kWeight[0] * f(middle);
    for (int k = 1; k < 3; ++k) {
      sum += kWeight[k] * (f(middle - kNode[k] * half) + f(middle + kNode[k] * half));
    }
  }
  return static_cast<double>(x * (1 - std::log(2.0L * x)) - half * sum);
}

TEST(Lobachevsky, IsTheIntegralThatDefinesIt) {
  for (int k = 1; k <= 1000; ++k) {
    const double x = 2.0 * k / 1000;
    EXPECT_NEAR(lobachevsky(x), byQuadrature(x), 1e-15) << x;
  }
}

TEST(Lobachevsky, HasItsKnownValues) {
  const double catalan = 0.91596559417721901505;
  EXPECT_NEAR(lobachevsky(kPi / 4), catalan / 2, 1e-15);
  EXPECT_NEAR(lobachevsky(kPi / 6), 0.50747080320482681251, 1e-15);
  // The volume of the regular ideal tetrahedron.
  EXPECT_NEAR(3 * lobachevsky(kPi / 3), 1.0149416064096536250, 2e-15);
  EXPECT_EQ(lobachevsky(0), 0);
  // Of the doubles next to pi / 2 and pi, not of these themselves.
  EXPECT_NEAR(lobachevsky(kPi / 2) / (6.123233995736766e-17 * std::numbers::ln2), 1, 1e-14);
  EXPECT_NEAR(lobachevsky(kPi), 0, 1e-14);
  // Computed to 20 digits at these doubles.
  EXPECT_NEAR(lobachevsky(0.1), 0.26099935791511870712, 1e-15);
  EXPECT_NEAR(lobachevsky(3), -0.3203913328508616048, 1e-15);
  EXPECT_NEAR(lobachevsky(-2.5), 0.49641006627347835935, 1e-15);
  EXPECT_NEAR(lobachevsky(100.25), -0.44414115317248150332, 1e-15);
  EXPECT_NEAR(lobachevsky(12345.678), -0.4594533717194866996, 1e-15);
  EXPECT_NEAR(lobachevsky(1e-8) / 1.8727533563392420539e-7, 1, 1e-15);
}

TEST(Lobachevsky, IsOddAndObeysTheFormulaForMultiples) {
  // L(n x) = n times the sum of L(x + k pi / n).
  for (int step = -40; step <= 40; ++step) {
    const double x = 0.037 * step;
    EXPECT_EQ(lobachevsky(-x), -lobachevsky(x));
    for (int n = 2; n <= 5; ++n) {
      double sum = 0;
      for (int k = 0; k < n; ++k) sum += lobachevsky(x + k * kPi / n);
      // The arguments are rounded, and the slope near k pi is up to 40.
      EXPECT_NEAR(lobachevsky(n * x), n * sum, 4e-14) << x << " " << n;
    }
  }
}

TEST(Lobachevsky, OfNoNumberIsNone) {
  EXPECT_TRUE(std::isnan(lobachevsky(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_TRUE(std::isnan(lobachevsky(std::numeric_limits<double>::infinity())));
}

}  // namespace
}  // namespace moduli
