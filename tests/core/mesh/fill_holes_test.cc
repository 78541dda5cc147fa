#include "core/mesh/fill_holes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/mesh/inspect.h"
#include "core/mesh/read.h"
#include "core/mesh/repair.h"
#include "core/mesh/triangle_geometry.h"
#include "core/mesh/triangulate_loop.h"
#include "tests/core/mesh/shapes.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kAnyLength = 1e9;

Inspection inspect(const TriangleSoup& soup) {
  Context context;
  auto inspection = inspectSoup(context, soup);
  EXPECT_OK(inspection);
  return *std::move(inspection);
}

// Fills, and checks all that must hold whatever the hole.
TriangleSoup fill(const TriangleSoup& soup, double fraction, Index expected) {
  Context context;
  TriangleSoup filled = soup;
  const auto count = fillHoles(context, fraction, filled);
  EXPECT_OK(count);
  EXPECT_EQ(*count, expected);
  const Inspection before = inspect(soup);
  const Inspection after = inspect(filled);
  EXPECT_TRUE(after.valid);
  EXPECT_EQ(after.counts.boundary_loops, before.counts.boundary_loops - expected);
  EXPECT_EQ(after.counts.genus, before.counts.genus);
  EXPECT_TRUE(std::equal(soup.faces.begin(), soup.faces.end(), filled.faces.begin()));
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(filled.vertices[v][i], soup.vertices[v][i]);
  }
  return filled;
}

// A disk of `rings` rings around a round hole with n edges, in the plane.
TriangleSoup roundHole(Index n, Index rings) {
  TriangleSoup soup;
  for (Index r = 0; r <= rings; ++r) {
    for (Index k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * k / n;
      soup.vertices.emplace_back((1 + r) * std::cos(angle), (1 + r) * std::sin(angle), 0);
    }
  }
  for (Index r = 0; r < rings; ++r) {
    for (Index k = 0; k < n; ++k) {
      const Index a = r * n + k;
      const Index b = r * n + (k + 1) % n;
      soup.faces.push_back({a, a + n, b + n});
      soup.faces.push_back({a, b + n, b});
    }
  }
  return soup;
}

TEST(FillHoles, ClosedSurfaceHasNothingToFill) {
  fill(shapes::torusGrid(5, 5), kAnyLength, 0);
}

TEST(FillHoles, MissingFaceComesBack) {
  TriangleSoup soup = shapes::icosahedron();
  const Triangle lost = soup.faces[6];
  soup.faces.erase(soup.faces.begin() + 6);
  const TriangleSoup filled = fill(soup, kAnyLength, 1);
  Triangle found = filled.faces.back();
  std::rotate(found.begin(), std::find(found.begin(), found.end(), lost[0]), found.end());
  EXPECT_EQ(found, lost);
}

TEST(FillHoles, FlatConcaveHoleIsFilledWithoutOverlap) {
  // An L-shaped hole: the new faces cover its three squares, none twice and none outside.
  const auto keep = [](Index i, Index j) {
    return !((i == 2 && j == 2) || (i == 3 && j == 2) || (i == 2 && j == 3));
  };
  const TriangleSoup soup = shapes::plate(6, 6, keep);
  const TriangleSoup filled = fill(soup, 2.0, 1);
  EXPECT_EQ(filled.vertices.size(), soup.vertices.size());
  // Integer coordinates: areas are exact.
  EXPECT_EQ(inspect(filled).counts.area, 36);
  for (std::size_t f = soup.faces.size(); f < filled.faces.size(); ++f) {
    const Eigen::Vector3d& a = filled.vertices[filled.faces[f][0]];
    const Eigen::Vector3d ab = filled.vertices[filled.faces[f][1]] - a;
    const Eigen::Vector3d ac = filled.vertices[filled.faces[f][2]] - a;
    EXPECT_GT(ab.cross(ac).z(), 0);
  }
}

TEST(FillHoles, OnlyLoopsShorterThanTheFraction) {
  // Holes of length 4 and the rim of length 24; the area is 35, its root 5.916.
  const TriangleSoup soup = shapes::plate(6, 6, [](Index i, Index j) { return i != 2 || j != 3; });
  const double root = std::sqrt(35.0);
  fill(soup, 3.99 / root, 0);
  fill(soup, 4.01 / root, 1);
  fill(soup, 23.9 / root, 1);
  fill(soup, 24.1 / root, 2);
}

TEST(FillHoles, ScaleChangesNothing) {
  const TriangleSoup soup = roundHole(9, 3);
  const TriangleSoup filled = fill(soup, 1.5, 1);
  for (const double scale : {0x1p-300, 0x1p300}) {
    TriangleSoup scaled = soup;
    for (auto& p : scaled.vertices) p *= scale;
    EXPECT_EQ(fill(scaled, 1.5, 1).faces, filled.faces);
  }
}

TEST(FillHoles, LengthIsComparedWithTheComponentsOwnArea) {
  const TriangleSoup small = shapes::plate(6, 6, [](Index i, Index j) { return i != 2 || j != 3; });
  TriangleSoup large = shapes::octahedron();
  for (auto& p : large.vertices) p *= 1e6;
  fill(shapes::together(small, large), 3.99 / std::sqrt(35.0), 0);
}

TEST(FillHoles, LoneTriangleGetsATip) {
  // The only triangle that fits is the one that is there.
  const TriangleSoup soup = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const TriangleSoup filled = fill(soup, kAnyLength, 1);
  EXPECT_EQ(filled.faces.size(), 4);
  EXPECT_EQ(filled.vertices.size(), 4);
}

TEST(FillHoles, DiagonalsThatExistAreNotMadeTwice) {
  // The rim of two triangles is a quadrangle, one of whose diagonals is their common edge.
  const TriangleSoup two = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  EXPECT_EQ(fill(two, kAnyLength, 1).faces.size(), 4);
  // Two faces of a tetrahedron: here the free diagonal is the edge that was lost.
  TriangleSoup open = shapes::tetrahedron();
  open.faces.resize(2);
  EXPECT_EQ(fill(open, kAnyLength, 1).vertices.size(), 4);
}

TEST(FillHoles, LoopsOfOneSurfaceAreFilledOneAfterTheOther) {
  fill(shapes::annulus(), kAnyLength, 2);
  fill(shapes::pants(), kAnyLength, 3);
}

TEST(FillHoles, BothEndsOfANarrowPrismAreFilledWithoutClash) {
  for (const Index n : {3, 4, 5, 8, 40}) {
    TriangleSoup prism = roundHole(n, 1);
    for (std::size_t v = n; v < prism.vertices.size(); ++v) {
      prism.vertices[v] = prism.vertices[v - n] - Eigen::Vector3d(0, 0, 2);
    }
    fill(prism, kAnyLength, 2);
  }
}

TEST(FillHoles, LongLoopsGetACentre) {
  const TriangleSoup soup = roundHole(300, 2);
  const TriangleSoup filled = fill(soup, 1.3, 1);
  ASSERT_EQ(filled.vertices.size(), soup.vertices.size() + 1);
  // The regular polygon's centre, up to the rounding of 300 terms.
  EXPECT_LT(filled.vertices.back().norm(), 1e-13);
  EXPECT_EQ(filled.faces.size(), soup.faces.size() + 300);
}

TEST(FillHoles, RegularPolygonIsFilledWithoutSlivers) {
  const TriangleSoup soup = roundHole(64, 2);
  const TriangleSoup filled = fill(soup, 1.3, 1);
  const double polygon = 32 * std::sin(2 * std::numbers::pi / 64);
  double sum = 0;
  for (std::size_t f = soup.faces.size(); f < filled.faces.size(); ++f) {
    const Triangle& t = filled.faces[f];
    const TriangleShape shape =
        triangleShape(filled.vertices[t[0]], filled.vertices[t[1]], filled.vertices[t[2]]);
    sum += shape.area;
    // The ear of two sides has 0.0123, and something has to be an ear.
    EXPECT_GT(shape.relative_area, 0.012);
  }
  // Sixty-two areas that round to 1e-16 each.
  EXPECT_NEAR(sum, polygon, 1e-13);
}

TEST(FillHoles, StopsWhenCancelled) {
  Context context;
  CancelToken token;
  context.setCancelToken(token);
  token.cancel();
  TriangleSoup soup = shapes::annulus();
  EXPECT_THAT(fillHoles(context, 1, soup), FailsWith(Reason::kCancelled));
}

TEST(FillHoles, RepairLeavesWhatIsNoSurfaceOpen) {
  Context context;
  const auto kept = repairSoup(context, shapes::bowTie(), {false, kAnyLength});
  ASSERT_OK(kept);
  EXPECT_EQ(kept->soup.faces, shapes::bowTie().faces);
  const auto mended = repairSoup(context, shapes::bowTie(), {true, kAnyLength});
  ASSERT_OK(mended);
  EXPECT_TRUE(inspect(mended->soup).valid);
  EXPECT_EQ(inspect(mended->soup).counts.boundary_loops, 0);
  EXPECT_EQ(mended->actions.back().action, "fill holes");
  EXPECT_EQ(mended->actions.back().count, 2);
  EXPECT_EQ(mended->input_face[0], 0);
  EXPECT_EQ(mended->input_face.back(), kNone);
  EXPECT_EQ(mended->input_vertex.back(), kNone);
}

TEST(FillHoles, RealMeshesCloseUp) {
  if (sharedMeshes("disk").empty()) {
    GTEST_SKIP() << "needs the shared meshes; set MODULI_SHARED to the folder with meshes/";
  }
  for (const char* folder : {"disk", "multi_boundary", "genus2"}) {
    for (const std::string& path : sharedMeshes(folder)) {
      SCOPED_TRACE(path);
      Context context;
      const auto soup = readMeshFile(context, path);
      ASSERT_OK(soup);
      fill(*soup, kAnyLength, inspect(*soup).counts.boundary_loops);
    }
  }
}

TEST(TriangulateLoop, SaysSoWhereEveryTriangulationIsBlocked) {
  Context context;
  const SpaceLoop square = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                            std::vector<Eigen::Vector3d>(4, Eigen::Vector3d(0, 0, 1))};
  const auto open = triangulateLoop(context, square, [](Index, Index) { return false; });
  ASSERT_OK(open);
  EXPECT_EQ((*open)->size(), 2);
  const auto shut = triangulateLoop(context, square, [](Index, Index) { return true; });
  ASSERT_OK(shut);
  EXPECT_FALSE(shut->has_value());
}

}  // namespace
}  // namespace moduli
