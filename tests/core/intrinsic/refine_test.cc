#include "core/intrinsic/refine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "core/intrinsic/angles.h"
#include "core/intrinsic/delaunay.h"
#include "core/intrinsic/geometry.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

std::vector<MetricSurface> surfaces() {
  const MetricSurface torus = flatTorus({0.3, 1.2}, 6, 5, 0.2, 1);
  return {flipEdges(torus, 400, 2), gluedPolygon(8), octahedronCover(),
          flipEdges(insertVertices(plate(4, 3, {{1, 1}}), 40, 0.02, 9), 200, 10)};
}

double areaOf(const Connectivity& surface, const std::vector<double>& lengths) {
  double area = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    area += triangleArea(Geometry::kEuclidean,
                         {lengths[surface.edge(3 * f)], lengths[surface.edge(3 * f + 1)],
                          lengths[surface.edge(3 * f + 2)]});
  }
  return area;
}

/// Per vertex the sum of its angles, and whether it lies on the boundary.
struct Cone {
  double angle = 0;
  bool boundary = false;
};
std::vector<Cone> conesOf(const Connectivity& surface, const std::vector<double>& lengths) {
  const std::vector<double> angles = cornerAngles(surface, lengths);
  std::vector<Cone> cones(surface.vertexCount());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    cones[surface.tail(h)].angle += angles[h];
    if (surface.twin(h) == kNone) {
      cones[surface.tail(h)].boundary = cones[surface.head(h)].boundary = true;
    }
  }
  return cones;
}

TEST(RefineDelaunay, KeepsTheSurfaceAndCutsAllLongEdges) {
  Context context;
  for (const MetricSurface& metric : surfaces()) {
    const double area = areaOf(metric.surface, metric.lengths);
    RefineOptions options;
    options.longest = std::sqrt(area) / 20;
    const auto finer = refineDelaunay(context, metric.surface, metric.lengths, options);
    ASSERT_OK(finer);
    EXPECT_EQ(finer->surface.eulerCharacteristic(), metric.surface.eulerCharacteristic());
    EXPECT_LE(*std::max_element(finer->lengths.begin(), finer->lengths.end()), options.longest);
    // Every flip rounds a length, and there are some thousand.
    EXPECT_NEAR(areaOf(finer->surface, finer->lengths) / area, 1, 1e-10);
    // Given vertices keep their angles; new ones are flat: pi on the boundary, 2 pi elsewhere.
    const std::vector<Cone> given = conesOf(metric.surface, metric.lengths);
    const std::vector<Cone> cones = conesOf(finer->surface, finer->lengths);
    for (std::size_t v = 0; v < cones.size(); ++v) {
      const double flat = (cones[v].boundary ? 1 : 2) * std::numbers::pi;
      ASSERT_NEAR(cones[v].angle, v < given.size() ? given[v].angle : flat, 1e-8) << v;
    }
    // By no more than fits: an edge is halved only while it is over the limit, which leaves at
    // least half of it, and nearly equilateral faces.
    EXPECT_LT(finer->surface.faceCount(),
              metric.surface.faceCount() + 16 * area / (options.longest * options.longest));
  }
}

TEST(RefineDelaunay, IsDelaunay) {
  Context context;
  for (const MetricSurface& metric : surfaces()) {
    RefineOptions options;
    options.longest = std::sqrt(areaOf(metric.surface, metric.lengths)) / 10;
    const auto finer = refineDelaunay(context, metric.surface, metric.lengths, options);
    ASSERT_OK(finer);
    std::vector<double> half_chords = finer->lengths;
    for (double& x : half_chords) x /= 2;
    const IntrinsicTriangulation triangulation(finer->surface, half_chords);
    for (Index h = 0; h < triangulation.halfedgeCount(); ++h) {
      ASSERT_TRUE(isDelaunay(triangulation, h));
    }
  }
}

TEST(RefineDelaunay, LeavesAFineDelaunayTriangulationAlone) {
  Context context;
  const MetricSurface metric = octahedronCover();
  RefineOptions options;
  options.longest = *std::max_element(metric.lengths.begin(), metric.lengths.end());
  const auto finer = refineDelaunay(context, metric.surface, metric.lengths, options);
  ASSERT_OK(finer);
  EXPECT_EQ(finer->surface.faces(), metric.surface.faces());
  EXPECT_EQ(finer->lengths, metric.lengths);
}

TEST(RefineDelaunay, AddsNoMoreThanAllowed) {
  Context context;
  const MetricSurface metric = gluedPolygon(8);
  RefineOptions options;
  options.longest = *std::max_element(metric.lengths.begin(), metric.lengths.end()) / 1000;
  options.most_added = 500;
  const auto finer = refineDelaunay(context, metric.surface, metric.lengths, options);
  ASSERT_OK(finer);
  EXPECT_LE(finer->surface.faceCount(), metric.surface.faceCount() + 500);
  // A round at most triples what is added: the last one was over a quarter of the limit.
  EXPECT_GT(finer->surface.faceCount(), metric.surface.faceCount() + 100);
}

TEST(RefineDelaunay, RefusesNoLengthAndStopsWhenCancelled) {
  Context context;
  const MetricSurface metric = gluedPolygon(8);
  EXPECT_THAT(refineDelaunay(context, metric.surface, metric.lengths, {}),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(refineInSpace(context, {metric.surface, metric.lengths, {}}, {}),
              FailsWith(Reason::kInvalidOption));
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  RefineOptions options;
  options.longest = 1e-3;
  EXPECT_THAT(refineDelaunay(context, metric.surface, metric.lengths, options),
              FailsWith(Reason::kCancelled));
}

TEST(RefineInSpace, KeepsFacesFlatAndLengthsTrue) {
  // A tetrahedron with one long corner.
  const std::vector<Eigen::Vector3d> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.1, 0.2, 4}};
  const auto surface = Connectivity::fromFaces(4, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  ASSERT_OK(surface);
  std::vector<double> lengths;
  const auto lengthOf = [](const Connectivity& s, const std::vector<Eigen::Vector3d>& p, Index e) {
    return (p[s.head(s.halfedge(e))] - p[s.tail(s.halfedge(e))]).norm();
  };
  for (Index e = 0; e < surface->edgeCount(); ++e)
    lengths.push_back(lengthOf(*surface, corners, e));
  Context context;
  RefineOptions options;
  options.longest = 0.3;
  const auto fine = refineInSpace(context, {*surface, lengths, corners}, options);
  ASSERT_OK(fine);
  EXPECT_LE(*std::max_element(fine->lengths.begin(), fine->lengths.end()), 0.3);
  EXPECT_EQ(fine->surface.eulerCharacteristic(), 2);
  ASSERT_EQ(fine->positions.size(), static_cast<std::size_t>(fine->surface.vertexCount()));
  for (Index e = 0; e < fine->surface.edgeCount(); ++e) {
    ASSERT_NEAR(fine->lengths[e], lengthOf(fine->surface, fine->positions, e), 1e-14);
  }
  EXPECT_NEAR(areaOf(fine->surface, fine->lengths) / areaOf(*surface, lengths), 1, 1e-13);
}

}  // namespace
}  // namespace moduli
