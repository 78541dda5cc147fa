#include "core/matching/chords.h"

#include <cmath>

#include "core/matching/map_report.h"
#include "core/mesh/samples.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

TriangleMesh meshOf(TriangleSoup soup) {
  return *TriangleMesh::fromSoup(std::move(soup));
}

int chordsOf(const TriangleMesh& mesh) {
  const Connectivity& surface = mesh.connectivity();
  int count = 0;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    count += !surface.isBoundaryEdge(e) && surface.isBoundaryVertex(surface.tail(h)) &&
             surface.isBoundaryVertex(surface.head(h));
  }
  return count;
}

// A hexagon cut from a vertex, and from inside: faces with one, two and three chords.
std::vector<TriangleMesh> hexagons() {
  TriangleSoup soup;
  for (int k = 0; k < 6; ++k) {
    soup.vertices.emplace_back(std::cos(k * M_PI / 3), std::sin(k * M_PI / 3), 0.1 * k);
  }
  TriangleSoup inner = soup;
  soup.faces = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  inner.faces = {{0, 1, 2}, {2, 3, 4}, {4, 5, 0}, {0, 2, 4}};
  return {meshOf(soup), meshOf(inner)};
}

TEST(Chords, AreCutInTheMiddle) {
  for (const TriangleMesh& mesh : hexagons()) {
    ASSERT_EQ(chordsOf(mesh), 3);
    const auto cut = splitChords(mesh);
    ASSERT_OK(cut);
    EXPECT_EQ(chordsOf(cut->mesh), 0);
    EXPECT_EQ(cut->mesh.vertexCount(), mesh.vertexCount() + 3);
    EXPECT_EQ(cut->mesh.faceCount(), mesh.faceCount() + 6);
    EXPECT_EQ(cut->mesh.connectivity().eulerCharacteristic(), 1);
    EXPECT_NEAR(cut->mesh.area(), mesh.area(), 1e-14);
  }
}

TEST(Chords, PointsAreTheSameOnBothSurfaces) {
  for (const TriangleMesh& mesh : hexagons()) {
    const auto cut = splitChords(mesh);
    ASSERT_OK(cut);
    for (Index f = 0; f < mesh.faceCount(); ++f) {
      for (int i = 0; i <= 8; ++i) {
        for (int j = 0; i + j <= 8; ++j) {
          const SurfacePoint point{f, {i / 8.0, j / 8.0, (8 - i - j) / 8.0}};
          const SurfacePoint there = cut->fromSurface(point), back = cut->onSurface(there);
          const Vector3d place = spacePoint(mesh.connectivity(), mesh.positions(), point);
          EXPECT_LT(
              (spacePoint(cut->mesh.connectivity(), cut->mesh.positions(), there) - place).norm(),
              1e-14);
          EXPECT_EQ(back.face, f);
          EXPECT_LT((spacePoint(mesh.connectivity(), mesh.positions(), back) - place).norm(),
                    1e-14);
        }
      }
    }
  }
}

TEST(Chords, NothingIsCutWhereThereAreNone) {
  const TriangleMesh ring = meshOf(*makeSample("annulus", {{"resolution", 3}}));
  const auto cut = splitChords(ring);
  ASSERT_OK(cut);
  EXPECT_EQ(cut->mesh.connectivity().faces(), ring.connectivity().faces());
  EXPECT_TRUE(cut->ends.empty());
}

}  // namespace
}  // namespace moduli
