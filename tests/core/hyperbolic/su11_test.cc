#include "core/hyperbolic/su11.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

/// Products of a dozen roundings of entries below 4.
constexpr double kRounding = 1e-14;

Su11 random(std::mt19937& engine, double reach = 2) {
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  std::uniform_real_distribution<double> length(0, reach);
  return rotation(angle(engine)) * translation(length(engine)) * rotation(angle(engine));
}

Complex randomPoint(std::mt19937& engine) {
  return imageOf(random(engine), 0.0);
}

TEST(Su11, ProductIsCompositionAndInverseUndoes) {
  std::mt19937 engine(1);
  for (int i = 0; i < 100; ++i) {
    const Su11 g = random(engine);
    const Su11 h = random(engine);
    const Complex z = randomPoint(engine);
    EXPECT_LE(std::abs(imageOf(g * h, z) - imageOf(g, imageOf(h, z))), kRounding);
    EXPECT_LE(distanceToUnit(g * inverse(g)), kRounding);
    EXPECT_LE(std::abs(determinantDrift(g * h)), 4 * kRounding);
  }
}

TEST(Su11, KeepsDistances) {
  std::mt19937 engine(2);
  for (int i = 0; i < 100; ++i) {
    const Su11 g = random(engine);
    const Complex p = randomPoint(engine);
    const Complex q = randomPoint(engine);
    // 1 - |p|^2 of points at distance 4 keeps its digits but for a factor e^4.
    EXPECT_NEAR(hyperbolicDistance(imageOf(g, p), imageOf(g, q)), hyperbolicDistance(p, q), 1e-12);
  }
}

TEST(Su11, DistanceIsExactAlongARayForNearAndFarPoints) {
  for (const double d : {1e-12, 1e-6, 1.0, 10.0}) {
    const Complex p = imageOf(rotation(0.7) * translation(0.5), 0.0);
    const Complex q = imageOf(rotation(0.7) * translation(0.5 + d), 0.0);
    // The points themselves are rounded: by 1e-16, and e^d times as much in distance.
    EXPECT_NEAR(hyperbolicDistance(p, q), d, 1e-15 * std::exp(0.5 + d));
  }
}

TEST(Su11, TranslationIsReadBackFromItsMatrix) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> angle(0, 2 * kPi);
  for (const double length : {1e-9, 1e-3, 0.5, 3.0, 20.0}) {
    for (int i = 0; i < 20; ++i) {
      const double at = angle(engine);
      const Complex from = std::polar(1.0, at);
      const Complex to = std::polar(1.0, at + kPi / 2 + angle(engine) / 2);
      const Su11 g = translation(from, to, length);
      EXPECT_LE(std::abs(determinantDrift(g)), kRounding * std::norm(g.a));
      // Axes pass 0 at distance 1 or less: entries are right to 1e-15, the sine relatively so.
      EXPECT_NEAR(translationLength(g), length, 1e-13 * std::max(length, 1.0) * length);
      for (const Su11& lift : {g, -g}) {
        const auto [repelling, attracting] = axisEnds(lift);
        EXPECT_LE(std::abs(repelling - from), 1e-12);
        EXPECT_LE(std::abs(attracting - to), 1e-12);
      }
    }
  }
}

TEST(Su11, LengthDoesNotDependOnConjugation) {
  std::mt19937 engine(4);
  for (const double length : {0.1, 1.0, 6.0}) {
    for (int i = 0; i < 50; ++i) {
      const Su11 h = random(engine, 4);
      const Su11 g = h * translation(length) * inverse(h);
      // |a| is at most e^{4 + length / 2}; l moves by 2e-16 |a|^2 / sinh(length / 2) or less.
      EXPECT_NEAR(translationLength(g), length, 1e-9);
    }
  }
}

TEST(Su11, RotationsAndParabolicElementsHaveNoLength) {
  EXPECT_EQ(translationLength(rotation(1)), 0);
  EXPECT_EQ(translationLength(Su11{}), 0);
  EXPECT_EQ(translationLength({{1, 0.75}, {0, 0.75}}), 0);
  EXPECT_EQ(translationLength(edgeHalfTurn(2)), 0);
}

TEST(Su11, AxisOnTheRightLeavesTheOriginOnItsLeft) {
  // The geodesic below 0 with ends a quarter turn apart, run through from left to right:
  // cosh(distance) = 1 / sin(half the angle between the ends).
  const Su11 g = translation(std::polar(1.0, -3 * kPi / 4), std::polar(1.0, -kPi / 4), 1);
  const double distance = std::acosh(1 / std::sin(kPi / 4));
  EXPECT_NEAR(signedDistanceToAxis(g), distance, kRounding);
  EXPECT_NEAR(signedDistanceToAxis(-g), distance, kRounding);
  EXPECT_NEAR(signedDistanceToAxis(inverse(g)), -distance, kRounding);
  // sinh(d(0, g 0) / 2) = cosh(distance) sinh(l / 2).
  EXPECT_NEAR(std::sinh(displacement(g) / 2), std::cosh(distance) * std::sinh(0.5), kRounding);
}

TEST(Su11, EdgeFrameCarriesTheRealAxisToTheEdge) {
  std::mt19937 engine(5);
  for (int i = 0; i < 100; ++i) {
    const Complex p = randomPoint(engine);
    const Complex q = randomPoint(engine);
    const Su11 frame = edgeFrame(p, q);
    const double length = hyperbolicDistance(p, q);
    EXPECT_LE(std::abs(imageOf(frame, 0.0) - p), kRounding);
    EXPECT_LE(std::abs(imageOf(frame * translation(length), 0.0) - q), 1e-13);
  }
}

TEST(Su11, HalfTurnSwapsTheEndsOfAnEdge) {
  for (const double length : {1e-5, 0.3, 4.0}) {
    const Su11 turn = edgeHalfTurn(length);
    const Complex end = std::tanh(length / 2);
    EXPECT_LE(std::abs(imageOf(turn, 0.0) - end), kRounding);
    EXPECT_LE(std::abs(imageOf(turn, end)), kRounding);
    const Su11 square = turn * turn;
    EXPECT_LE(std::abs(square.a + 1.0) + std::abs(square.b), 4 * kRounding);
  }
}

TEST(Su11, RenormalizingLargeElementsMovesTheirImagesByRounding) {
  std::mt19937 engine(6);
  for (int i = 0; i < 50; ++i) {
    Su11 g = random(engine) * translation(30);
    const Complex image = imageOf(g, 0.0);
    g.a *= 1 + 1e-9;
    const Su11 fixed = renormalized(g);
    EXPECT_LE(std::abs(std::abs(fixed.a) - std::hypot(1.0, std::abs(fixed.b))),
              1e-15 * std::abs(fixed.a));
    EXPECT_LE(std::abs(imageOf(fixed, 0.0) - image), 1e-15);
  }
}

}  // namespace
}  // namespace moduli
