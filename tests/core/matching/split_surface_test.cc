#include "core/matching/split_surface.h"

#include <cmath>

#include "core/matching/map_report.h"
#include "tests/core/matching/disk_samples.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

TriangleMesh meshOf(const TriangleSoup& soup) {
  return *TriangleMesh::fromSoup(soup);
}

/// Edges inside between vertices of the boundary, and faces with all corners there.
int badParts(const Connectivity& surface) {
  int bad = 0;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    if (!surface.isBoundaryEdge(e) && surface.isBoundaryVertex(surface.tail(h)) &&
        surface.isBoundaryVertex(surface.head(h))) {
      ++bad;
    }
  }
  for (const auto& [a, b, c] : surface.faces()) {
    if (surface.isBoundaryVertex(a) && surface.isBoundaryVertex(b) && surface.isBoundaryVertex(c)) {
      ++bad;
    }
  }
  return bad;
}

TEST(SplitSurface, LeavesNoEdgeAndNoFaceToTheBoundaryAlone) {
  const TriangleSoup triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  // The middle face of four has three such edges, those of the strip two.
  const TriangleSoup star{
      {{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, -1, 0}, {2.5, 1.5, 0}, {-0.5, 1.5, 0}},
      {{0, 1, 2}, {0, 3, 1}, {1, 4, 2}, {2, 5, 0}}};
  for (const TriangleSoup& soup : {triangle, twoTriangles(), strip(7), star}) {
    const TriangleMesh mesh = meshOf(soup);
    ASSERT_GT(badParts(mesh.connectivity()), 0);
    const auto split = SplitSurface::make(mesh);
    ASSERT_OK(split);
    EXPECT_EQ(badParts(split->mesh().connectivity()), 0);
    EXPECT_EQ(split->mesh().connectivity().eulerCharacteristic(), 1);
    EXPECT_NEAR(split->mesh().area(), mesh.area(), 1e-14 * mesh.area());
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      EXPECT_EQ(split->mesh().positions()[v], mesh.positions()[v]);
    }
  }
}

TEST(SplitSurface, LeavesAGoodSurfaceAsItIs) {
  const TriangleMesh mesh = meshOf(shield(6, 2));
  ASSERT_EQ(badParts(mesh.connectivity()), 0);
  const auto split = SplitSurface::make(mesh);
  ASSERT_OK(split);
  EXPECT_EQ(split->mesh().connectivity().faces(), mesh.connectivity().faces());
}

TEST(SplitSurface, TakesPointsThereAndBack) {
  const TriangleMesh mesh = meshOf(strip(7));
  const auto split = SplitSurface::make(mesh, {{2, {0.2, 0.3, 0.5}}});
  ASSERT_OK(split);
  const TriangleMesh& parts = split->mesh();
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    for (const double s : {0.0, 0.1, 0.4, 0.6, 0.9}) {
      const SurfacePoint point{f, {s, (1 - s) * 0.7, (1 - s) * 0.3}};
      const SurfacePoint there = split->after(point);
      const Eigen::Vector3d p = spacePoint(mesh.connectivity(), mesh.positions(), point);
      EXPECT_LT((spacePoint(parts.connectivity(), parts.positions(), there) - p).norm(), 1e-14);
      const SurfacePoint back = split->before(there);
      EXPECT_EQ(back.face, f);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(back.barycentric[c], point.barycentric[c], 1e-14);
    }
  }
}

TEST(SplitSurface, KeepsTheBoundaryOnTheBoundary) {
  const TriangleMesh mesh = meshOf(strip(7));
  const auto split = SplitSurface::make(mesh);
  ASSERT_OK(split);
  const Connectivity& parts = split->mesh().connectivity();
  int seen = 0;
  for (Index h = 0; h < parts.halfedgeCount(); ++h) {
    if (parts.twin(h) != kNone) continue;
    const SurfacePoint point = split->before(edgePoint(h, 0.3));
    for (int c = 0; c < 3; ++c) {
      const Index own = 3 * point.face + c;
      if (point.barycentric[(c + 2) % 3] == 0 && mesh.connectivity().twin(own) == kNone) ++seen;
    }
  }
  EXPECT_EQ(seen, 9);  // Every edge of the boundary, weight 0 to the last bit.
}

TEST(SplitSurface, MakesPointsVertices) {
  const TriangleMesh mesh = meshOf(shield(4, 2));
  const Connectivity& surface = mesh.connectivity();
  Index rim = 0;
  while (surface.twin(rim) != kNone) ++rim;
  Index inner = 0;
  while (surface.twin(inner) == kNone) ++inner;
  // In a face, twice in one more, on an edge inside, on one of the boundary, at a vertex.
  const std::vector<SurfacePoint> points = {{7, {0.2, 0.3, 0.5}}, {9, {0.2, 0.3, 0.5}},
                                            {9, {0.6, 0.3, 0.1}}, edgePoint(inner, 0.25),
                                            edgePoint(rim, 0.75), vertexPoint(surface, 5)};
  const auto split = SplitSurface::make(mesh, points);
  ASSERT_OK(split);
  ASSERT_EQ(split->vertices().size(), points.size());
  EXPECT_EQ(split->vertices().back(), 5);
  EXPECT_EQ(split->mesh().vertexCount(), mesh.vertexCount() + 5);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = spacePoint(surface, mesh.positions(), points[i]);
    EXPECT_LT((split->mesh().positions()[split->vertices()[i]] - p).norm(), 1e-15);
  }
  EXPECT_TRUE(split->mesh().connectivity().isBoundaryVertex(split->vertices()[4]));
  EXPECT_EQ(badParts(split->mesh().connectivity()), 0);
  EXPECT_NEAR(split->mesh().area(), mesh.area(), 1e-14 * mesh.area());
}

}  // namespace
}  // namespace moduli
