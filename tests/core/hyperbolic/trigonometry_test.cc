#include "core/hyperbolic/trigonometry.h"

#include <cmath>
#include <limits>

#include "core/hyperbolic/su11.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::array<double, 3> seamsOf(const std::array<double, 3>& cuffs) {
  const auto seams = pantsSeams(cuffs);
  EXPECT_OK(seams);
  return seams.ok() ? *seams : std::array<double, 3>{};
}

TEST(PantsSeams, EqualCuffsOfLengthOneAndTwo) {
  for (double seam : seamsOf({1, 1, 1})) EXPECT_NEAR(seam, 2.868695141619822, 1e-13);
  for (double seam : seamsOf({2, 2, 2})) EXPECT_NEAR(seam, 1.7049128323580138, 1e-13);
}

TEST(PantsSeams, EqualCuffsHaveSinesWithProductOneHalf) {
  // sinh(l / 4) sinh(d / 2) = 1/2. Where l is long, an error e in l / 4 is one in d of e relative.
  for (double l = 1e-8; l < 300; l *= 1.7)
    EXPECT_NEAR(std::sinh(l / 4) * std::sinh(seamsOf({l, l, l})[0] / 2), 0.5, 4e-16 * (20 + l))
        << l;
}

TEST(PantsSeams, AgreeWithTheCosineRuleInLongDouble) {
  const double lengths[] = {0.3, 1, 2.5, 6};
  for (double x : lengths)
    for (double y : lengths)
      for (double z : lengths) {
        const long double a = x / 2, b = y / 2, c = z / 2;
        const long double cosine =
            (std::cosh(c) + std::cosh(a) * std::cosh(b)) / (std::sinh(a) * std::sinh(b));
        // cosh d - 1 is at least e^-6: long double loses 3 of 19 digits.
        EXPECT_NEAR(seamsOf({x, y, z})[2] / static_cast<double>(std::acosh(cosine)), 1, 1e-14);
      }
}

TEST(PantsSeams, ShortCuffsFollowTheirLogarithm) {
  // sinh(d / 2) = 1 / (2 sinh(l / 4)) ~ 2 / l, hence d ~ 2 log(4 / l).
  EXPECT_NEAR(seamsOf({1e-200, 1e-200, 1e-200})[0], 2 * std::log(4e200), 1e-12);
  // One cusp-like cuff: cosh d = (1 + cosh^2 1) / sinh^2 1 at its two neighbours' seam.
  const double cosine = (1 + std::pow(std::cosh(1.0), 2)) / std::pow(std::sinh(1.0), 2);
  EXPECT_NEAR(seamsOf({2, 2, 1e-200})[2], std::acosh(cosine), 1e-14);
}

TEST(PantsSeams, LongCuffsFollowTheirExponential) {
  // Equal cuffs: sinh(d / 2) = 1 / (2 sinh(l / 4)) ~ e^{-l / 4}, hence d ~ 2 e^{-l / 4}.
  EXPECT_NEAR(seamsOf({1000, 1000, 1000})[1] / (2 * std::exp(-250.0)), 1, 1e-12);
}

TEST(PantsSeams, AndBackToTheCuffs) {
  const double lengths[] = {1e-6, 0.01, 1, 7, 60};
  for (double x : lengths)
    for (double y : lengths)
      for (double z : lengths) {
        const std::array<double, 3> cuffs{x, y, z};
        const auto again = pantsCuffs(seamsOf(cuffs));
        ASSERT_OK(again);
        for (int k = 0; k < 3; ++k) {
          // A short cuff is e^{-d} of its seams, a long one -log of them: both cost some digits.
          EXPECT_NEAR((*again)[k] / cuffs[k], 1, 1e-13) << x << " " << y << " " << z;
        }
      }
}

TEST(PantsSeams, CloseAHexagon) {
  // Walk along the cuff, turn, along the seam, turn, ..: six right angles lead back.
  const std::array<double, 3> cuffs{0.7, 2, 4.5};
  const std::array<double, 3> seams = seamsOf(cuffs);
  Su11 walk;
  for (int k = 0; k < 3; ++k)
    walk = walk * translation(cuffs[k] / 2) * rotation(kPi / 2) * translation(seams[(k + 2) % 3]) *
           rotation(kPi / 2);
  EXPECT_LT(distanceToUnit(walk), 1e-13);
}

TEST(PantsSeams, NeedPositiveLengths) {
  EXPECT_THAT(pantsSeams({1, 0, 1}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(pantsSeams({1, 1, std::numeric_limits<double>::infinity()}),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(pantsCuffs({std::nan(""), 1, 1}), FailsWith(Reason::kInvalidOption));
}

TEST(Pentagon, Closes) {
  for (double a : {0.2, 1.0, 3.0})
    for (double b : {2.5, 4.0}) {
      const auto sides = pentagonSides(a, b);
      ASSERT_OK(sides);
      Su11 walk;
      for (double side : *sides) walk = walk * translation(side) * rotation(kPi / 2);
      EXPECT_LT(distanceToUnit(walk), 1e-12) << a << " " << b;
    }
}

TEST(Pentagon, RegularOneHasSineOfTheGoldenRatio) {
  // sinh(x)^2 = cosh x: cosh x is the golden ratio.
  const double side = std::acosh((1 + std::sqrt(5.0)) / 2);
  const auto sides = pentagonSides(side, side);
  ASSERT_OK(sides);
  for (double x : *sides) EXPECT_NEAR(x, side, 1e-14);
}

TEST(Pentagon, LongSidesDoNotOverflow) {
  // cosh x_3 = sinh a sinh b ~ e^{a + b} / 4.
  const auto sides = pentagonSides(800, 900);
  ASSERT_OK(sides);
  EXPECT_NEAR((*sides)[3], 1700 - std::log(2.0), 1e-12);
}

TEST(Pentagon, NeedsSinesOfProductAboveOne) {
  EXPECT_THAT(pentagonSides(0.5, 0.5), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(pentagonSides(-1, 5), FailsWith(Reason::kInvalidOption));
}

TEST(Collar, HalfWidth) {
  // sinh(w) sinh(l / 2) = 1.
  for (double l : {1e-9, 0.1, 1.0, 10.0})
    EXPECT_NEAR(std::sinh(collarWidth(l)) * std::sinh(l / 2), 1, 1e-13);
  EXPECT_NEAR(collarWidth(1e-250), std::log(4e250), 1e-12);
}

}  // namespace
}  // namespace moduli
