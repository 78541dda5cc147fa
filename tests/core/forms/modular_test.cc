#include "core/forms/modular.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "tests/core/testing.h"

namespace moduli {
namespace {

const Complex kI(0, 1);
const Complex kRho(-0.5, std::sqrt(3.0) / 2);
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Complex act(const ModularMatrix& m, Complex tau) {
  return (static_cast<double>(m.a) * tau + static_cast<double>(m.b)) /
         (static_cast<double>(m.c) * tau + static_cast<double>(m.d));
}

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

/// In the interior of the fundamental domain, up to a height of about 5.
Complex randomReduced(std::mt19937& random) {
  while (true) {
    const Complex tau(uniform(random, -0.49, 0.49), std::exp(uniform(random, -0.15, 1.6)));
    if (std::abs(tau) > 1.01) return tau;
  }
}

/// A product of `letters` translations by up to 3 and inversions.
ModularMatrix randomWord(std::mt19937& random, int letters) {
  ModularMatrix m;
  for (int k = 0; k < letters; ++k) {
    const long long n = static_cast<long long>(random() % 7) - 3;
    m = {m.a + n * m.c, m.b + n * m.d, m.c, m.d};
    m = {-m.c, -m.d, m.a, m.b};
  }
  return m;
}

TEST(Reduction, UndoesRandomWords) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    const Complex tau = randomReduced(random);
    const ModularMatrix word = randomWord(random, 1 + trial % 5);
    const Complex given = act(word, tau);
    const auto reduced = reduceToFundamentalDomain(given);
    ASSERT_OK(reduced);
    // A rounding error of `given` is |given| / Im(given) times as large in hyperbolic length, here
    // below 1e5.
    EXPECT_LT(std::abs(reduced->tau - tau), 1e-10);
    const ModularMatrix m = reduced->transform;
    EXPECT_EQ(m.a * m.d - m.b * m.c, 1);
    EXPECT_LT(std::abs(act(m, given) - reduced->tau), 1e-10);
  }
}

TEST(Reduction, TiesOnTheBorderGoToNonNegativeRealParts) {
  const auto reduce = [](Complex tau) { return reduceToFundamentalDomain(tau)->tau; };
  EXPECT_EQ(reduce({-0.5, 2}), Complex(0.5, 2));
  EXPECT_EQ(reduce({0.5, 2}), Complex(0.5, 2));
  EXPECT_EQ(reduce({-0.5 + 1e-15, 2}), Complex(0.5 + 1e-15, 2));
  EXPECT_LT(std::abs(reduce(kRho) - Complex(0.5, kRho.imag())), 1e-15);
  for (const double angle : {1.6, 1.8, 2.0, 2.09}) {
    for (const double radius : {1.0, 1 - 1e-14, 1 + 1e-14}) {
      const Complex tau = reduce(std::polar(radius, angle));
      EXPECT_GE(tau.real(), 0) << angle;
      EXPECT_LT(std::abs(tau - std::polar(1.0, std::numbers::pi - angle)), 1e-13);
    }
  }
  const Complex at_i = reduce({-0.0, 1});
  EXPECT_EQ(at_i, kI);
  EXPECT_FALSE(std::signbit(at_i.real()));
}

TEST(Reduction, IsIdempotent) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const Complex tau(uniform(random, -5, 5), std::exp(uniform(random, -6, 3)));
    const auto once = reduceToFundamentalDomain(tau);
    ASSERT_OK(once);
    EXPECT_LE(std::abs(once->tau.real()), 0.5 + 1e-10);
    EXPECT_GE(std::abs(once->tau), 1 - 1e-11);
    EXPECT_EQ(reduceToFundamentalDomain(once->tau)->tau, once->tau);
  }
}

TEST(Reduction, RefusesWhatIsNotInTheUpperHalfPlane) {
  for (const Complex tau : {Complex(0, 0), Complex(1, -1), Complex(0, kInfinity),
                            Complex(kInfinity, 1), Complex(std::nan(""), 1)}) {
    EXPECT_THAT(reduceToFundamentalDomain(tau), FailsWith(Reason::kInvalidOption));
    EXPECT_TRUE(std::isnan(jInvariant(tau).real()));
    EXPECT_TRUE(std::isnan(teichmullerDistance(tau, kI)));
    EXPECT_TRUE(std::isnan(modularFeatures(tau)[0]));
  }
  EXPECT_THAT(reduceToFundamentalDomain({1e300, 1}), FailsWith(Reason::kOverflow));
}

TEST(JInvariant, HasItsClassicalValues) {
  const auto relative = [](Complex tau, double expected) {
    return std::abs(jInvariant(tau) - expected) / std::abs(expected);
  };
  EXPECT_LT(relative(kI, 1728), 1e-13);
  EXPECT_LT(relative(2.0 * kI, 287496), 1e-13);
  EXPECT_LT(relative(std::sqrt(2.0) * kI, 8000), 1e-13);
  EXPECT_LT(relative({0.5, std::sqrt(7.0) / 2}, -3375), 1e-13);
  EXPECT_LT(relative({0.5, std::sqrt(163.0) / 2}, -262537412640768000.0), 1e-12);
  EXPECT_LT(std::abs(jInvariant(kRho)), 1e-10);
}

TEST(JInvariant, IsInvariantUnderTheModularGroup) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const Complex tau = randomReduced(random);
    const Complex j = jInvariant(tau);
    // |j'| / |j| is below 2 pi but near the zero of j, where |j| + 1728 takes its place.
    EXPECT_LT(std::abs(jInvariant(act(randomWord(random, 4), tau)) - j),
              1e-9 * (std::abs(j) + 1728));
  }
}

TEST(JInvariant, IsInfiniteWhereItOverflows) {
  EXPECT_EQ(jInvariant({0.3, 200}).real(), kInfinity);
  EXPECT_TRUE(std::isfinite(jInvariant({0, 100}).real()));
}

TEST(TeichmullerDistance, HasItsExactValues) {
  EXPECT_NEAR(teichmullerDistance(kI, 2.0 * kI), std::log(2) / 2, 1e-15);
  EXPECT_NEAR(teichmullerDistance(kI, kRho), std::log(3) / 4, 1e-15);
  EXPECT_NEAR(teichmullerDistance(kI, kRho), 0.27465307216702742, 1e-13);
  EXPECT_NEAR(teichmullerDistance(kI, {0, 1e200}), std::log(1e200) / 2, 1e-12);
  EXPECT_EQ(teichmullerDistance(kI, kI), 0);
}

/// The least distance of tau1 from the images of tau2 under all of SL(2, Z) with entries up to n.
double bruteForceDistance(Complex tau1, Complex tau2, long long n) {
  double least = kInfinity;
  for (long long a = -n; a <= n; ++a) {
    for (long long b = -n; b <= n; ++b) {
      for (long long c = 0; c <= n; ++c) {
        for (long long d = -n; d <= n; ++d) {
          if (a * d - b * c != 1) continue;
          const Complex image = act({a, b, c, d}, tau2);
          least = std::min(
              least,
              std::acosh(1 + std::norm(tau1 - image) / (2 * tau1.imag() * image.imag())) / 2);
        }
      }
    }
  }
  return least;
}

TEST(TeichmullerDistance, IsTheLeastOverTheModularGroup) {
  std::mt19937 random(4);
  int indirect = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Complex z = randomReduced(random);
    Complex w = randomReduced(random);
    if (trial % 3 == 0) z = std::polar(1.0, uniform(random, 1.05, 2.09));
    if (trial % 5 == 0) w = std::polar(1.001, uniform(random, 1.05, 2.09));
    const double least = bruteForceDistance(z, w, 5);
    // acosh loses half of the digits near 1.
    EXPECT_NEAR(teichmullerDistance(z, w), least, 1e-7) << z << w;
    EXPECT_NEAR(teichmullerDistance(w, z), teichmullerDistance(z, w), 1e-14);
    const double direct = std::asinh(std::abs(z - w) / (2 * std::sqrt(z.imag() * w.imag())));
    if (least < direct - 1e-6) ++indirect;
  }
  EXPECT_GT(indirect, 50) << "the test pairs are too easy";
}

TEST(TeichmullerDistance, ForgetsMarkingsAndIsAMetric) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 500; ++trial) {
    const Complex x = randomReduced(random);
    const Complex y = randomReduced(random);
    const Complex z = randomReduced(random);
    const double xy = teichmullerDistance(x, y);
    EXPECT_NEAR(teichmullerDistance(act(randomWord(random, 3), x), y), xy, 1e-9);
    EXPECT_LE(xy, teichmullerDistance(x, z) + teichmullerDistance(z, y) + 1e-14);
  }
}

TEST(TeichmullerDistance, TellsMirrorImagesApart) {
  const Complex tau(0.3, 1.2);
  EXPECT_GT(teichmullerDistance(tau, -std::conj(tau)), 0.1);
  EXPECT_NEAR(teichmullerDistance({0.5, 1.2}, {-0.5, 1.2}), 0, 1e-15);
  EXPECT_NEAR(teichmullerDistance(std::polar(1.0, 1.2), std::polar(1.0, std::numbers::pi - 1.2)), 0,
              1e-15);
}

double featureDistance(const std::array<double, 4>& f, const std::array<double, 4>& g) {
  double sum = 0;
  for (int k = 0; k < 4; ++k) sum += (f[k] - g[k]) * (f[k] - g[k]);
  return std::sqrt(sum);
}

TEST(ModularFeatures, LieOnTheSphereWithHeightOfTheReducedPoint) {
  const auto at_i = modularFeatures(kI);  // j / 1728 = 1.
  EXPECT_LT(featureDistance(at_i, {1, 0, 0, 0}), 1e-13);
  const auto at_rho = modularFeatures(kRho);  // j = 0.
  EXPECT_LT(featureDistance(at_rho, {0, 0, -1, std::log(std::sqrt(3.0) / 2)}), 1e-13);
  const auto at_cusp = modularFeatures({0.2, 1e3});  // j is infinite.
  EXPECT_LT(featureDistance(at_cusp, {0, 0, 1, std::log(1e3)}), 1e-13);
}

/// Along random paths, which cross all borders, a step of hyperbolic length s changes the features
/// by at most 12 s, as inside the domain; a jump at a border would not shrink with s.
TEST(ModularFeatures, AreContinuousAlongRandomPaths) {
  std::mt19937 random(6);
  int crossed_side = 0;
  int crossed_arc = 0;
  for (int path = 0; path < 200; ++path) {
    const Complex start(uniform(random, -1, 1), std::exp(uniform(random, -0.5, 0.7)));
    const Complex end(uniform(random, -1, 1), std::exp(uniform(random, -0.5, 0.7)));
    constexpr int kSteps = 4000;
    Complex before = start;
    ReducedTau reduced_before = *reduceToFundamentalDomain(before);
    auto features_before = modularFeatures(before);
    for (int k = 1; k <= kSteps; ++k) {
      const Complex tau = start + (end - start) * (static_cast<double>(k) / kSteps);
      const auto features = modularFeatures(tau);
      const ReducedTau reduced = *reduceToFundamentalDomain(tau);
      const double step =
          2 * std::asinh(std::abs(tau - before) / (2 * std::sqrt(tau.imag() * before.imag())));
      ASSERT_LE(featureDistance(features, features_before), 12 * step) << tau;
      if (std::abs(reduced.tau.real() - reduced_before.tau.real()) > 0.9) ++crossed_side;
      if (reduced.transform.c != reduced_before.transform.c) ++crossed_arc;
      before = tau;
      reduced_before = reduced;
      features_before = features;
    }
  }
  EXPECT_GT(crossed_side, 20);
  EXPECT_GT(crossed_arc, 20);
}

TEST(ModularFeatures, MirrorImagesDifferInTheSecondCoordinateAlone) {
  const Complex tau(0.23, 1.1);
  const auto f = modularFeatures(tau);
  const auto g = modularFeatures(-std::conj(tau));
  EXPECT_LT(featureDistance(f, {g[0], -g[1], g[2], g[3]}), 1e-13);
  EXPECT_GT(std::abs(f[1]), 0.1);
}

}  // namespace
}  // namespace moduli
