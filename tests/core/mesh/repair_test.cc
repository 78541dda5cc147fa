#include "core/mesh/repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "tests/core/mesh/shapes.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Repaired repair(const TriangleSoup& soup, const RepairOptions& options = {true, {}}) {
  Context context;
  auto repaired = repairSoup(context, soup, options);
  EXPECT_OK(repaired);
  return *std::move(repaired);
}

Inspection inspect(const TriangleSoup& soup) {
  Context context;
  auto inspection = inspectSoup(context, soup);
  EXPECT_OK(inspection);
  return *std::move(inspection);
}

std::vector<std::string> actionsOf(const Repaired& repaired) {
  std::vector<std::string> actions;
  for (const RepairAction& action : repaired.actions) {
    actions.push_back(action.action + " " + std::to_string(action.count));
  }
  return actions;
}

// Every face its own three vertices, as in an STL file.
TriangleSoup unwelded(const TriangleSoup& soup) {
  TriangleSoup apart;
  for (const Triangle& face : soup.faces) {
    const auto base = static_cast<Index>(apart.vertices.size());
    for (const Index v : face) apart.vertices.push_back(soup.vertices[v]);
    apart.faces.push_back({base, base + 1, base + 2});
  }
  return apart;
}

double signedVolume(const TriangleSoup& soup) {
  double volume = 0;
  for (const Triangle& face : soup.faces) {
    const Eigen::Vector3d& a = soup.vertices[face[0]];
    volume += a.dot(soup.vertices[face[1]].cross(soup.vertices[face[2]])) / 6;
  }
  return volume;
}

void expectSame(const TriangleSoup& a, const TriangleSoup& b) {
  EXPECT_EQ(a.faces, b.faces);
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(a.vertices[v][i], b.vertices[v][i]);
  }
}

TEST(Repair, SoundSurfacesStayAsTheyAre) {
  for (const TriangleSoup& soup : {shapes::tetrahedron(), shapes::torusGrid(5, 7), shapes::pants(),
                                   shapes::together(shapes::disk(), shapes::icosahedron())}) {
    const Repaired repaired = repair(soup);
    expectSame(repaired.soup, soup);
    EXPECT_THAT(repaired.actions, IsEmpty());
  }
}

TEST(Repair, WithoutOptionsReturnsTheSoup) {
  TriangleSoup soup = shapes::bowTie();
  soup.faces.push_back({1, 1, 1});
  const Repaired repaired = repair(soup, {});
  expectSame(repaired.soup, soup);
  EXPECT_THAT(repaired.actions, IsEmpty());
}

TEST(Repair, WeldsFacesIntoTheirSurface) {
  for (const TriangleSoup& soup : {shapes::icosahedron(), shapes::torusGrid(6, 5)}) {
    const Repaired repaired = repair(unwelded(soup));
    const Inspection inspection = inspect(repaired.soup);
    EXPECT_TRUE(inspection.valid);
    EXPECT_THAT(inspection.defects, IsEmpty());
    EXPECT_EQ(inspection.counts.vertices, soup.vertices.size());
    EXPECT_EQ(inspection.counts.boundary_loops, 0);
    EXPECT_EQ(repaired.actions[0].count, 3 * soup.faces.size() - soup.vertices.size());
    for (std::size_t f = 0; f < soup.faces.size(); ++f) {
      EXPECT_EQ(repaired.input_face[f], f);
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(repaired.soup.vertices[repaired.soup.faces[f][c]],
                  soup.vertices[soup.faces[f][c]]);
      }
    }
  }
}

TEST(Repair, DoesNotWeldWhereAnEdgeWouldGetMoreThanTwoFaces) {
  // Two tetrahedra that touch along an edge.
  TriangleSoup soup = shapes::tetrahedron();
  const Eigen::Vector3d along = soup.vertices[0] - soup.vertices[1];
  TriangleSoup other = soup;
  for (Eigen::Vector3d& p : other.vertices) {
    // Half a turn about the edge (0, 1).
    const Eigen::Vector3d axis = along.normalized();
    const Eigen::Vector3d q = p - soup.vertices[1];
    p = soup.vertices[1] + 2 * q.dot(axis) * axis - q;
  }
  other.vertices[0] = soup.vertices[0];
  other.vertices[1] = soup.vertices[1];
  const TriangleSoup pair = shapes::together(soup, other, {0, 0, 0});
  const Repaired repaired = repair(pair);
  expectSame(repaired.soup, pair);
  EXPECT_THAT(repaired.actions, IsEmpty());
  EXPECT_TRUE(inspect(repaired.soup).valid);
}

TEST(Repair, DoesNotCollapseTwoSheetsInTheSamePlace) {
  // A flattened sphere: front and back have equal coordinates all over.
  const TriangleSoup front = shapes::disk();
  TriangleSoup back = front;
  for (Triangle& face : back.faces) std::swap(face[1], face[2]);
  const TriangleSoup pair = shapes::together(front, back, {0, 0, 0});
  EXPECT_EQ(repair(pair).soup.faces.size(), pair.faces.size());
  EXPECT_TRUE(inspect(repair(pair).soup).valid);
}

TEST(Repair, DoesNotWeldAStripIntoAMoebiusStrip) {
  TriangleSoup soup = shapes::moebiusStrip(8);
  // Open it: the last quad gets vertices of its own, in the same places.
  for (std::size_t f = soup.faces.size() - 2; f < soup.faces.size(); ++f) {
    for (Index& v : soup.faces[f]) {
      if (v > 1) continue;
      soup.vertices.push_back(Eigen::Vector3d(soup.vertices[v]));
      v = static_cast<Index>(soup.vertices.size()) - 1;
    }
  }
  ASSERT_TRUE(inspect(repair(soup).soup).counts.orientable);
  EXPECT_EQ(repair(soup).soup.faces.size(), soup.faces.size());
}

TEST(Repair, DropsFacesThatCarryNothing) {
  TriangleSoup soup = shapes::icosahedron();
  soup.faces.insert(soup.faces.begin() + 4, {3, 3, 7});
  soup.faces.push_back({soup.faces[9][1], soup.faces[9][2], soup.faces[9][0]});
  soup.vertices.emplace_back(4, 4, 4);
  const Repaired repaired = repair(soup);
  EXPECT_THAT(actionsOf(repaired), ElementsAre("drop degenerate faces 1", "drop duplicate faces 1",
                                               "drop isolated vertices 1"));
  expectSame(repaired.soup, shapes::icosahedron());
  std::vector<Index> input_face(20);
  std::iota(input_face.begin(), input_face.end(), 0);
  for (std::size_t f = 4; f < 20; ++f) ++input_face[f];
  EXPECT_EQ(repaired.input_face, input_face);
}

TEST(Repair, ReorientsOutwardsWhereAVolumeIsEnclosed) {
  for (std::size_t turned = 1; turned < 20; ++turned) {
    TriangleSoup soup = shapes::icosahedron();
    for (std::size_t f = 0; f < turned; ++f) std::swap(soup.faces[f][1], soup.faces[f][2]);
    const Repaired repaired = repair(soup);
    EXPECT_TRUE(inspect(repaired.soup).valid);
    EXPECT_GT(signedVolume(repaired.soup), 0);
    EXPECT_THAT(actionsOf(repaired), ElementsAre("re-orient faces " + std::to_string(turned)));
  }
}

TEST(Repair, ReorientsAnOpenSurfaceToItsLowestFace) {
  TriangleSoup soup = shapes::annulus();
  for (std::size_t f = 1; f < soup.faces.size(); f += 2) {
    std::swap(soup.faces[f][1], soup.faces[f][2]);
  }
  const Repaired repaired = repair(soup);
  EXPECT_EQ(repaired.soup.faces, shapes::annulus().faces);
}

TEST(Repair, LeavesAConsistentInsideOutSurface) {
  TriangleSoup soup = shapes::octahedron();
  for (Triangle& face : soup.faces) std::swap(face[1], face[2]);
  expectSame(repair(soup).soup, soup);
}

TEST(Repair, OrientationDoesNotDependOnScale) {
  for (const double scale : {1e-120, 1e120}) {
    TriangleSoup soup = shapes::icosahedron();
    for (auto& p : soup.vertices) p *= scale;
    std::swap(soup.faces[0][1], soup.faces[0][2]);
    EXPECT_EQ(repair(soup).soup.faces[1], shapes::icosahedron().faces[1]);
  }
}

TEST(Repair, SplitsPinchedVertices) {
  TriangleSoup soup = shapes::bowTie();
  const Repaired repaired = repair(soup);
  EXPECT_THAT(actionsOf(repaired), ElementsAre("split pinched vertices 1"));
  EXPECT_TRUE(inspect(repaired.soup).valid);
  EXPECT_THAT(repaired.input_vertex, ElementsAre(0, 1, 2, 3, 4, 0));
  EXPECT_EQ(repaired.soup.faces, (std::vector<Triangle>{{0, 1, 2}, {5, 3, 4}}));
}

TEST(Repair, KeepsWhatCannotBeMended) {
  const Repaired crowded = repair(shapes::threeAtAnEdge());
  expectSame(crowded.soup, shapes::threeAtAnEdge());
  EXPECT_EQ(inspect(crowded.soup).defects[0].kind, DefectKind::kNonManifoldEdge);

  const Repaired one_sided = repair(shapes::moebiusStrip(7));
  expectSame(one_sided.soup, shapes::moebiusStrip(7));
  EXPECT_EQ(inspect(one_sided.soup).defects[0].kind, DefectKind::kNonOrientable);

  TriangleSoup infinite = shapes::octahedron();
  infinite.vertices[3].y() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(inspect(repair(infinite).soup).defects[0].kind, DefectKind::kNonFiniteCoordinate);
}

TEST(Repair, IsDoneInOneGo) {
  TriangleSoup soup = shapes::together(shapes::bowTie(), unwelded(shapes::octahedron()));
  soup.faces.push_back({0, 0, 1});
  std::swap(soup.faces[5][0], soup.faces[5][1]);
  const Repaired once = repair(soup);
  EXPECT_TRUE(inspect(once.soup).valid);
  const Repaired twice = repair(once.soup);
  EXPECT_THAT(twice.actions, IsEmpty());
  expectSame(twice.soup, once.soup);
}

TEST(Repair, ProposalIsWhatRepairDoes) {
  TriangleSoup soup = unwelded(shapes::octahedron());
  soup.vertices.emplace_back(9, 9, 9);
  Context context;
  const auto proposed = proposeRepair(context, soup);
  ASSERT_OK(proposed);
  const Repaired repaired = repair(soup);
  ASSERT_EQ(proposed->size(), repaired.actions.size());
  for (std::size_t i = 0; i < proposed->size(); ++i) {
    EXPECT_EQ((*proposed)[i].action, repaired.actions[i].action);
    EXPECT_EQ((*proposed)[i].count, repaired.actions[i].count);
  }
}

TEST(Repair, RefusesAFractionThatIsNone) {
  Context context;
  for (const double fraction : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(repairSoup(context, shapes::disk(), {false, fraction}),
                FailsWith(Reason::kInvalidOption));
  }
}

}  // namespace
}  // namespace moduli
