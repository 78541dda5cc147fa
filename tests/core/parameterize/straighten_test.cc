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
        subdivide(plateWithEars(5, 3, {{1, 1}, {3, 1}}), 2),
        plateWithEars(5, 3, {{1, 1}, {3, 1}}, -1), plateWithEars(5, 3, {{1, 1}, {3, 1}}, 1, 3)}) {
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
  const auto split = splitStraight(whole, counts);
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
  const auto split = splitStraight({*triangles}, counts);
  EXPECT_THAT(split, FailsWith(Reason::kFoldedMap));
  EXPECT_THAT(split.status().message(), testing::HasSubstr("face 0 has a vertex twice"));
}

TEST(SplitStraight, CutsPartsOfBentEdges) {
  const MetricSurface given = plateWithEars(7, 5, {{1, 1}, {2, 1}, {4, 3}});
  Context context;
  const auto refined = straightenRefined(context, given.surface, uniformized(given));
  ASSERT_OK(refined);
  const std::size_t before = refined->subdivision->vertices.size();
  ASSERT_GT(before, 0U);
  const std::vector<double> longest = longestParts(*refined);
  std::vector<int> counts(given.surface.edgeCount(), 0);
  for (std::size_t e = 0; e < counts.size(); e += 2) counts[e] = 2;
  // Nothing more, or thirds of all parts: the same surface, whose old vertices are kept.
  for (const std::vector<int>& more : {std::vector<int>(counts.size(), 0), counts}) {
    const auto split = splitStraight(*refined, more);
    ASSERT_OK(split);
    expectWhole(*split);
    expectCutFaces(given, *split->subdivision);
    const std::vector<double> parts = longestParts(*split);
    std::size_t kept = 0;
    for (const Subdivision::Vertex& old : refined->subdivision->vertices) {
      for (const Subdivision::Vertex& vertex : split->subdivision->vertices) {
        kept += vertex.halfedge == old.halfedge && vertex.fraction == old.fraction ? 1 : 0;
      }
    }
    EXPECT_EQ(kept, before);
    for (std::size_t e = 0; e < parts.size(); ++e) {
      EXPECT_NEAR(parts[e], longest[e] / (more[e] + 1), 1e-12);
    }
  }
}

TEST(SplitStraight, OfStraightEdgesHasTheirLengthsAsParts) {
  const MetricSurface given = metricOfSample("genus", {{"genus", 2}, {"resolution", 4}});
  const StraightSurface straight = straighten(given.surface, uniformized(given));
  const std::vector<double> longest = longestParts(straight);
  for (Index e = 0; e < given.surface.edgeCount(); ++e) {
    EXPECT_NEAR(longest[e], straight.triangles.lengths[given.surface.halfedge(e)], 1e-14);
  }
}

/// Caps in every face: a vertex near a side.
MetricSurface withCaps(double height) {
  return insertNearEdges(metricOfSample("genus", {{"genus", 2}, {"resolution", 2}}), height, 1);
}

void expectCutAsFarAsNeeded(const MetricSurface& given) {
  HyperbolicOptions options;
  options.refine = false;
  EXPECT_THAT(mapped(given, options), FailsWith(Reason::kFoldedMap));
  const auto map = mapped(given);
  ASSERT_OK(map);
  ASSERT_TRUE(map->subdivision);
  expectClosedDomain(given, *map);
  expectCutFaces(given, *map->subdivision);
}

TEST(CutFaces, AreNeedlesThatOnlyTheirImagesTurnOver) {
  // Geodesic triangles that are sound, whose corners' chords in the disk pass each other.
  const MetricSurface given = withCaps(0.2);
  EXPECT_EQ(straighten(given.surface, uniformized(given)).folded, 0);
  expectCutAsFarAsNeeded(given);
}

TEST(CutFaces, MayHaveNeedlesAmongTheirPieces) {
  for (const double height : {0.1, 0.05}) {
    const MetricSurface given = withCaps(height);
    EXPECT_GT(straighten(given.surface, uniformized(given, false)).folded, 0);
    expectCutAsFarAsNeeded(given);
  }
}

}  // namespace
}  // namespace moduli
