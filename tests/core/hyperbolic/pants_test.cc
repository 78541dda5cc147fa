#include "core/hyperbolic/pants.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/hyperbolic/trigonometry.h"
#include "core/intrinsic/intrinsic_samples.h"
#include "tests/core/hyperbolic/sample_groups.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using PantsList = std::vector<std::array<int, 3>>;

template <typename Element>
OrbitPolygon polygonOf(const std::vector<Element>& generators, int genus) {
  Context context;
  auto polygon = orbitPolygon(context, generators, genus);
  EXPECT_OK(polygon);
  return polygon.ok() ? *polygon : OrbitPolygon{};
}

OrbitPolygon samplePolygon(const char* kind, int genus) {
  const auto surface = makeIntrinsicSample(kind);
  EXPECT_OK(surface);
  return polygonOf(holonomyGenerators(*surface), genus);
}

PantsGroup groupOf(const FenchelNielsen& coordinates) {
  const auto group = groupFromFenchelNielsen(coordinates);
  EXPECT_OK(group);
  return group.ok() ? *group : PantsGroup{};
}

std::vector<double> lengthsOf(const OrbitPolygon& polygon, double length) {
  Context context;
  const auto spectrum = lengthSpectrum(context, polygon, length);
  EXPECT_OK(spectrum);
  std::vector<double> lengths;
  if (spectrum.ok())
    for (const ClosedGeodesic& geodesic : spectrum->geodesics) lengths.push_back(geodesic.length);
  return lengths;
}

void expectNear(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

/// Every way of hanging pants together in genus 2, and some in genus 3 and 4.
std::vector<std::pair<int, PantsList>> patterns() {
  return {{2, {{0, 2, 4}, {1, 3, 5}}},
          {2, {{0, 1, 2}, {3, 4, 5}}},
          {3, {{0, 2, 4}, {1, 6, 8}, {3, 7, 10}, {5, 9, 11}}},
          {3, {{0, 1, 2}, {3, 4, 6}, {5, 7, 8}, {9, 10, 11}}},
          {3, {{0, 1, 2}, {3, 4, 6}, {5, 8, 9}, {7, 10, 11}}},
          {4, {{0, 1, 2}, {3, 4, 6}, {5, 8, 10}, {7, 9, 12}, {11, 13, 14}, {15, 16, 17}}}};
}

FenchelNielsen randomCoordinates(int genus, const PantsList& pants, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  FenchelNielsen coordinates{genus, pants, {}, {}};
  for (int i = 0; i < 3 * genus - 3; ++i) {
    coordinates.lengths.push_back(0.8 + 2 * uniform(random));
    coordinates.twists.push_back(coordinates.lengths[i] * (uniform(random) - 0.5));
  }
  return coordinates;
}

TEST(Twist, IsTakenModuloTheLength) {
  EXPECT_DOUBLE_EQ(normalizedTwist(0.3, 2), 0.3);
  EXPECT_DOUBLE_EQ(normalizedTwist(1, 2), -1);
  EXPECT_DOUBLE_EQ(normalizedTwist(-1, 2), -1);
  EXPECT_NEAR(normalizedTwist(1 - 1e-11, 2), -1, 1e-10);
  EXPECT_NEAR(normalizedTwist(-7.3, 2), 0.7, 1e-14);
}

TEST(FenchelNielsen, AreReadFromTheGroupMadeWithThem) {
  std::mt19937 random(5);
  Context context;
  for (const auto& [genus, pants] : patterns())
    for (int n = 0; n < 3; ++n) {
      const FenchelNielsen given = randomCoordinates(genus, pants, random);
      const PantsGroup group = groupOf(given);
      const OrbitPolygon polygon = polygonOf(group.generators, genus);
      std::vector<ClosedGeodesic> curves;
      for (const Su11& curve : group.curves) {
        const Su11 element = carriedToPolygon(polygon, curve);
        curves.push_back({translationLength(element), element, {}});
      }
      const auto reading = fenchelNielsen(context, polygon, curves);
      ASSERT_OK(reading);
      // Elements move 0 by up to 12, e^{12} 1e-16, and are products of some ten.
      EXPECT_LT(reading->seam_error, 1e-8);
      EXPECT_EQ(reading->coordinates.pants, given.pants);
      expectNear(reading->coordinates.lengths, given.lengths, 1e-8);
      expectNear(reading->coordinates.twists, given.twists, 1e-8);
    }
}

TEST(FenchelNielsen, OfTheShortestPantsMakeTheSameSpectrum) {
  std::mt19937 random(11);
  Context context;
  std::vector<std::pair<OrbitPolygon, double>> cases{{samplePolygon("bolza", 2), 5.9},
                                                     {samplePolygon("klein", 3), 5.3},
                                                     {polygonOf(regularPolygonGroup(2), 2), 5},
                                                     {polygonOf(regularPolygonGroup(3), 3), 5.4}};
  for (const auto& [genus, pants] : patterns()) {
    const PantsGroup group = groupOf(randomCoordinates(genus, pants, random));
    cases.emplace_back(polygonOf(group.generators, genus), 5);
  }
  for (const auto& [polygon, length] : cases) {
    const auto pants = pantsDecomposition(context, polygon);
    ASSERT_OK(pants);
    EXPECT_LT(pants->seam_error, 1e-8);
    const PantsGroup group = groupOf(pants->coordinates);
    const std::vector<double> lengths = lengthsOf(polygon, length);
    EXPECT_GT(lengths.size(), 3);
    expectNear(lengthsOf(polygonOf(group.generators, polygon.genus), length), lengths, 1e-8);
  }
}

TEST(FenchelNielsen, WholeTurnsAndMirrorImagesKeepTheSpectrum) {
  std::mt19937 random(3);
  for (const auto& [genus, pants] : patterns()) {
    const FenchelNielsen given = randomCoordinates(genus, pants, random);
    const auto spectrum = [g = genus](const FenchelNielsen& coordinates) {
      return lengthsOf(polygonOf(groupOf(coordinates).generators, g), 5);
    };
    const std::vector<double> lengths = spectrum(given);
    FenchelNielsen turned = given;
    turned.twists[0] += given.lengths[0];
    expectNear(spectrum(turned), lengths, 1e-8);
    FenchelNielsen mirrored = given;
    for (double& twist : mirrored.twists) twist = -twist;
    expectNear(spectrum(mirrored), lengths, 1e-8);
  }
}

TEST(FenchelNielsen, AnotherTwistIsAnotherSurface) {
  const FenchelNielsen given{2, {{0, 2, 4}, {1, 3, 5}}, {2, 2.2, 2.4}, {0.3, -0.5, 0.7}};
  const auto spectrum = [](const FenchelNielsen& coordinates) {
    return lengthsOf(polygonOf(groupOf(coordinates).generators, 2), 5.5);
  };
  const std::vector<double> lengths = spectrum(given);
  for (int i = 0; i < 3; ++i) {
    FenchelNielsen twisted = given;
    twisted.twists[i] += 0.2;
    const std::vector<double> other = spectrum(twisted);
    double change = other.size() == lengths.size() ? 0 : 1;
    for (std::size_t k = 0; k < std::min(other.size(), lengths.size()); ++k)
      change = std::max(change, std::abs(other[k] - lengths[k]));
    EXPECT_GT(change, 0.01) << i;
  }
}

TEST(FenchelNielsen, ShortCurvesKeepTheirLengthsAndTwists) {
  Context context;
  for (const double l : {0.3, 0.1, 0.01, 0.001}) {
    const FenchelNielsen given{2, {{0, 2, 4}, {1, 3, 5}}, {l, 2.2, 2.4}, {0.3 * l, -0.5, 0.7}};
    const OrbitPolygon polygon = polygonOf(groupOf(given).generators, 2);
    const auto pants = pantsDecomposition(context, polygon);
    ASSERT_OK(pants);
    // The half trace of elements that reach to distance r is right to 1e-16 e^{r} and moves the
    // length by that over l / 2.
    const double tolerance = 1e-15 * std::exp(polygon.radius + 4) / l;
    expectNear(pants->coordinates.lengths, given.lengths, tolerance);
    EXPECT_NEAR(pants->coordinates.twists[0], given.twists[0], 1e-8);
  }
}

TEST(FenchelNielsen, ASeamThatClosesIsAGeodesicOfItsLength) {
  // A handle whose own cuff is twisted by half its length: the seam from the cuff to itself meets
  // itself at a right angle to the cuff, and is smooth there.
  const FenchelNielsen coordinates{2, {{0, 1, 2}, {3, 4, 5}}, {1.9, 2.3, 2.1}, {-0.95, 0.4, 0.3}};
  const auto seams = pantsSeams({1.9, 1.9, 2.3});
  ASSERT_OK(seams);
  const std::vector<double> lengths =
      lengthsOf(polygonOf(groupOf(coordinates).generators, 2), (*seams)[2] + 0.1);
  double nearest = 1;
  for (const double length : lengths) nearest = std::min(nearest, std::abs(length - (*seams)[2]));
  EXPECT_LT(nearest, 1e-10);
}

TEST(PantsDecomposition, OfBolzasSurfaceConsistsOfShortestGeodesics) {
  Context context;
  const auto pants = pantsDecomposition(context, samplePolygon("bolza", 2));
  ASSERT_OK(pants);
  for (const double length : pants->coordinates.lengths)
    EXPECT_NEAR(length, 2 * std::acosh(1 + std::sqrt(2.0)), 1e-10);
}

TEST(PantsDecomposition, CurvesAreSimpleAndDisjoint) {
  Context context;
  const OrbitPolygon polygon = polygonOf(regularPolygonGroup(3), 3);
  const auto pants = pantsDecomposition(context, polygon);
  ASSERT_OK(pants);
  ASSERT_EQ(pants->curves.size(), 6);
  for (const ClosedGeodesic& x : pants->curves)
    for (const ClosedGeodesic& y : pants->curves)
      EXPECT_FALSE(anyCross(axesAcross(polygon, x.element), axesAcross(polygon, y.element)));
}

TEST(PantsDecomposition, SidePairingsOfARegularPolygonCrossOnceEach) {
  // a1 and b1 of the word a1 b1 a1^-1 b1^-1 a2 .. meet, a1 and a2 do not; a1 b1 b1 meets itself
  // not, the commutator of a1 and a2 does.
  const std::vector<Su11> generators = regularPolygonGroup(2);
  const OrbitPolygon polygon = polygonOf(generators, 2);
  const auto axes = [&](const Word& word) {
    return axesAcross(polygon, carriedToPolygon(polygon, elementOfWord(generators, word)));
  };
  EXPECT_TRUE(anyCross(axes({1}), axes({2})));
  EXPECT_FALSE(anyCross(axes({1}), axes({1})));
  EXPECT_FALSE(anyCross(axes({1}), axes({3})));
  EXPECT_FALSE(anyCross(axes({1, 2, 2}), axes({1, 2, 2})));
  EXPECT_TRUE(anyCross(axes({1, 3, -1, -3}), axes({1, 3, -1, -3})));
}

TEST(PantsDecomposition, ACommutatorsTraceIsThatOfItsTorus) {
  // tr [A, B] = x^2 + y^2 + z^2 - x y z - 2 of the traces x, y, z of A, B, A B.
  const std::vector<Su11> generators = regularPolygonGroup(2);
  const Su11 a = generators[0];
  const Su11 b = generators[1];
  const double x = trace(a), y = trace(b), z = trace(a * b);
  EXPECT_NEAR(trace(a * b * inverse(a) * inverse(b)), x * x + y * y + z * z - x * y * z - 2, 1e-11);
}

TEST(PantsDecomposition, SaysWhereTheBudgetEnds) {
  Context context;
  EXPECT_THAT(
      pantsDecomposition(context, polygonOf(regularPolygonGroup(3), 3), {.most_parts = 300}),
      FailsWith(Reason::kNoConvergence));
}

TEST(FenchelNielsen, RefusesCurvesThatCross) {
  Context context;
  const OrbitPolygon polygon = samplePolygon("bolza", 2);
  const auto shortest = systoles(context, polygon);
  ASSERT_OK(shortest);
  auto curves = shortest->geodesics;
  EXPECT_THAT(fenchelNielsen(context, polygon, curves), FailsWith(Reason::kInvalidOption));
  const auto pants = pantsDecomposition(context, polygon);
  ASSERT_OK(pants);
  const std::vector<ClosedGeodesic> twice{pants->curves[0], pants->curves[0], pants->curves[1]};
  EXPECT_THAT(fenchelNielsen(context, polygon, twice), FailsWith(Reason::kInvalidOption));
}

TEST(FenchelNielsen, RefusesPantsThatDoNotFit) {
  const FenchelNielsen good{2, {{0, 2, 4}, {1, 3, 5}}, {1, 1, 1}, {0, 0, 0}};
  EXPECT_OK(groupFromFenchelNielsen(good));
  FenchelNielsen bad = good;
  bad.genus = 3;
  EXPECT_THAT(groupFromFenchelNielsen(bad), FailsWith(Reason::kInvalidOption));
  bad = good;
  bad.pants[0][0] = 1;
  EXPECT_THAT(groupFromFenchelNielsen(bad), FailsWith(Reason::kInvalidOption));
  bad = good;
  bad.lengths[1] = 0;
  EXPECT_THAT(groupFromFenchelNielsen(bad), FailsWith(Reason::kInvalidOption));
  bad = good;
  bad.twists[1] = std::nan("");
  EXPECT_THAT(groupFromFenchelNielsen(bad), FailsWith(Reason::kInvalidOption));
  // Genus 3 of two surfaces of four pants that do not hang together.
  const FenchelNielsen apart{
      3, {{0, 2, 4}, {1, 3, 5}, {6, 8, 10}, {7, 9, 11}}, {1, 1, 1, 1, 1, 1}, {0, 0, 0, 0, 0, 0}};
  EXPECT_THAT(groupFromFenchelNielsen(apart), FailsWith(Reason::kInvalidOption));
}

}  // namespace
}  // namespace moduli
