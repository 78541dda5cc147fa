#include "core/mesh/inspect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "tests/core/mesh/shapes.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Inspection inspect(const TriangleSoup& soup) {
  Context context;
  auto inspection = inspectSoup(context, soup);
  EXPECT_OK(inspection);
  return *std::move(inspection);
}

std::vector<DefectKind> kindsOf(const Inspection& inspection) {
  std::vector<DefectKind> kinds;
  for (const Defect& defect : inspection.defects) kinds.push_back(defect.kind);
  return kinds;
}

void expectOneDefect(const TriangleSoup& soup, DefectKind kind, Index count,
                     const std::vector<Index>& elements) {
  const Inspection inspection = inspect(soup);
  ASSERT_THAT(kindsOf(inspection), ElementsAre(kind));
  EXPECT_EQ(inspection.defects[0].count, count);
  EXPECT_EQ(inspection.defects[0].elements, elements);
  EXPECT_EQ(inspection.valid, !isBlocking(kind));
}

TEST(Inspect, SoundSurfacesHaveNoDefects) {
  struct Expected {
    TriangleSoup soup;
    Index loops, genus, euler;
  };
  for (const Expected& expected : std::vector<Expected>{{shapes::tetrahedron(), 0, 0, 2},
                                                        {shapes::icosahedron(), 0, 0, 2},
                                                        {shapes::torusGrid(5, 6), 0, 1, 0},
                                                        {shapes::chainOfTori(1), 0, 1, 0},
                                                        {shapes::disk(), 1, 0, 1},
                                                        {shapes::annulus(), 2, 0, 0},
                                                        {shapes::pants(), 3, 0, -1}}) {
    const Inspection inspection = inspect(expected.soup);
    EXPECT_TRUE(inspection.valid);
    EXPECT_THAT(inspection.defects, IsEmpty());
    EXPECT_EQ(inspection.counts.components, 1);
    EXPECT_EQ(inspection.counts.boundary_loops, expected.loops);
    EXPECT_EQ(inspection.counts.genus, expected.genus);
    EXPECT_EQ(inspection.counts.euler_characteristic, expected.euler);
    EXPECT_TRUE(inspection.counts.orientable);
    EXPECT_OK(blockingError(inspection));
  }
}

TEST(Inspect, GenusGoesThroughChains) {
  for (Index genus = 2; genus <= 6; ++genus) {
    EXPECT_EQ(inspect(shapes::chainOfTori(genus)).counts.genus, genus);
  }
}

TEST(Inspect, EmptyMesh) {
  const Inspection inspection = inspect({{{0, 0, 0}}, {}});
  EXPECT_THAT(kindsOf(inspection), ElementsAre(DefectKind::kEmpty, DefectKind::kIsolatedVertex));
  EXPECT_FALSE(inspection.valid);
  EXPECT_THAT(blockingError(inspection), FailsWith(Reason::kEmpty));
  EXPECT_FALSE(inspect({}).valid);
}

TEST(Inspect, NonFiniteCoordinates) {
  TriangleSoup soup = shapes::octahedron();
  soup.vertices[1].x() = std::nan("");
  soup.vertices[4].z() = std::numeric_limits<double>::infinity();
  expectOneDefect(soup, DefectKind::kNonFiniteCoordinate, 2, {1, 4});
  EXPECT_TRUE(std::isfinite(inspect(soup).counts.area));
}

TEST(Inspect, NanNeverCountsAsADuplicate) {
  TriangleSoup soup = shapes::octahedron();
  soup.vertices[1].setConstant(std::nan(""));
  soup.vertices[2].setConstant(std::nan(""));
  expectOneDefect(soup, DefectKind::kNonFiniteCoordinate, 2, {1, 2});
}

TEST(Inspect, FaceThatRepeatsAVertex) {
  TriangleSoup soup = shapes::disk();
  soup.faces.push_back({3, 3, 5});
  soup.faces.push_back({4, 4, 4});
  expectOneDefect(soup, DefectKind::kDegenerateFace, 2, {18, 19});
}

TEST(Inspect, DuplicateFaceInAnyOrder) {
  const TriangleSoup pair = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {1, 0, 2}}};
  expectOneDefect(pair, DefectKind::kDuplicateFace, 1, {1});
  TriangleSoup three = pair;
  three.faces.push_back({2, 0, 1});
  const Inspection inspection = inspect(three);
  EXPECT_THAT(kindsOf(inspection),
              ElementsAre(DefectKind::kDuplicateFace, DefectKind::kNonManifoldEdge));
  EXPECT_THAT(inspection.defects[0].elements, ElementsAre(1, 2));
}

TEST(Inspect, ThreeFacesAtAnEdge) {
  expectOneDefect(shapes::threeAtAnEdge(), DefectKind::kNonManifoldEdge, 1, {0});
  EXPECT_EQ(inspect(shapes::threeAtAnEdge()).counts.genus, std::nullopt);
  EXPECT_EQ(inspect(shapes::threeAtAnEdge()).counts.components, 1);
  EXPECT_THAT(blockingError(inspect(shapes::threeAtAnEdge())), FailsWith(Reason::kNonManifoldEdge));
}

TEST(Inspect, TurnedFaceIsInconsistentAtItsEdges) {
  TriangleSoup soup = shapes::icosahedron();
  std::swap(soup.faces[7][0], soup.faces[7][1]);
  const Inspection inspection = inspect(soup);
  ASSERT_THAT(kindsOf(inspection), ElementsAre(DefectKind::kInconsistentOrientation));
  EXPECT_EQ(inspection.defects[0].count, 3);
  EXPECT_EQ(inspection.counts.genus, 0);
  EXPECT_TRUE(inspection.counts.orientable);
}

TEST(Inspect, MoebiusStripIsNamedOneSided) {
  for (const Index n : {3, 4, 9, 20}) {
    const Inspection inspection = inspect(shapes::moebiusStrip(n));
    ASSERT_THAT(kindsOf(inspection),
                ElementsAre(DefectKind::kNonOrientable, DefectKind::kInconsistentOrientation));
    EXPECT_EQ(inspection.defects[0].count, 1);
    EXPECT_THAT(inspection.defects[0].elements, ElementsAre(0));
    EXPECT_FALSE(inspection.counts.orientable);
    EXPECT_EQ(inspection.counts.boundary_loops, 1);
    EXPECT_EQ(inspection.counts.euler_characteristic, 0);
    EXPECT_EQ(inspection.counts.genus, std::nullopt);
    EXPECT_THAT(blockingError(inspection), FailsWith(Reason::kNonOrientable));
  }
}

TEST(Inspect, PinchedVertexIsCountedAfterSplitting) {
  const Inspection inspection = inspect(shapes::bowTie());
  EXPECT_THAT(kindsOf(inspection),
              ElementsAre(DefectKind::kNonManifoldVertex, DefectKind::kMultipleComponents));
  EXPECT_THAT(inspection.defects[0].elements, ElementsAre(0));
  EXPECT_THAT(inspection.defects[1].elements, ElementsAre(0, 1));
  EXPECT_EQ(inspection.counts.components, 2);
  EXPECT_EQ(inspection.counts.boundary_loops, 2);
  EXPECT_EQ(inspection.counts.euler_characteristic, 2);
  EXPECT_EQ(inspection.counts.genus, 0);
}

TEST(Inspect, Warnings) {
  TriangleSoup isolated = shapes::tetrahedron();
  isolated.vertices.emplace_back(5, 5, 5);
  expectOneDefect(isolated, DefectKind::kIsolatedVertex, 1, {4});
  EXPECT_EQ(inspect(isolated).counts.euler_characteristic, 2);

  TriangleSoup repeated = shapes::disk();
  repeated.vertices[3] = repeated.vertices[12];
  repeated.vertices[0] = Eigen::Vector3d(-0.0, 0, -0.0);
  repeated.vertices[15] = Eigen::Vector3d(0, -0.0, 0);
  const Inspection inspection = inspect(repeated);
  const auto found = std::find_if(
      inspection.defects.begin(), inspection.defects.end(),
      [](const Defect& defect) { return defect.kind == DefectKind::kDuplicateVertex; });
  ASSERT_NE(found, inspection.defects.end());
  EXPECT_THAT(found->elements, ElementsAre(12, 15));
  EXPECT_TRUE(inspection.valid);

  const TriangleSoup flat = {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  expectOneDefect(flat, DefectKind::kZeroAreaFace, 1, {0});

  expectOneDefect(shapes::together(shapes::tetrahedron(), shapes::octahedron()),
                  DefectKind::kMultipleComponents, 2, {0, 4});
}

TEST(Inspect, ScaleChangesNoVerdict) {
  for (const double scale : {1e-120, 1e-9, 1e9, 1e120}) {
    TriangleSoup flat = {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {1, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    for (auto& p : flat.vertices) p *= scale;
    expectOneDefect(flat, DefectKind::kZeroAreaFace, 1, {0});
    // Thin, but five digits above what rounding could do.
    TriangleSoup needle = {{{0, 0, 0}, {1, 1e-9, 0}, {2, 0, 0}}, {{0, 1, 2}}};
    for (auto& p : needle.vertices) p *= scale;
    EXPECT_THAT(inspect(needle).defects, IsEmpty());
  }
}

TEST(Inspect, ElementsStopAtAHundredButTheCountGoesOn) {
  TriangleSoup soup = shapes::tetrahedron();
  for (int i = 0; i < 250; ++i) soup.vertices.emplace_back(i, 7, 7);
  const Inspection inspection = inspect(soup);
  ASSERT_THAT(kindsOf(inspection), ElementsAre(DefectKind::kIsolatedVertex));
  EXPECT_EQ(inspection.defects[0].count, 250);
  EXPECT_EQ(inspection.defects[0].elements.size(), 100);
}

TEST(Inspect, MessagesNameElementsAndRemedy) {
  TriangleSoup soup = shapes::disk();
  soup.faces.push_back({3, 3, 5});
  EXPECT_EQ(inspect(soup).defects[0].message, "1 face repeats a vertex (18); --repair drops it");
  soup.faces.push_back({4, 4, 5});
  EXPECT_EQ(inspect(soup).defects[0].message,
            "2 faces repeat a vertex (18, 19); --repair drops them");
  const Status error = blockingError(inspect(soup));
  EXPECT_EQ(error.message(), "2 faces repeat a vertex (18, 19)");
  EXPECT_EQ(error.hint(), "--repair drops them");
}

TEST(Inspect, EveryBlockingKindHasAReasonOfItsName) {
  for (int k = 0; k <= static_cast<int>(DefectKind::kMultipleComponents); ++k) {
    const auto kind = static_cast<DefectKind>(k);
    EXPECT_FALSE(defectName(kind).empty());
    if (!isBlocking(kind)) continue;
    EXPECT_EQ(reasonName(reasonFromName(defectName(kind))), defectName(kind));
  }
}

TEST(Inspect, ManyFacesAtOneEdgeAreNoTrap) {
  // Quadratic work here would take minutes.
  constexpr Index kPages = 200000;
  TriangleSoup book;
  book.vertices = {{0, 0, 0}, {0, 0, 1}};
  for (Index i = 0; i < kPages; ++i) {
    book.vertices.emplace_back(std::cos(i), std::sin(i), i);
    book.faces.push_back({0, 1, i + 2});
  }
  const Inspection inspection = inspect(book);
  ASSERT_THAT(kindsOf(inspection), ElementsAre(DefectKind::kNonManifoldEdge));
  EXPECT_EQ(inspection.defects[0].count, 1);
}

TEST(Inspect, EqualPointsWithoutEndAreNoTrap) {
  TriangleSoup soup = shapes::tetrahedron();
  soup.vertices.resize(300000, Eigen::Vector3d(2, 3, 4));
  const Inspection inspection = inspect(soup);
  EXPECT_THAT(kindsOf(inspection),
              ElementsAre(DefectKind::kIsolatedVertex, DefectKind::kDuplicateVertex));
  EXPECT_EQ(inspection.defects[1].count, 300000 - 5);
}

TEST(Inspect, StopsWhenCancelled) {
  Context context;
  CancelToken token;
  context.setCancelToken(token);
  token.cancel();
  EXPECT_THAT(inspectSoup(context, shapes::tetrahedron()), FailsWith(Reason::kCancelled));
}

TEST(Inspect, RenumberingMovesElementsButNoCount) {
  std::mt19937 random(5);
  TriangleSoup soup = shapes::together(shapes::bowTie(), shapes::chainOfTori(2));
  std::swap(soup.faces[20][0], soup.faces[20][1]);
  const Inspection before = inspect(soup);
  std::vector<Index> number(soup.vertices.size());
  std::iota(number.begin(), number.end(), 0);
  for (int trial = 0; trial < 10; ++trial) {
    std::shuffle(number.begin(), number.end(), random);
    TriangleSoup moved = soup;
    for (std::size_t v = 0; v < number.size(); ++v) moved.vertices[number[v]] = soup.vertices[v];
    std::shuffle(moved.faces.begin(), moved.faces.end(), random);
    for (Triangle& face : moved.faces) {
      for (Index& v : face) v = number[v];
    }
    const Inspection after = inspect(moved);
    EXPECT_EQ(kindsOf(after), kindsOf(before));
    for (std::size_t i = 0; i < before.defects.size(); ++i) {
      EXPECT_EQ(after.defects[i].count, before.defects[i].count);
    }
    EXPECT_EQ(after.counts.genus, before.counts.genus);
    EXPECT_EQ(after.counts.boundary_loops, before.counts.boundary_loops);
  }
}

}  // namespace
}  // namespace moduli
