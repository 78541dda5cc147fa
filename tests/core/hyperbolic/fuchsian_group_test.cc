#include "core/hyperbolic/fuchsian_group.h"

#include <algorithm>
#include <random>

#include "core/intrinsic/chordal_metric.h"
#include "core/ricci/uniformize.h"
#include "tests/core/hyperbolic/groups.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

/// The shortest translation length among words of up to five letters that do not lead further than
/// 9 on the way, so that lengths are right to 1e-16 e^9: the systole, if the generators are short.
double shortestOfShortWords(const std::vector<Su11>& generators) {
  double shortest = 1e9;
  std::vector<std::pair<Su11, int>> words = {{Su11{}, 0}};
  const int n = static_cast<int>(generators.size());
  for (int round = 0; round < 5; ++round) {
    std::vector<std::pair<Su11, int>> longer;
    for (const auto& [g, last] : words) {
      for (int x = -n; x <= n; ++x) {
        if (x == 0 || x == -last) continue;
        const Su11& letter = generators[std::abs(x) - 1];
        const Su11 word = g * (x > 0 ? letter : inverse(letter));
        if (displacement(word) > 9) continue;
        longer.emplace_back(word, x);
        if (distanceToUnit(longer.back().first) < 1e-6) continue;
        shortest = std::min(shortest, translationLength(longer.back().first));
      }
    }
    words = std::move(longer);
  }
  return shortest;
}

/// Whether the point of the unit circle lies on the left of the axis.
bool isLeftOf(const Su11& g, Complex end) {
  const auto [repelling, attracting] = axisEnds(g);
  return std::imag(std::conj(attracting - repelling) * (end - repelling)) > 0;
}

/// A . B = 1: the axis of B passes that of A from right to left.
void expectCrossing(const Su11& a, const Su11& b) {
  const auto [repelling, attracting] = axisEnds(b);
  EXPECT_TRUE(isLeftOf(a, attracting));
  EXPECT_FALSE(isLeftOf(a, repelling));
}

void expectCanonical(const FuchsianGroup& group, std::size_t genus) {
  ASSERT_EQ(group.generators.size(), 2 * genus);
  EXPECT_LE(group.certificate.relation_residual, 1e-11);
  EXPECT_LE(group.certificate.moved, 1e-11);
  const Su11 word = evaluateWord(group.generators, canonicalRelation(genus));
  EXPECT_NEAR(word.a.real(), 1, 1e-9);
  EXPECT_LE(distanceToUnit(word), 1e-9);
  for (const Su11& g : group.generators) EXPECT_GT(translationLength(g), 1);
  for (std::size_t k = 0; k < genus; ++k) {
    expectCrossing(group.generators[2 * k], group.generators[2 * k + 1]);
  }
}

class PolygonGroup : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Genera, PolygonGroup, testing::Values(2, 3, 5));

TEST_P(PolygonGroup, SatisfiesTheRelationWithSignPlus) {
  const std::vector<Su11> group = polygonGroup(GetParam());
  const Su11 word = evaluateWord(group, canonicalRelation(GetParam()));
  // 4 g factors of size e^R / 2, products of up to e^R: some 1e-16 e^{2 R}.
  EXPECT_NEAR(word.a.real(), 1, 1e-10);
  EXPECT_LE(distanceToUnit(word), 1e-10);
  for (std::size_t k = 0; k < group.size(); k += 2) expectCrossing(group[k], group[k + 1]);
}

TEST_P(PolygonGroup, SurfaceGivesCanonicalGenerators) {
  const auto triangles = hyperbolicTriangles(polygonSurface(GetParam()));
  ASSERT_OK(triangles);
  Context context;
  const auto group = computeFuchsianGroup(context, *triangles);
  ASSERT_OK(group);
  expectCanonical(*group, GetParam());
}

TEST(FuchsianGroup, PolygonGroupsHaveTheirTraces) {
  for (const int g : {2, 3, 5}) {
    for (const Su11& generator : polygonGroup(g)) {
      const double expected = 2 + 2 * std::cos(std::numbers::pi / (2 * g));
      EXPECT_NEAR(std::abs(trace(generator)), expected, 1e-12);
    }
  }
}

struct Sample {
  const char* kind;
  std::size_t genus;
  double systole;
};
class Symmetric : public testing::TestWithParam<Sample> {};
INSTANTIATE_TEST_SUITE_P(Samples, Symmetric,
                         testing::Values(Sample{"bolza", 2, 3.05714183896200},
                                         Sample{"klein", 3, 3.93594624883033}));

TEST_P(Symmetric, GroupHasTheSystoleOfTheSurface) {
  Context context;
  const auto group = computeFuchsianGroup(context, regularSample(GetParam().kind));
  ASSERT_OK(group);
  expectCanonical(*group, GetParam().genus);
  EXPECT_NEAR(shortestOfShortWords(group->generators), GetParam().systole, 1e-10);
}

TEST_P(Symmetric, UniformizedChordalSurfaceHasTheSameSystole) {
  // Chords with the curvature bent out of the vertices again: the same discrete conformal class.
  const IntrinsicSurface surface = *makeIntrinsicSample(GetParam().kind);
  const auto chords = chordLengths(surface);
  ASSERT_OK(chords);
  Context context;
  UniformizeOptions options;
  options.initial_delaunay = false;
  const auto found = uniformize(context, surface.connectivity, *chords, options);
  ASSERT_OK(found);
  const auto triangles = hyperbolicTriangles(found->metric);
  ASSERT_OK(triangles);
  const auto group = computeFuchsianGroup(context, *triangles);
  ASSERT_OK(group);
  expectCanonical(*group, GetParam().genus);
  EXPECT_NEAR(shortestOfShortWords(group->generators), GetParam().systole, 1e-10);
}

TEST_P(Symmetric, AnotherRootAndAnotherCutConjugateTheGroup) {
  const HyperbolicTriangles triangles = regularSample(GetParam().kind);
  Context context;
  DevelopOptions options;
  for (const Index root : {0, 3, 7, 11}) {
    options.root = root;
    const auto group = computeFuchsianGroup(context, triangles, options);
    ASSERT_OK(group);
    expectCanonical(*group, GetParam().genus);
    EXPECT_NEAR(shortestOfShortWords(group->generators), GetParam().systole, 1e-10);
  }
}

TEST(FuchsianGroup, WordOfTheRelationIsThatOfTheFile) {
  EXPECT_EQ(canonicalRelation(2), (std::vector<int>{1, -2, -1, 2, 3, -4, -3, 4}));
}

}  // namespace
}  // namespace moduli
