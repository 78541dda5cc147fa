// Surfaces with a boundary in the Poincaré disk, and faces that have to be cut.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parameterize/hyperbolic.h"
#include "tests/core/parameterize/hyperbolic_surfaces.h"

namespace moduli {
namespace {

using testing::HasSubstr;

TEST(BorderedHyperbolicMap, OfAPairOfPantsOfHexagonsIsExact) {
  for (const std::array<double, 3>& cuffs :
       {std::array{2.0, 2.4, 3.0}, {1.5, 1.5, 1.5}, {3.5, 3.0, 2.5}}) {
    const IntrinsicSurface pants = hexagonPants(cuffs);
    const MetricSurface given = chordsOf(pants);
    for (const bool initial_delaunay : {true, false}) {
      HyperbolicOptions options;
      options.initial_delaunay = initial_delaunay;
      const auto map = mapped(given, options);
      ASSERT_OK(map);
      ASSERT_FALSE(map->subdivision);
      expectBorderedImage(given, *map);
      EXPECT_TRUE(map->certificate.warnings.empty());
      std::vector<double> lengths = map->hyperbolic->boundary_lengths;
      std::sort(lengths.begin(), lengths.end());
      std::vector<double> expected(cuffs.begin(), cuffs.end());
      std::sort(expected.begin(), expected.end());
      expectNear(lengths, expected, 1e-12);
      const DiskFaces disk{{given.surface, map->points, map->corner}, map->hyperbolic->neighbours};
      for (Index h = 0; h < given.surface.halfedgeCount(); ++h) {
        ASSERT_NEAR(disk.length(h), pants.lengths[given.surface.edge(h)], 1e-11);
      }
    }
  }
}

TEST(BorderedHyperbolicMap, LeavesTheBoundaryOutOfTheGeodesics) {
  // The double's shortest geodesics are the cuffs. Others in pants cross themselves: the shortest
  // is a figure of eight around two cuffs, cosh(l / 2) = 2 cosh(a / 2) cosh(b / 2) + cosh(c /
  // 2), 4.43 here.
  const auto map = mapped(chordsOf(hexagonPants({1.5, 1.5, 1.5})));
  ASSERT_OK(map);
  EXPECT_GE(*map->certificate.spectrum_complete_to, 2.25 - 1e-9);
  EXPECT_TRUE(map->hyperbolic->geodesics.empty());
}

TEST(BorderedHyperbolicMap, OfPlatesHasGeodesicSides) {
  for (const double holes : {2, 3}) {
    for (const double seed : {0, 4}) {
      const MetricSurface given =
          metricOfSample("plate", {{"holes", holes}, {"resolution", 3}, {"seed", seed}});
      const auto map = mapped(given);
      ASSERT_OK(map);
      expectBorderedImage(given, *map);
    }
  }
}

TEST(CutFaces, AreThoseOfAPlateWithEars) {
  // An ear has two sides on the boundary, which is straight: it has no area but for new vertices.
  const MetricSurface given = plateWithEars(5, 3, {{1, 1}, {3, 1}});
  HyperbolicOptions options;
  options.refine = false;
  const auto failed = mapped(given, options);
  EXPECT_THAT(failed, FailsWith(Reason::kFoldedMap));
  EXPECT_THAT(failed.status().message(), HasSubstr("2 of 26 faces"));
  EXPECT_THAT(failed.status().hint(), HasSubstr("--refine auto"));
  options.refine = true;
  const auto map = mapped(given, options);
  ASSERT_OK(map);
  ASSERT_TRUE(map->subdivision);
  EXPECT_GT(map->subdivision->faces.size(), 26U);
  expectBorderedImage(given, *map);
}

TEST(CutFaces, AreThoseOfShearedPlatesWithEars) {
  for (const double shear : {-1.0, 1.0}) {
    for (const double width : {1.0, 3.0}) {
      SCOPED_TRACE(testing::Message() << "shear " << shear << ", width " << width);
      const MetricSurface given = plateWithEars(5, 3, {{1, 1}, {3, 1}}, shear, width);
      const auto map = mapped(given);
      ASSERT_OK(map);
      EXPECT_TRUE(map->subdivision);
      expectBorderedImage(given, *map);
    }
  }
}

TEST(CutFaces, DoNotChangeLengthsFromWhereTheyAreNumbered) {
  const MetricSurface given = plateWithEars(6, 4, {{1, 1}, {3, 2}});
  const auto first = mapped(given), second = mapped(renumber(given, 3));
  ASSERT_OK(first);
  ASSERT_OK(second);
  for (const auto& map : {first, second}) EXPECT_TRUE(map->subdivision);
  expectBorderedImage(given, *first);
  auto sorted = [](std::vector<double> lengths) {
    std::sort(lengths.begin(), lengths.end());
    return lengths;
  };
  expectNear(sorted(second->hyperbolic->boundary_lengths),
             sorted(first->hyperbolic->boundary_lengths), 1e-8);
  expectNear(lengthsOf(*second), lengthsOf(*first), 1e-8);
}

}  // namespace
}  // namespace moduli
