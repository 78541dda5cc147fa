#include "core/hyperbolic/orbit_polygon.h"

#include <cmath>

#include "core/hyperbolic/axis.h"
#include "core/hyperbolic/orbit_search.h"
#include "core/intrinsic/intrinsic_samples.h"
#include "tests/core/hyperbolic/sample_groups.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::vector<Su11> sampleGroup(const char* kind) {
  const auto surface = makeIntrinsicSample(kind);
  EXPECT_OK(surface);
  return holonomyGenerators(*surface);
}

OrbitPolygon polygonOf(const std::vector<Su11>& generators, int genus) {
  Context context;
  auto polygon = orbitPolygon(context, generators, genus);
  EXPECT_OK(polygon);
  return polygon.ok() ? *polygon : OrbitPolygon{};
}

/// The sum of the corners' angles.
double angleSum(const OrbitPolygon& polygon) {
  double sum = 0;
  const std::size_t n = polygon.corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Su11 back = inverse(translationTo(polygon.corners[i]));
    sum += std::arg(imageOf(back, polygon.corners[(i + n - 1) % n]) /
                    imageOf(back, polygon.corners[(i + 1) % n]));
  }
  return sum;
}

TEST(OrbitPolygon, AreaByAnglesIsFourPiTimesGenusLessOne) {
  for (int genus = 2; genus <= 4; ++genus) {
    const OrbitPolygon polygon = polygonOf(regularPolygonGroup(genus), genus);
    const auto n = static_cast<double>(polygon.corners.size());
    // An error of 1e-16 e^{2 radius} in each angle.
    EXPECT_NEAR((n - 2) * kPi - angleSum(polygon), 4 * kPi * (genus - 1),
                n * 1e-16 * std::exp(2 * polygon.radius));
  }
}

TEST(OrbitPolygon, CornersAreAsFarFromNeighboursAsFromTheCentre) {
  const OrbitPolygon polygon = polygonOf(sampleGroup("klein"), 3);
  for (const Complex& corner : polygon.corners) {
    int near = 0;
    for (const GroupElement& g : polygon.pairings) {
      const double excess =
          hyperbolicDistance(corner, imageOf(g.map, 0.0)) - hyperbolicDistance(corner, 0.0);
      EXPECT_GT(excess, -1e-10);
      if (excess < 1e-8) ++near;
    }
    EXPECT_GE(near, 2);
  }
}

TEST(OrbitPolygon, WordsGiveThePairings) {
  const std::vector<Su11> generators = otherGenerators(sampleGroup("bolza"), 1);
  const OrbitPolygon polygon = polygonOf(generators, 2);
  for (const GroupElement& g : polygon.pairings)
    EXPECT_LT(
        distanceUpToSign(elementOfWord(generators, g.word), inGivenCoordinates(polygon, g.map)),
        1e-8);
}

TEST(OrbitPolygon, RefusesAnotherGenusAndElementsThatTurn) {
  Context context;
  const std::vector<Su11> generators = regularPolygonGroup(2);
  EXPECT_THAT(orbitPolygon(context, generators, 1), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(orbitPolygon(context, generators, 3), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(orbitPolygon(context, {rotation(0.4)}, 2), FailsWith(Reason::kInvalidOption));
  // A free group of infinite area, and one with a cone.
  EXPECT_THAT(orbitPolygon(context, {generators[0], generators[1]}, 2),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(orbitPolygon(context, {translation(2), translation({0, -1}, {0, 1}, 0.5)}, 2),
              FailsWith(Reason::kInvalidOption));
}

TEST(OrbitSearch, FindsWhatAllWordsReach) {
  const std::vector<Su11> generators = regularPolygonGroup(2);
  const OrbitPolygon polygon = polygonOf(generators, 2);
  Context context;
  constexpr double kReach = 5.5;
  const auto ball = searchOrbit(context, polygon, kReach, 100'000);
  ASSERT_OK(ball);
  EXPECT_GE(ball->complete_to, kReach);
  OrbitIndex index(polygon.separation);
  for (std::size_t i = 0; i < ball->elements.size(); ++i) {
    ASSERT_LT(index.find(ball->elements[i]), 0) << "element " << i << " is there twice";
    index.enter(ball->elements[i], static_cast<int>(i));
  }
  // All words of up to 6 letters, whichever way they lead.
  std::vector<Su11> words{Su11{}};
  const Su11 base = polygon.base;
  for (std::size_t length = 0, first = 0; length < 6; ++length) {
    const std::size_t last = words.size();
    for (; first < last; ++first)
      for (const Su11& g : generators)
        for (const Su11& letter : {g, inverse(g)}) {
          words.push_back(renormalized(words[first] * letter));
          const Su11 element = inverse(base) * words.back() * base;
          ASSERT_TRUE(displacement(element) > kReach - 1e-6 || index.find(element) >= 0);
        }
  }
}

TEST(OrbitSearch, CountGrowsAsTheAreaOfTheDisk) {
  // Delsarte: the number of orbit points within r is the area of that disk divided by the surface's
  // up to o(1); the spectral gap of Bolza's surface makes the error e^{-r/2} with a factor near 1.
  const OrbitPolygon polygon = polygonOf(sampleGroup("bolza"), 2);
  Context context;
  const auto ball = searchOrbit(context, polygon, 10, 100'000);
  ASSERT_OK(ball);
  EXPECT_NEAR(static_cast<double>(ball->elements.size()) / ((std::cosh(10.0) - 1) / 2), 1, 0.03);
}

TEST(OrbitSearch, SaysHowFarItCameWithinABudget) {
  const OrbitPolygon polygon = polygonOf(sampleGroup("bolza"), 2);
  Context context;
  const auto whole = searchOrbit(context, polygon, 8, 100'000);
  const auto part = searchOrbit(context, polygon, 8, 500);
  ASSERT_OK(whole);
  ASSERT_OK(part);
  EXPECT_LT(part->complete_to, 8);
  EXPECT_GT(part->complete_to, 6);
  EXPECT_LE(part->elements.size(), 1000);
  std::size_t within = 0;
  for (const Su11& g : whole->elements) within += displacement(g) <= part->complete_to ? 1 : 0;
  EXPECT_EQ(part->elements.size(), within);
}

TEST(OrbitSearch, EndsWhenCancelled) {
  const OrbitPolygon polygon = polygonOf(sampleGroup("bolza"), 2);
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(searchOrbit(context, polygon, 8, 100'000), FailsWith(Reason::kCancelled));
}

TEST(Axis, CarriesItsElementsGeometry) {
  const Su11 g = translation(std::polar(1.0, 0.3), std::polar(1.0, 2.1), 1.7);
  const Axis axis = axisOf(g);
  EXPECT_NEAR(std::asinh(sideOf(axis, 0.0)), signedDistanceToAxis(g), 1e-15);
  EXPECT_NEAR(product(axis, axis), 1, 1e-14);
  const Su11 move = translationTo({0.3, -0.4}) * rotation(1);
  const Axis moved = imageOf(move, axis);
  EXPECT_NEAR(std::abs(moved.space - axisOf(move * g * inverse(move)).space), 0, 1e-14);
  EXPECT_NEAR(sideOf(moved, imageOf(move, Complex(0.1, 0.2))), sideOf(axis, {0.1, 0.2}), 1e-14);
  // Diameters cross at their angle.
  const Su11 turn = rotation(0.7);
  EXPECT_NEAR(product(axisOf(translation(1)), axisOf(turn * translation(2) * inverse(turn))),
              std::cos(0.7), 1e-15);
  // The perpendicular at distance 0.8 along the diameter, 1.1 away.
  const Su11 there = translation(0.8) * rotation(kPi / 2) * translation(1.1) * rotation(kPi / 2);
  const Axis beside = axisOf(there * translation(1) * inverse(there));
  EXPECT_NEAR(footOnDiameter(beside), 0.8, 1e-14);
  EXPECT_NEAR(std::abs(product(beside, axisOf(translation(1)))), std::cosh(1.1), 1e-14);
}

}  // namespace
}  // namespace moduli
