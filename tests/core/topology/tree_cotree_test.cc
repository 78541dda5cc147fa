#include "core/topology/tree_cotree.h"

#include <Eigen/LU>
#include <algorithm>
#include <numeric>
#include <random>

#include "tests/core/mesh/shapes.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Connectivity connect(const TriangleSoup& soup) {
  auto surface = Connectivity::fromFaces(static_cast<Index>(soup.vertices.size()), soup.faces);
  EXPECT_OK(surface);
  return *std::move(surface);
}

TreeCotree treesOf(const Connectivity& surface) {
  auto trees = computeTreeCotree(surface);
  EXPECT_OK(trees);
  return *std::move(trees);
}

Eigen::MatrixXd intersectionMatrix(const Connectivity& surface,
                                   const std::vector<std::vector<int>>& basis) {
  const auto n = static_cast<Eigen::Index>(basis.size());
  Eigen::MatrixXd j(n, n);
  for (Eigen::Index r = 0; r < n; ++r) {
    for (Eigen::Index c = 0; c < n; ++c) {
      j(r, c) = static_cast<double>(intersectionNumber(surface, basis[r], basis[c]));
    }
  }
  return j;
}

void expectClosed(const Connectivity& surface, const std::vector<int>& cochain) {
  for (Index f = 0; f < surface.faceCount(); ++f) {
    int around = 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      around += surface.sign(h) * cochain[surface.edge(h)];
    }
    EXPECT_EQ(around, 0) << "face " << f;
  }
}

std::vector<TriangleSoup> closedSurfaces() {
  return {shapes::tetrahedron(),   shapes::octahedron(),    shapes::icosahedron(),
          shapes::torusGrid(3, 3), shapes::torusGrid(9, 5), shapes::chainOfTori(2),
          shapes::chainOfTori(3),  shapes::chainOfTori(6)};
}

TEST(TreeCotree, LeavesTwiceTheGenusOverAndSpansTheRest) {
  for (const TriangleSoup& soup : closedSurfaces()) {
    const Connectivity surface = connect(soup);
    const TreeCotree trees = treesOf(surface);
    EXPECT_EQ(static_cast<Index>(trees.leftover.size()), 2 - surface.eulerCharacteristic());
    EXPECT_TRUE(std::is_sorted(trees.leftover.begin(), trees.leftover.end()));
    std::vector<int> used(surface.edgeCount(), 0);
    for (Index v = 0; v < surface.vertexCount(); ++v) {
      if (v == 0) continue;
      ASSERT_NE(trees.vertex_parent[v], kNone);
      EXPECT_EQ(surface.head(trees.vertex_parent[v]), v);
      ++used[surface.edge(trees.vertex_parent[v])];
    }
    for (Index f = 1; f < surface.faceCount(); ++f) {
      ASSERT_NE(trees.face_parent[f], kNone);
      EXPECT_EQ(Connectivity::faceOf(trees.face_parent[f]), f);
      ++used[surface.edge(trees.face_parent[f])];
    }
    for (const Index e : trees.leftover) ++used[e];
    EXPECT_EQ(used, std::vector<int>(surface.edgeCount(), 1));
  }
}

TEST(TreeCotree, CochainsAreClosedAndCrossOneLeftoverEdgeEach) {
  for (const TriangleSoup& soup : closedSurfaces()) {
    const Connectivity surface = connect(soup);
    const TreeCotree trees = treesOf(surface);
    const auto basis = cohomologyBasis(surface, trees);
    ASSERT_EQ(basis.size(), trees.leftover.size());
    for (std::size_t i = 0; i < basis.size(); ++i) {
      expectClosed(surface, basis[i]);
      for (std::size_t k = 0; k < basis.size(); ++k) {
        EXPECT_EQ(basis[i][trees.leftover[k]], i == k ? 1 : 0);
      }
      for (const int value : basis[i]) EXPECT_LE(std::abs(value), 1);
    }
  }
}

TEST(TreeCotree, IntersectionMatrixIsAntisymmetricWithDeterminantOne) {
  for (const TriangleSoup& soup : closedSurfaces()) {
    const Connectivity surface = connect(soup);
    const auto basis = cohomologyBasis(surface, treesOf(surface));
    if (basis.empty()) continue;
    const Eigen::MatrixXd j = intersectionMatrix(surface, basis);
    EXPECT_EQ(j, -j.transpose());
    // Small integers: elimination errs by far less than a half.
    EXPECT_NEAR(j.determinant(), 1, 1e-6);
  }
}

TEST(TreeCotree, ExactCochainsMeetNothing) {
  const Connectivity surface = connect(shapes::chainOfTori(2));
  std::mt19937 random(3);
  std::vector<int> potential(surface.vertexCount());
  for (int& value : potential) value = static_cast<int>(random() % 11) - 5;
  std::vector<int> exact(surface.edgeCount());
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    exact[e] = potential[surface.head(h)] - potential[surface.tail(h)];
  }
  for (const auto& cochain : cohomologyBasis(surface, treesOf(surface))) {
    EXPECT_EQ(intersectionNumber(surface, exact, cochain), 0);
    EXPECT_EQ(intersectionNumber(surface, cochain, exact), 0);
  }
}

TEST(TreeCotree, TorusGridFormsMeetOnceWithTheOrientationOfTheGrid) {
  // du counts steps along the first direction of the grid, dv along the second; as (u, v) is an
  // oriented chart, du ^ dv integrates to +1 per turn, m n over the whole grid.
  constexpr Index kM = 7;
  constexpr Index kN = 5;
  const Connectivity surface = connect(shapes::torusGrid(kM, kN));
  std::vector<int> du(surface.edgeCount());
  std::vector<int> dv(surface.edgeCount());
  const auto step = [](Index from, Index to, Index n) {
    const Index d = (to - from + n) % n;
    return d == n - 1 ? -1 : d;
  };
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    const Index a = surface.tail(h);
    const Index b = surface.head(h);
    du[e] = step(a / kN, b / kN, kM);
    dv[e] = step(a % kN, b % kN, kN);
  }
  expectClosed(surface, du);
  expectClosed(surface, dv);
  EXPECT_EQ(intersectionNumber(surface, du, dv), kM * kN);
  EXPECT_EQ(intersectionNumber(surface, dv, du), -kM * kN);
}

TEST(TreeCotree, RenumberingKeepsTheDeterminant) {
  std::mt19937 random(11);
  const TriangleSoup soup = shapes::chainOfTori(2);
  std::vector<Index> number(soup.vertices.size());
  std::iota(number.begin(), number.end(), 0);
  for (int trial = 0; trial < 20; ++trial) {
    std::shuffle(number.begin(), number.end(), random);
    TriangleSoup moved = soup;
    std::shuffle(moved.faces.begin(), moved.faces.end(), random);
    for (Triangle& face : moved.faces) {
      for (Index& v : face) v = number[v];
    }
    const Connectivity surface = connect(moved);
    const auto basis = cohomologyBasis(surface, treesOf(surface));
    ASSERT_EQ(basis.size(), 4);
    const Eigen::MatrixXd j = intersectionMatrix(surface, basis);
    EXPECT_EQ(j, -j.transpose());
    EXPECT_NEAR(j.determinant(), 1, 1e-6);
  }
}

TEST(TreeCotree, WorksOnATorusOfOneVertexAndTwoFaces) {
  auto surface = Connectivity::fromGluing(1, {{0, 0, 0}, {0, 0, 0}}, {4, 5, 3, 2, 0, 1});
  ASSERT_OK(surface);
  const auto basis = cohomologyBasis(*surface, treesOf(*surface));
  ASSERT_EQ(basis.size(), 2);
  expectClosed(*surface, basis[0]);
  EXPECT_EQ(std::abs(intersectionNumber(*surface, basis[0], basis[1])), 1);
}

TEST(TreeCotree, RefusesBoundaryAndSeveralComponents) {
  EXPECT_THAT(computeTreeCotree(connect(shapes::disk())), FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(
      computeTreeCotree(connect(shapes::together(shapes::tetrahedron(), shapes::tetrahedron()))),
      FailsWith(Reason::kUnsupportedTopology));
}

}  // namespace
}  // namespace moduli
