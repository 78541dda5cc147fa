#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "core/hyperbolic/cut_surface.h"
#include "core/hyperbolic/pants.h"
#include "core/intrinsic/intrinsic_samples.h"
#include "tests/core/hyperbolic/sample_groups.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using testing::HasSubstr;
using PantsList = std::vector<std::array<int, 3>>;

/// Pants put together at random until they hang together.
FenchelNielsen randomSurface(int genus, double shortest, double longest, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  FenchelNielsen coordinates{genus, {}, {}, {}};
  for (int i = 0; i < 3 * genus - 3; ++i) {
    coordinates.lengths.push_back(shortest + (longest - shortest) * uniform(random));
    coordinates.twists.push_back(coordinates.lengths[i] * (uniform(random) - 0.5));
  }
  std::vector<int> sides(6 * genus - 6);
  std::iota(sides.begin(), sides.end(), 0);
  do {
    std::shuffle(sides.begin(), sides.end(), random);
    coordinates.pants.clear();
    for (std::size_t p = 0; p < sides.size(); p += 3) {
      std::array<int, 3> pants{sides[p], sides[p + 1], sides[p + 2]};
      std::sort(pants.begin(), pants.end());
      coordinates.pants.push_back(pants);
    }
  } while (!groupFromFenchelNielsen(coordinates).ok());
  return coordinates;
}

Result<OrbitPolygon> polygonOf(const FenchelNielsen& coordinates) {
  Context context;
  ASSIGN_OR_RETURN(const PantsGroup group, groupFromFenchelNielsen(coordinates));
  return orbitPolygon(context, group.generators, coordinates.genus);
}

std::vector<double> lengthsOf(const LengthSpectrum& spectrum) {
  std::vector<double> lengths;
  for (const ClosedGeodesic& geodesic : spectrum.geodesics) lengths.push_back(geodesic.length);
  return lengths;
}

void expectNear(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

TEST(PantsDecomposition, OfRandomSurfacesMakesTheSameSpectrum) {
  std::mt19937 random(7);
  Context context;
  for (int genus = 2; genus <= 8; ++genus) {
    SCOPED_TRACE(genus);
    const FenchelNielsen given = randomSurface(genus, 0.5, 3.5, random);
    const auto polygon = polygonOf(given);
    ASSERT_OK(polygon);
    const auto pants = pantsDecomposition(context, *polygon);
    ASSERT_OK(pants);
    // Polygons reach to distance 7: e^14 1e-16, over seams of some 0.1.
    EXPECT_LT(pants->seam_error, 1e-8);
    // No curve of the given ones is shorter than the first chosen, which is a systole.
    const auto shortest = systoles(context, *polygon);
    ASSERT_OK(shortest);
    EXPECT_NEAR(pants->curves[0].length, shortest->geodesics[0].length, 1e-9);
    const auto again = polygonOf(pants->coordinates);
    ASSERT_OK(again);
    const double length = std::max(2.0, 1.3 * shortest->geodesics[0].length);
    const auto first = lengthSpectrum(context, *polygon, length);
    const auto second = lengthSpectrum(context, *again, length);
    ASSERT_OK(first);
    ASSERT_OK(second);
    ASSERT_EQ(first->complete_to, length);
    expectNear(lengthsOf(*second), lengthsOf(*first), 1e-7);
  }
}

/// The greedy choice from the spectrum of the whole surface.
std::vector<double> greedyTwin(const OrbitPolygon& polygon, double length) {
  Context context;
  const auto spectrum = lengthSpectrum(context, polygon, length);
  EXPECT_OK(spectrum);
  EXPECT_EQ(spectrum->complete_to, length);
  std::vector<double> lengths;
  std::vector<Axis> chosen;
  for (const ClosedGeodesic& geodesic : spectrum->geodesics) {
    const std::vector<Axis> axes = axesAcross(polygon, geodesic.element);
    if (anyCross(axes, axes) || anyCross(axes, chosen)) continue;
    chosen.insert(chosen.end(), axes.begin(), axes.end());
    lengths.push_back(geodesic.length);
  }
  return lengths;
}

TEST(PantsDecomposition, IsTheGreedyChoiceFromTheWholeSpectrum) {
  std::mt19937 random(19);
  Context context;
  for (const int genus : {2, 2, 2, 3, 3, 3, 4, 4}) {
    SCOPED_TRACE(genus);
    const auto polygon = polygonOf(randomSurface(genus, 0.3, 2.5, random));
    ASSERT_OK(polygon);
    const auto pants = pantsDecomposition(context, *polygon);
    ASSERT_OK(pants);
    const std::vector<double>& lengths = pants->coordinates.lengths;
    EXPECT_TRUE(std::is_sorted(lengths.begin(), lengths.end()));
    expectNear(greedyTwin(*polygon, lengths.back() + 0.01), lengths, 1e-8);
  }
}

TEST(PantsDecomposition, WordsAreThoseOfTheElements) {
  const std::vector<Su11> generators = regularPolygonGroup(3);
  Context context;
  const auto polygon = orbitPolygon(context, generators, 3);
  ASSERT_OK(polygon);
  const auto pants = pantsDecomposition(context, *polygon);
  ASSERT_OK(pants);
  for (const ClosedGeodesic& curve : pants->curves) {
    EXPECT_NEAR(translationLength(curve.element), curve.length, 1e-12);
    EXPECT_LT(distanceUpToSign(elementOfWord(generators, curve.word),
                               inGivenCoordinates(*polygon, curve.element)),
              1e-8);
  }
}

TEST(PantsDecomposition, NamesThePiecesThatTheBudgetLeaves) {
  std::mt19937 random(7);
  Context context;
  const auto polygon = polygonOf(randomSurface(3, 0.5, 3.5, random));
  ASSERT_OK(polygon);
  const auto all = pantsDecomposition(context, *polygon);
  ASSERT_OK(all);
  const auto none = pantsDecomposition(context, *polygon, {.most_parts = 10});
  EXPECT_THAT(none, FailsWith(Reason::kNoConvergence));
  EXPECT_THAT(none.status().message(), HasSubstr("only 0 of 6 curves"));
  EXPECT_THAT(none.status().message(), HasSubstr("6 in a piece of genus 3 with 0 cuffs"));
}

TEST(PantsDecomposition, StopsWhenItIsCancelled) {
  std::mt19937 random(7);
  const auto polygon = polygonOf(randomSurface(2, 0.5, 3.5, random));
  ASSERT_OK(polygon);
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(pantsDecomposition(context, *polygon), FailsWith(Reason::kCancelled));
}

/// Surfaces with a cuff of length l in the middle, between two handles, or at a handle.
struct Thin {
  const char* name;
  FenchelNielsen coordinates;
};

std::vector<Thin> thinSurfaces(double l) {
  return {{"one of three", {2, {{0, 2, 4}, {1, 3, 5}}, {l, 2.2, 2.4}, {0.3 * l, -0.5, 0.7}}},
          {"separating", {2, {{0, 1, 2}, {3, 4, 5}}, {2.1, l, 2.4}, {0.3, 0.2 * l, 0.7}}},
          {"a handle's", {2, {{0, 1, 2}, {3, 4, 5}}, {l, 2, 2.4}, {0.3 * l, 0.2, 0.7}}},
          {"genus 3",
           {3,
            {{0, 2, 4}, {1, 6, 8}, {3, 7, 10}, {5, 9, 11}},
            {l, 2, 2.2, 1.8, 2.5, 2.1},
            {0.3 * l, 0.2, -0.4, 0.5, 0.6, 0.7}}},
          {"two handles'",
           {3,
            {{0, 1, 2}, {3, 4, 6}, {5, 7, 8}, {9, 10, 11}},
            {l, 2, 2.2, 1.8, 2.5, 2 * l},
            {0.3 * l, 0.2, -0.4, 0.5, 0.6, 0.7 * l}}}};
}

TEST(PantsDecomposition, HoldsAcrossThinCollars) {
  Context context;
  for (const double l : {0.03, 0.001})
    for (const Thin& thin : thinSurfaces(l)) {
      SCOPED_TRACE(std::string(thin.name) + " " + std::to_string(l));
      const auto polygon = polygonOf(thin.coordinates);
      ASSERT_OK(polygon);
      EXPECT_GT(polygon->radius, std::log(4 / l));
      EXPECT_EQ(polygon->sides.size(), polygon->corners.size());
      EXPECT_EQ(polygon->sides.size(), static_cast<std::size_t>(12 * polygon->genus - 6));
      const auto shortest = systoles(context, *polygon);
      ASSERT_OK(shortest);
      // sinh(l / 2)^2 of elements that move 0 by at most 4 is right to 1e-15.
      EXPECT_NEAR(shortest->geodesics[0].length, l, 1e-14 / l);
      const auto pants = pantsDecomposition(context, *polygon);
      ASSERT_OK(pants);
      EXPECT_LT(pants->seam_error, 1e-7);
      EXPECT_NEAR(pants->curves[0].length, l, 1e-14 / l);
      const std::vector<double>& given = thin.coordinates.lengths;
      EXPECT_LE(std::accumulate(pants->coordinates.lengths.begin(),
                                pants->coordinates.lengths.end(), 0.0),
                std::accumulate(given.begin(), given.end(), 0.0) + 1e-7);
      if (l < 0.01) continue;
      const auto again = polygonOf(pants->coordinates);
      ASSERT_OK(again);
      const auto first = pantsDecomposition(context, *again);
      ASSERT_OK(first);
      // A foot that is off by the seam's error.
      expectNear(first->coordinates.lengths, pants->coordinates.lengths, 1e-6);
    }
}

TEST(PantsDecomposition, TwistsAcrossAThinCollarAreThoseGiven) {
  Context context;
  for (const double l : {0.01, 0.001}) {
    const FenchelNielsen given = thinSurfaces(l)[0].coordinates;
    const auto polygon = polygonOf(given);
    ASSERT_OK(polygon);
    const auto pants = pantsDecomposition(context, *polygon);
    ASSERT_OK(pants);
    expectNear(pants->coordinates.lengths, given.lengths, 1e-8);
    EXPECT_NEAR(pants->coordinates.twists[0], given.twists[0], 1e-4 * l);
    EXPECT_NEAR(pants->coordinates.twists[1], given.twists[1], 1e-6);
    EXPECT_NEAR(pants->coordinates.twists[2], given.twists[2], 1e-6);
  }
}

TEST(OrbitPolygon, NamesTheCollarThatIsTooLong) {
  for (const double l : {0.01, 0.001})
    for (const PantsList& list :
         {PantsList{{0, 2, 4}, {1, 3, 5}}, PantsList{{0, 1, 2}, {3, 4, 5}}}) {
      const auto polygon =
          polygonOf({2, list, {l, 1.3 * l, 1.7 * l}, {0.1 * l, 0.2 * l, -0.3 * l}});
      EXPECT_THAT(polygon, FailsWith(Reason::kResidualTooLarge));
      EXPECT_THAT(polygon.status().message(), HasSubstr("the collar of a closed geodesic"));
    }
}

Cuts cutsOf(const OrbitPolygon& polygon, const std::vector<Su11>& elements) {
  Cuts cuts;
  for (const Su11& g : elements) {
    cuts.lifts.push_back(axesAcross(polygon, carriedToPolygon(polygon, g)));
    cuts.lengths.push_back(translationLength(g));
  }
  return cuts;
}

TEST(CutSurface, PiecesHaveTheTopologyOfThePantsLeft) {
  // Pants 0 and 1 are handles, each with one cuff (curves 1 and 2) towards pants 2 and 3, which
  // meet in curves 3 and 4.
  const FenchelNielsen given{3,
                             {{0, 1, 2}, {4, 10, 11}, {3, 6, 8}, {5, 7, 9}},
                             {1, 1.4, 1.7, 2, 1.9, 1.2},
                             {0.1, 0.2, -0.3, 0.4, 0.5, 0}};
  const auto group = groupFromFenchelNielsen(given);
  ASSERT_OK(group);
  Context context;
  const auto polygon = orbitPolygon(context, group->generators, 3);
  ASSERT_OK(polygon);
  const Cuts all = cutsOf(*polygon, group->curves);
  struct Expected {
    std::vector<int> curves;
    std::vector<std::pair<int, int>> pieces;  ///< Genus and number of cuffs, ascending.
  };
  const Expected cases[] = {{{}, {{3, 0}}},
                            {{0}, {{2, 2}}},
                            {{1}, {{1, 1}, {2, 1}}},
                            {{1, 2}, {{1, 1}, {1, 1}, {1, 2}}},
                            {{3, 4}, {{1, 2}, {1, 2}}},
                            {{3}, {{2, 2}}},
                            {{0, 1, 2, 5}, {{0, 3}, {0, 3}, {1, 2}}},
                            {{0, 1, 2, 3, 4, 5}, {{0, 3}, {0, 3}, {0, 3}, {0, 3}}}};
  for (const Expected& expected : cases) {
    Cuts cuts;
    for (const int i : expected.curves) {
      cuts.lifts.push_back(all.lifts[i]);
      cuts.lengths.push_back(all.lengths[i]);
    }
    const auto cut = cutSurface(*polygon, cuts);
    ASSERT_OK(cut);
    std::vector<std::pair<int, int>> pieces;
    int missing = 0;
    for (const SurfacePiece& piece : cut->pieces) {
      pieces.emplace_back(piece.genus, static_cast<int>(piece.cuffs.size()));
      missing += piece.missing();
    }
    std::sort(pieces.begin(), pieces.end());
    EXPECT_EQ(pieces, expected.pieces);
    EXPECT_EQ(missing + static_cast<int>(cuts.lifts.size()), 6);
  }
}

TEST(CutSurface, RefusesAGeodesicThatLacksAnAxis) {
  std::mt19937 random(3);
  const auto group = groupFromFenchelNielsen(randomSurface(3, 0.8, 2.5, random));
  ASSERT_OK(group);
  Context context;
  const auto polygon = orbitPolygon(context, group->generators, 3);
  ASSERT_OK(polygon);
  Cuts cuts = cutsOf(*polygon, group->curves);
  ASSERT_OK(cutSurface(*polygon, cuts));
  // Without the axis that is nearest to 0 the pieces beside it hang together.
  for (auto& axes : cuts.lifts) {
    const std::vector<Axis> whole = axes;
    std::erase_if(axes, [&whole](const Axis& axis) {
      return std::all_of(whole.begin(), whole.end(), [&axis](const Axis& other) {
        return std::abs(axis.time) <= std::abs(other.time);
      });
    });
    EXPECT_THAT(cutSurface(*polygon, cuts), FailsWith(Reason::kResidualTooLarge));
    axes = whole;
  }
}

TEST(CutSurface, CutsAlongSidesOfThePolygon) {
  // The regular octagon with opposite sides glued: sides and short diagonals lie on geodesics.
  const auto surface = makeIntrinsicSample("bolza");
  ASSERT_OK(surface);
  Context context;
  const auto polygon = orbitPolygon(context, holonomyGenerators(*surface), 2);
  ASSERT_OK(polygon);
  const auto shortest = systoles(context, *polygon);
  ASSERT_OK(shortest);
  for (const ClosedGeodesic& systole : shortest->geodesics) {
    const auto cut =
        cutSurface(*polygon, {{axesAcross(*polygon, systole.element)}, {systole.length}});
    ASSERT_OK(cut);
    int missing = 0;
    for (const SurfacePiece& piece : cut->pieces) missing += piece.missing();
    EXPECT_EQ(missing, 2);
  }
}

}  // namespace
}  // namespace moduli
