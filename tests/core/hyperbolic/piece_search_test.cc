#include "core/hyperbolic/piece_search.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/hyperbolic/lifts.h"
#include "core/hyperbolic/pants.h"
#include "core/hyperbolic/polygon_copies.h"
#include "core/intrinsic/intrinsic_samples.h"
#include "tests/core/hyperbolic/sample_groups.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

std::vector<OrbitPolygon> polygons() {
  Context context;
  std::vector<OrbitPolygon> result;
  for (const int genus : {2, 3}) {
    result.push_back(*orbitPolygon(context, regularPolygonGroup(genus), genus));
    result.push_back(*orbitPolygon(
        context, holonomyGenerators(*makeIntrinsicSample(genus == 2 ? "bolza" : "klein")), genus));
  }
  const FenchelNielsen thin{2, {{0, 1, 2}, {3, 4, 5}}, {0.7, 0.4, 2.4}, {0.3, 0.1, 0.7}};
  const FenchelNielsen plain{2, {{0, 2, 4}, {1, 3, 5}}, {1.3, 2.2, 1.8}, {0.4, -0.5, 0.1}};
  for (const FenchelNielsen& coordinates : {thin, plain})
    result.push_back(*orbitPolygon(context, groupFromFenchelNielsen(coordinates)->generators, 2));
  return result;
}

TEST(PieceSearch, OfTheUncutSurfaceFindsEveryClosedGeodesic) {
  Context context;
  for (const OrbitPolygon& polygon : polygons()) {
    const double length = polygon.genus == 2 ? 4.5 : 5.3;
    const auto spectrum = lengthSpectrum(context, polygon, length);
    ASSERT_OK(spectrum);
    ASSERT_EQ(spectrum->complete_to, length);
    const auto cut = cutSurface(polygon, {});
    ASSERT_OK(cut);
    const auto disks = coverPieces(*cut, {});
    const auto found = searchPieces(context, polygon, *cut, disks, 0, length, 10'000'000);
    ASSERT_OK(found);
    ASSERT_TRUE(found->complete);
    std::vector<Axis> axes;
    for (const auto& pairings : found->elements) {
      const Su11 g = rounded(productOf(polygon, pairings));
      EXPECT_LE(translationLength(g), length * (1 + 1e-9));
      axes.push_back(axisOf(g));
    }
    EXPECT_FALSE(spectrum->geodesics.empty());
    // Among lifts of a geodesic some pass the polygon well inside, and must be there.
    for (const ClosedGeodesic& geodesic : spectrum->geodesics)
      for (const Axis& lift : axesAcross(polygon, geodesic.element))
        EXPECT_TRUE(!meetsPolygon(polygon, lift, -1e-3) ||
                    std::any_of(axes.begin(), axes.end(),
                                [&](const Axis& axis) { return sameAxis(axis, lift); }))
            << geodesic.length;
  }
}

TEST(PieceSearch, DisksCoverWhatIsNotInCollars) {
  std::mt19937 random(2);
  Context context;
  const FenchelNielsen given{2, {{0, 2, 4}, {1, 3, 5}}, {0.1, 2.2, 2.4}, {0.03, -0.5, 0.7}};
  const auto group = groupFromFenchelNielsen(given);
  ASSERT_OK(group);
  const auto polygon = orbitPolygon(context, group->generators, 2);
  ASSERT_OK(polygon);
  const Cuts cuts{{axesAcross(*polygon, carriedToPolygon(*polygon, group->curves[0]))}, {0.1}};
  const auto cut = cutSurface(*polygon, cuts);
  ASSERT_OK(cut);
  const auto disks = coverPieces(*cut, cuts);
  const double width = 1 / std::sinh(0.05);  // sinh of the collar's.
  std::uniform_real_distribution<double> uniform(0, 1);
  int inside = 0;
  for (int n = 0; n < 20000; ++n) {
    const std::size_t k = random() % polygon->corners.size();
    const Point p = pointAt(polygon->corners[k]);
    const Point q = pointAt(polygon->corners[(k + 1) % polygon->corners.size()]);
    const double s = uniform(random), t = uniform(random) * (1 - s);
    const Point x = normalized({s * p.time + t * q.time + (1 - s - t), s * p.space + t * q.space});
    const bool in_collar =
        std::any_of(cuts.lifts[0].begin(), cuts.lifts[0].end(),
                    [&](const Axis& axis) { return std::abs(sideOfPoint(axis, x)) < width; });
    const bool covered = std::any_of(disks.begin(), disks.end(), [&](const SearchDisk& disk) {
      return distanceOf(disk.centre, x) < disk.radius + 1e-9;
    });
    EXPECT_TRUE(covered || in_collar);
    inside += in_collar && !covered ? 1 : 0;
  }
  EXPECT_GT(inside, 100);
}

TEST(PieceSearch, SaysWhenItIsNotComplete) {
  Context context;
  const OrbitPolygon polygon = polygons()[0];
  const auto cut = cutSurface(polygon, {});
  ASSERT_OK(cut);
  const auto disks = coverPieces(*cut, {});
  const auto found = searchPieces(context, polygon, *cut, disks, 0, 4, 50);
  ASSERT_OK(found);
  EXPECT_FALSE(found->complete);
}

TEST(Lifts, AreTheConjugatesAcrossThePolygon) {
  Context context;
  for (const OrbitPolygon& polygon : polygons()) {
    if (reachesFar(polygon)) continue;
    const auto shortest = systoles(context, polygon);
    ASSERT_OK(shortest);
    for (const ClosedGeodesic& geodesic : shortest->geodesics) {
      const auto pairings = pairingsOf(polygon, geodesic.element);
      const WideSu11 exact = productOf(polygon, pairings);
      EXPECT_LT(distanceUpToSign(rounded(exact), geodesic.element), 1e-9);
      const auto lifts = liftsAcross(polygon, exact);
      const auto other = conjugatesAcross(polygon, geodesic.element, 0.05);
      ASSERT_EQ(lifts.size(), other.size());
      for (const Su11& g : other)
        EXPECT_TRUE(std::any_of(lifts.begin(), lifts.end(),
                                [&g](const Lift& lift) { return sameElement(lift.shape, g); }));
    }
  }
}

TEST(PolygonCopies, AreFoundAgainHoweverTheyAreReached) {
  Context context;
  const FenchelNielsen thin{2, {{0, 2, 4}, {1, 3, 5}}, {0.001, 2.2, 2.4}, {0.0003, -0.5, 0.7}};
  const auto polygon = orbitPolygon(context, groupFromFenchelNielsen(thin)->generators, 2);
  ASSERT_OK(polygon);
  EXPECT_TRUE(reachesFar(*polygon));
  PolygonCopies copies(*polygon, Su11{});
  // Around every corner: across its sides, one after the other, back to the first copy.
  const int n = static_cast<int>(polygon->sides.size());
  const auto partnerOf = [&](int side) {
    for (int k = 0; k < n; ++k)
      if (sameElement(polygon->pairings[polygon->sides[k]].map,
                      inverse(polygon->pairings[polygon->sides[side]].map)))
        return k;
    return -1;
  };
  for (int corner = 0; corner < n; ++corner) {
    std::int32_t copy = 0;
    int side = corner;
    for (int step = 0; step < 3; ++step) {
      copy = copies.beyond(copy, polygon->sides[side]);
      const int partner = partnerOf(side);
      ASSERT_GE(partner, 0);
      side = (partner + 1) % n;
    }
    EXPECT_EQ(copy, 0) << corner;
    EXPECT_EQ(side, corner);
  }
}

}  // namespace
}  // namespace moduli
