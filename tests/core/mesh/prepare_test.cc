#include "core/mesh/prepare.h"

#include <cmath>
#include <numeric>

#include "tests/core/mesh/shapes.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

Result<PreparedMesh> prepare(const TriangleSoup& soup, const std::string& component = "",
                             bool repair = false) {
  Context context;
  return prepareMesh(context, soup, {{repair, {}}, component});
}

std::vector<Index> countingTo(std::size_t n) {
  std::vector<Index> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

TEST(Prepare, SoundSurfaceComesThroughUnchanged) {
  const TriangleSoup soup = shapes::torusGrid(6, 4);
  const auto prepared = prepare(soup);
  ASSERT_OK(prepared);
  EXPECT_EQ(prepared->mesh.positions(), soup.vertices);
  EXPECT_EQ(prepared->mesh.connectivity().faces(), soup.faces);
  EXPECT_EQ(prepared->input_vertex, countingTo(soup.vertices.size()));
  EXPECT_EQ(prepared->input_face, countingTo(soup.faces.size()));
  EXPECT_THAT(prepared->actions, IsEmpty());
  EXPECT_THAT(prepared->warnings, IsEmpty());
}

TEST(Prepare, DropsIsolatedVerticesWithAWarning) {
  TriangleSoup soup = shapes::tetrahedron();
  soup.vertices.insert(soup.vertices.begin() + 2, Eigen::Vector3d(8, 8, 8));
  for (Triangle& face : soup.faces) {
    for (Index& v : face) v += v >= 2 ? 1 : 0;
  }
  const auto prepared = prepare(soup);
  ASSERT_OK(prepared);
  EXPECT_EQ(prepared->mesh.connectivity().faces(), shapes::tetrahedron().faces);
  EXPECT_THAT(prepared->input_vertex, ElementsAre(0, 1, 3, 4));
  EXPECT_THAT(prepared->warnings,
              ElementsAre("ISOLATED_VERTEX: 1 vertex is used by no face (2); skipped in computing, "
                          "kept in outputs"));
}

TEST(Prepare, ZeroAreaFacesAreAWarning) {
  const auto prepared =
      prepare({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  ASSERT_OK(prepared);
  EXPECT_THAT(prepared->warnings,
              ElementsAre("ZERO_AREA_FACE: 1 face has no area (0); computed by mollification"));
}

TEST(Prepare, RefusesBlockingDefectsByName) {
  EXPECT_THAT(prepare({}), FailsWith(Reason::kEmpty));
  EXPECT_THAT(prepare(shapes::bowTie()), FailsWith(Reason::kNonManifoldVertex));
  EXPECT_THAT(prepare(shapes::threeAtAnEdge()), FailsWith(Reason::kNonManifoldEdge));
  EXPECT_THAT(prepare(shapes::threeAtAnEdge(), "", true), FailsWith(Reason::kNonManifoldEdge));
  EXPECT_THAT(prepare(shapes::moebiusStrip(6)), FailsWith(Reason::kNonOrientable));
  EXPECT_THAT(prepare(shapes::moebiusStrip(6), "", true), FailsWith(Reason::kNonOrientable));
  TriangleSoup turned = shapes::octahedron();
  std::swap(turned.faces[3][0], turned.faces[3][1]);
  EXPECT_THAT(prepare(turned), FailsWith(Reason::kInconsistentOrientation));
  TriangleSoup broken = shapes::octahedron();
  broken.vertices[3].x() = std::nan("");
  EXPECT_THAT(prepare(broken), FailsWith(Reason::kNonFiniteCoordinate));
  TriangleSoup doubled = shapes::octahedron();
  doubled.faces.push_back(doubled.faces[0]);
  EXPECT_THAT(prepare(doubled), FailsWith(Reason::kDuplicateFace));
}

TEST(Prepare, ListsComponentsWhereNoneIsChosen) {
  const TriangleSoup soup = shapes::together(shapes::tetrahedron(), shapes::torusGrid(3, 4));
  const Status status = prepare(soup).status();
  EXPECT_EQ(status.reason(), Reason::kMultipleComponents);
  EXPECT_THAT(status.message(), HasSubstr("0 (4 faces, genus 0, 0 boundary loops)"));
  EXPECT_THAT(status.message(), HasSubstr("1 (24 faces, genus 1, 0 boundary loops)"));
}

TEST(Prepare, ListsAtMostTenComponents) {
  TriangleSoup soup = shapes::tetrahedron();
  for (int i = 1; i < 14; ++i) {
    soup = shapes::together(soup, shapes::tetrahedron(), {10.0 * i, 0, 0});
  }
  const std::string message = prepare(soup).status().message();
  EXPECT_THAT(message, HasSubstr("9 (4 faces"));
  EXPECT_THAT(message, Not(HasSubstr("10 (4 faces")));
  EXPECT_THAT(message, HasSubstr("and 4 more"));
}

TEST(Prepare, PicksAComponentByNumberOrSize) {
  const TriangleSoup torus = shapes::torusGrid(3, 4);
  TriangleSoup soup = shapes::together(shapes::tetrahedron(), torus, {0, 0, 0});
  for (const char* choice : {"1", "largest"}) {
    const auto prepared = prepare(soup, choice);
    ASSERT_OK(prepared);
    EXPECT_EQ(prepared->mesh.positions(), torus.vertices);
    EXPECT_EQ(prepared->mesh.connectivity().faces(), torus.faces);
    EXPECT_EQ(prepared->input_vertex[0], 4);
    EXPECT_EQ(prepared->input_face[0], 4);
    ASSERT_EQ(prepared->warnings.size(), 1);
    EXPECT_THAT(prepared->warnings[0], HasSubstr("MULTIPLE_COMPONENTS: the surface has 2"));
  }
  EXPECT_EQ(prepare(soup, "0")->mesh.faceCount(), 4);
  const auto all = prepare(soup, "all");
  ASSERT_OK(all);
  EXPECT_EQ(all->mesh.connectivity().faces(), soup.faces);
  EXPECT_TRUE(all->warnings.empty());
  EXPECT_THAT(prepare(soup, "2"), FailsWith(Reason::kComponentNotFound));
  EXPECT_THAT(prepare(soup, "-1"), FailsWith(Reason::kComponentNotFound));
  EXPECT_THAT(prepare(soup, "biggest"), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(prepare(torus, "1"), FailsWith(Reason::kComponentNotFound));
  EXPECT_OK(prepare(torus, "0"));
}

TEST(Prepare, LowerFaceWinsATie) {
  const TriangleSoup soup = shapes::together(shapes::tetrahedron(), shapes::tetrahedron());
  EXPECT_EQ(prepare(soup, "largest")->input_face[0], 0);
}

TEST(Prepare, ComponentsTouchingInAVertexAreTwoOnceRepaired) {
  const auto prepared = prepare(shapes::bowTie(), "1", true);
  ASSERT_OK(prepared);
  EXPECT_EQ(prepared->mesh.faceCount(), 1);
  EXPECT_THAT(prepared->input_face, ElementsAre(1));
  EXPECT_THAT(prepared->input_vertex, ElementsAre(3, 4, 0));
}

TEST(Prepare, DefectsLeftAfterRepairSpeakOfTheInput) {
  TriangleSoup soup = shapes::threeAtAnEdge();
  soup.faces.insert(soup.faces.begin(), {2, 2, 3});
  EXPECT_THAT(prepare(soup, "", true).status().message(), HasSubstr("(at face 1)"));
}

}  // namespace
}  // namespace moduli
