#include "core/mesh/connectivity.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "core/mesh/triangle_mesh.h"
#include "tests/core/mesh/shapes.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using ::testing::HasSubstr;

Result<Connectivity> connect(const TriangleSoup& soup) {
  return Connectivity::fromFaces(static_cast<Index>(soup.vertices.size()), soup.faces);
}

Index eulerOf(const TriangleSoup& soup) {
  const auto surface = connect(soup);
  EXPECT_OK(surface);
  return surface.ok() ? surface->eulerCharacteristic() : -999;
}

// Everything the header promises of a surface, checked the slow way.
void expectConsistent(const Connectivity& surface) {
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const Index t = surface.twin(h);
    const Index e = surface.edge(h);
    EXPECT_EQ(Connectivity::previous(Connectivity::next(h)), h);
    EXPECT_EQ(surface.halfedge(e), t == kNone ? h : std::min(h, t));
    EXPECT_EQ(surface.isBoundaryEdge(e), t == kNone);
    if (t == kNone) continue;
    EXPECT_EQ(surface.twin(t), h);
    EXPECT_EQ(surface.tail(t), surface.head(h));
    EXPECT_EQ(surface.edge(t), e);
    EXPECT_EQ(surface.sign(t), -surface.sign(h));
  }
  for (Index e = 1; e < surface.edgeCount(); ++e) {
    EXPECT_LT(surface.halfedge(e - 1), surface.halfedge(e));
  }
  Index corners = 0;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    Index h = surface.outgoing(v);
    do {
      EXPECT_EQ(surface.tail(h), v);
      ++corners;
      h = surface.rotate(h);
    } while (h != kNone && h != surface.outgoing(v));
    EXPECT_EQ(h == kNone, surface.isBoundaryVertex(v));
  }
  EXPECT_EQ(corners, surface.halfedgeCount());
}

TEST(Connectivity, ClosedSurfacesHaveTheirEulerCharacteristic) {
  EXPECT_EQ(eulerOf(shapes::tetrahedron()), 2);
  EXPECT_EQ(eulerOf(shapes::octahedron()), 2);
  EXPECT_EQ(eulerOf(shapes::icosahedron()), 2);
  EXPECT_EQ(eulerOf(shapes::torusGrid(3, 3)), 0);
  EXPECT_EQ(eulerOf(shapes::torusGrid(7, 5)), 0);
  for (Index genus = 2; genus <= 5; ++genus) {
    EXPECT_EQ(eulerOf(shapes::chainOfTori(genus)), 2 - 2 * genus);
  }
}

TEST(Connectivity, BorderedSurfacesHaveTheirEulerCharacteristic) {
  EXPECT_EQ(eulerOf(shapes::disk()), 1);
  EXPECT_EQ(eulerOf(shapes::annulus()), 0);
  EXPECT_EQ(eulerOf(shapes::pants()), -1);
}

TEST(Connectivity, HalfedgesEdgesAndFansAgree) {
  for (const TriangleSoup& soup :
       {shapes::tetrahedron(), shapes::torusGrid(3, 4), shapes::chainOfTori(3), shapes::disk(),
        shapes::pants(), TriangleSoup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}}) {
    const auto surface = connect(soup);
    ASSERT_OK(surface);
    expectConsistent(*surface);
  }
}

TEST(Connectivity, WheelWithAHighDegreeHubIsOneFan) {
  // More spokes than the bucket that is sorted by insertion.
  constexpr Index kSpokes = 5000;
  std::vector<Triangle> faces;
  for (Index i = 0; i < kSpokes; ++i) faces.push_back({0, 1 + i, 1 + (i + 1) % kSpokes});
  const auto surface = Connectivity::fromFaces(kSpokes + 1, faces);
  ASSERT_OK(surface);
  expectConsistent(*surface);
  EXPECT_EQ(surface->eulerCharacteristic(), 1);
  EXPECT_FALSE(surface->isBoundaryVertex(0));
}

TEST(Connectivity, RenumberingChangesNoCount) {
  std::mt19937 random(7);
  const TriangleSoup soup = shapes::chainOfTori(2);
  std::vector<Index> number(soup.vertices.size());
  std::iota(number.begin(), number.end(), 0);
  for (int trial = 0; trial < 20; ++trial) {
    std::shuffle(number.begin(), number.end(), random);
    std::vector<Triangle> faces = soup.faces;
    std::shuffle(faces.begin(), faces.end(), random);
    for (Triangle& face : faces) {
      std::rotate(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(random() % 3),
                  face.end());
      for (Index& v : face) v = number[v];
    }
    const auto surface = Connectivity::fromFaces(static_cast<Index>(number.size()), faces);
    ASSERT_OK(surface);
    expectConsistent(*surface);
    EXPECT_EQ(surface->eulerCharacteristic(), -2);
  }
}

TEST(Connectivity, TwoFacesBackToBackAreASphere) {
  const auto surface = Connectivity::fromFaces(3, {{0, 1, 2}, {2, 1, 0}});
  ASSERT_OK(surface);
  expectConsistent(*surface);
  EXPECT_EQ(surface->eulerCharacteristic(), 2);
}

TEST(Connectivity, RejectsWhatIsNoSurfaceByName) {
  EXPECT_THAT(Connectivity::fromFaces(3, {}), FailsWith(Reason::kEmpty));
  EXPECT_THAT(Connectivity::fromFaces(3, {{0, 1, 3}}), FailsWith(Reason::kIndexOutOfRange));
  EXPECT_THAT(Connectivity::fromFaces(3, {{0, 1, -1}}), FailsWith(Reason::kIndexOutOfRange));
  EXPECT_THAT(Connectivity::fromFaces(3, {{0, 1, 1}}), FailsWith(Reason::kDegenerateFace));
  EXPECT_THAT(connect(shapes::threeAtAnEdge()), FailsWith(Reason::kNonManifoldEdge));
  EXPECT_THAT(connect(shapes::moebiusStrip(5)), FailsWith(Reason::kInconsistentOrientation));
  EXPECT_THAT(connect(shapes::bowTie()), FailsWith(Reason::kNonManifoldVertex));
  EXPECT_THAT(Connectivity::fromFaces(4, {{0, 1, 2}}), FailsWith(Reason::kNonManifoldVertex));
}

TEST(Connectivity, MessagesNameTheElements) {
  EXPECT_THAT(connect(shapes::threeAtAnEdge()).status().message(),
              HasSubstr("edge (0, 1) has 3 faces: 0, 1, 2"));
  EXPECT_THAT(connect(shapes::bowTie()).status().message(), HasSubstr("vertex 0 pinches"));
  EXPECT_THAT(Connectivity::fromFaces(4, {{0, 1, 2}}).status().message(),
              HasSubstr("vertex 3 has no faces"));
  EXPECT_THAT(Connectivity::fromFaces(3, {{0, 1, 7}}).status().message(),
              HasSubstr("face 0 uses vertex 7 of 3"));
}

TEST(Connectivity, OneVertexTorusFromItsGluing) {
  // A square with opposite sides glued: faces (bottom, right, diagonal) and (diagonal, top, left).
  const auto surface = Connectivity::fromGluing(1, {{0, 0, 0}, {0, 0, 0}}, {4, 5, 3, 2, 0, 1});
  ASSERT_OK(surface);
  expectConsistent(*surface);
  EXPECT_EQ(surface->edgeCount(), 3);
  EXPECT_EQ(surface->eulerCharacteristic(), 0);
}

TEST(Connectivity, FaceGluedToItselfMakesAConeTip) {
  const auto surface = Connectivity::fromGluing(2, {{0, 1, 1}}, {2, kNone, 0});
  ASSERT_OK(surface);
  expectConsistent(*surface);
  EXPECT_EQ(surface->eulerCharacteristic(), 1);
}

TEST(Connectivity, GluingIsCheckedHalfedgeByHalfedge) {
  const std::vector<Triangle> two = {{0, 1, 2}, {2, 1, 3}};
  EXPECT_OK(Connectivity::fromGluing(4, two, {-1, 3, -1, 1, -1, -1}));
  const std::vector<std::vector<Index>> wrong = {
      {-1, 3, -1, 1, -1},    {-1, 3, -1, -1, -1, -1}, {-1, 3, -1, 1, -1, 9}, {-1, 3, -1, 1, -1, -2},
      {0, 3, -1, 1, -1, -1}, {-1, 4, -1, -1, 1, -1},  {-1, 3, 5, 1, -1, 2},
  };
  for (const auto& twin : wrong) {
    EXPECT_THAT(Connectivity::fromGluing(4, two, twin), FailsWith(Reason::kInvalidOption));
  }
  EXPECT_THAT(Connectivity::fromGluing(4, two, std::vector<Index>(6, kNone)),
              FailsWith(Reason::kNonManifoldVertex));
  EXPECT_THAT(Connectivity::fromGluing(5, two, {-1, 3, -1, 1, -1, -1}),
              FailsWith(Reason::kNonManifoldVertex));
}

TEST(TriangleMesh, KeepsPositionsAndMeasures) {
  const auto mesh = TriangleMesh::fromSoup(shapes::octahedron());
  ASSERT_OK(mesh);
  EXPECT_EQ(mesh->positions(), shapes::octahedron().vertices);
  // Rounding of one square root and a handful of products.
  for (const double length : mesh->edgeLengths()) EXPECT_NEAR(length, std::sqrt(2.0), 1e-15);
  for (const double area : mesh->faceAreas()) EXPECT_NEAR(area, std::sqrt(3.0) / 2, 1e-15);
  EXPECT_NEAR(mesh->area(), 4 * std::sqrt(3.0), 1e-14);
}

TEST(TriangleMesh, MeasuresTinyAndHugeModels) {
  for (const double scale : {1e-150, 1e-100, 1e100, 1e150}) {
    TriangleSoup soup = shapes::octahedron();
    for (auto& p : soup.vertices) p *= scale;
    const auto mesh = TriangleMesh::fromSoup(soup);
    ASSERT_OK(mesh);
    EXPECT_NEAR(mesh->area() / scale / scale, 4 * std::sqrt(3.0), 1e-13);
    EXPECT_NEAR(mesh->edgeLengths()[0] / scale, std::sqrt(2.0), 1e-14);
  }
}

TEST(TriangleMesh, RefusesCoordinatesThatAreNotNumbers) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    TriangleSoup soup = shapes::tetrahedron();
    soup.vertices[2].y() = bad;
    EXPECT_THAT(TriangleMesh::fromSoup(soup), FailsWith(Reason::kNonFiniteCoordinate));
  }
}

}  // namespace
}  // namespace moduli
