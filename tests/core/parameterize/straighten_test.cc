#include "core/parameterize/straighten.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/core/hyperbolic/groups.h"
#include "tests/core/parameterize/hyperbolic_surfaces.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

/// Unfolded triangles that fill the surface, with twins of one length.
void expectWhole(const StraightSurface& straight) {
  const Connectivity& surface = straight.triangles.surface;
  const std::vector<double>&lengths = straight.triangles.lengths,
        &angles = straight.triangles.angles;
  EXPECT_EQ(straight.folded, 0);
  std::vector<double> sums(surface.vertexCount(), 0.0);
  double area = 0;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    ASSERT_GT(angles[h], 0);
    sums[surface.tail(h)] += angles[h];
    if (surface.twin(h) != kNone) {
      ASSERT_EQ(lengths[h], lengths[surface.twin(h)]);
    }
  }
  for (Index f = 0; f < surface.faceCount(); ++f) {
    area += triangleArea(Geometry::kHyperbolic,
                         {lengths[3 * f], lengths[3 * f + 1], lengths[3 * f + 2]});
  }
  EXPECT_NEAR(area, -2 * kPi * surface.eulerCharacteristic(), 1e-9);
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    ASSERT_NEAR(sums[v], surface.isBoundaryVertex(v) ? kPi : 2 * kPi, 1e-9) << "vertex " << v;
  }
}

TEST(Straighten, TakesTheFacesAsTheyAre) {
  const MetricSurface given = metricOfSample("genus", {{"genus", 2}, {"resolution", 4}});
  const Uniformization found = uniformized(given);
  const StraightSurface straight = straighten(given.surface, found);
  const StraightFaces faces = straightFaces(found.metric);
  EXPECT_EQ(straight.triangles.lengths, faces.lengths);
  EXPECT_EQ(straight.triangles.angles, faces.angles);
  EXPECT_FALSE(straight.subdivision);
  expectWhole(straight);
}

TEST(Straighten, TakesOneCopyOfADouble) {
  const MetricSurface given = metricOfSample("plate", {{"holes", 2}, {"resolution", 2}});
  const StraightSurface straight = straighten(given.surface, uniformized(given));
  EXPECT_EQ(straight.triangles.surface.faces(), given.surface.faces());
  expectWhole(straight);
}

TEST(Straighten, CountsFolds) {
  const MetricSurface given = plateWithEars(5, 3, {{1, 1}, {3, 1}});
  EXPECT_EQ(straighten(given.surface, uniformized(given)).folded, 2);
}

TEST(StraightenRefined, CutsFoldedFacesAndFillsTheSurface) {
  Context context;
  for (const MetricSurface& given :
       {plateWithEars(5, 3, {{1, 1}, {3, 1}}), plateWithEars(7, 5, {{1, 1}, {2, 1}, {4, 3}}),
        subdivide(plateWithEars(5, 3, {{1, 1}, {3, 1}}), 2)}) {
    for (const bool initial_delaunay : {true, false}) {
      const Uniformization found = uniformized(given, initial_delaunay);
      ASSERT_GT(straighten(given.surface, found).folded, 0);
      const auto straight = straightenRefined(context, given.surface, found);
      ASSERT_OK(straight);
      ASSERT_TRUE(straight->subdivision);
      expectWhole(*straight);
      expectCutFaces(given, *straight->subdivision);
      std::cout << given.surface.faceCount() << " faces in " << straight->subdivision->faces.size()
                << "\n";
    }
  }
}

TEST(StraightenRefined, CutsNothingWhereNothingFolds) {
  Context context;
  const MetricSurface given = metricOfSample("genus", {{"genus", 2}, {"resolution", 4}});
  const auto straight = straightenRefined(context, given.surface, uniformized(given));
  ASSERT_OK(straight);
  EXPECT_TRUE(straight->subdivision->vertices.empty());
  expectWhole(*straight);
}

TEST(StraightenRefined, StopsWhenCancelled) {
  const MetricSurface given = plateWithEars(5, 3, {{1, 1}, {3, 1}});
  const Uniformization found = uniformized(given);
  CancelToken token;
  token.cancel();
  Context context;
  context.setCancelToken(token);
  EXPECT_THAT(straightenRefined(context, given.surface, found), FailsWith(Reason::kCancelled));
}

TEST(SplitStraight, PutsVerticesEvenlyOnStraightEdges) {
  const MetricSurface given = metricOfSample("genus", {{"genus", 2}, {"resolution", 4}});
  const StraightSurface whole = straighten(given.surface, uniformized(given));
  std::vector<int> counts(given.surface.edgeCount(), 0);
  for (std::size_t e = 0; e < counts.size(); e += 3) counts[e] = static_cast<int>(e % 4);
  const auto split = splitStraight(whole.triangles, counts);
  ASSERT_OK(split);
  expectWhole(*split);
  ASSERT_TRUE(split->subdivision);
  expectCutFaces(given, *split->subdivision);
  const Connectivity& surface = split->triangles.surface;
  const auto edgeOf = [&](Index v) {
    const Index fresh = v - given.surface.vertexCount();
    return fresh < 0 ? kNone : given.surface.edge(split->subdivision->vertices[fresh].halfedge);
  };
  std::vector<int> pieces(given.surface.edgeCount(), 0);
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const Index e = edgeOf(surface.tail(h));
    if (e == kNone || edgeOf(surface.head(h)) != e) continue;
    const double length = whole.triangles.lengths[given.surface.halfedge(e)];
    EXPECT_NEAR(split->triangles.lengths[h], length / (counts[e] + 1), 1e-12);
    ++pieces[e];
  }
  for (Index e = 0; e < given.surface.edgeCount(); ++e) {
    EXPECT_EQ(pieces[e], 2 * std::max(0, counts[e] - 1));
  }
}

TEST(SplitStraight, RefusesFacesWithAVertexTwice) {
  const auto triangles = hyperbolicTriangles(polygonSurface(2));
  ASSERT_OK(triangles);
  const std::vector<int> counts(triangles->surface.edgeCount(), 1);
  const auto split = splitStraight(*triangles, counts);
  EXPECT_THAT(split, FailsWith(Reason::kFoldedMap));
  EXPECT_THAT(split.status().message(), testing::HasSubstr("face 0 has a vertex twice"));
}

/// A plate one of whose sides bears vertices so close behind a diagonal that...
TEST(HyperbolicMap, CutsNeedlesThatOnlyTheirImagesTurnOver) {
  // A vertex just off an edge: its three geodesic triangles are sound, but the disk's chords pass
  // on its other side.
  int found = 0;
  for (const double height : {0.02, 0.01, 0.005}) {
    const MetricSurface given =
        insertNearEdges(metricOfSample("genus", {{"genus", 3}, {"resolution", 1}}), height, 1);
    HyperbolicOptions options;
    const StraightSurface straight = straighten(given.surface, uniformized(given));
    options.refine = false;
    const auto refused = mapped(given, options);
    const auto map = mapped(given);
    std::cout << "height " << height << ": " << straight.folded << " folds, "
              << refused.status().message() << ", " << map.status().toString() << "\n";
    if (straight.folded != 0 || refused.ok()) continue;
    ++found;
    EXPECT_THAT(refused, FailsWith(Reason::kFoldedMap));
    ASSERT_OK(map);
    ASSERT_TRUE(map->subdivision);
    expectClosedDomain(given, *map);
    expectCutFaces(given, *map->subdivision);
  }
  EXPECT_GT(found, 0);
}

}  // namespace
}  // namespace moduli
