#include "core/topology/tree_cotree.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstdlib>

#include "core/topology/homology.h"
#include "tests/core/topology/surfaces.h"

namespace moduli {
namespace {

using surfaces::allSurfaces;
using surfaces::connect;
using surfaces::Named;
using surfaces::relativeTreesOf;
using surfaces::treesOf;

Integer valueOn(const Cochain& cochain, Index edge) {
  return integrate(cochain, {{edge, 1}});
}

void expectClosed(const Connectivity& surface, const Cochain& cochain) {
  for (Index f = 0; f < surface.faceCount(); ++f) {
    Integer around = 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      around += surface.sign(h) * valueOn(cochain, surface.edge(h));
    }
    EXPECT_EQ(around, 0) << "face " << f;
  }
}

/// Closed, small, and 1 on the own leftover edge alone of these and of the vertices' tree.
void expectCohomologyBasis(const Connectivity& surface, const TreeCotree& trees) {
  const std::vector<Cochain> basis = cohomologyBasis(surface, trees);
  ASSERT_EQ(basis.size(), trees.leftover.size());
  for (std::size_t i = 0; i < basis.size(); ++i) {
    expectClosed(surface, basis[i]);
    for (std::size_t k = 0; k < basis.size(); ++k) {
      EXPECT_EQ(valueOn(basis[i], trees.leftover[k]), i == k ? 1 : 0);
    }
    for (const Index h : trees.vertex_parent) {
      if (h == kNone) continue;
      EXPECT_EQ(valueOn(basis[i], surface.edge(h)), 0);
    }
    for (const CochainTerm& term : basis[i]) EXPECT_EQ(std::abs(term.value), 1);
    EXPECT_TRUE(
        std::is_sorted(basis[i].begin(), basis[i].end(),
                       [](const CochainTerm& a, const CochainTerm& b) { return a.edge < b.edge; }));
  }
}

/// Per edge in how many of the trees and the leftover it is. Parents must lead where they should.
std::vector<int> usesOfEdges(const Connectivity& surface, const TreeCotree& trees) {
  std::vector<int> used(surface.edgeCount(), 0);
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    const Index h = trees.vertex_parent[v];
    if (h == kNone) continue;
    EXPECT_EQ(surface.head(h), v);
    ++used[surface.edge(h)];
  }
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const Index h = trees.face_parent[f];
    if (h == kNone) continue;
    EXPECT_EQ(Connectivity::faceOf(h), f);
    ++used[surface.edge(h)];
  }
  for (const Index e : trees.leftover) ++used[e];
  return used;
}

Index rootCount(const std::vector<Index>& parent) {
  return static_cast<Index>(std::count(parent.begin(), parent.end(), kNone));
}

/// Of a matrix of small integers: elimination errs by far less than a half.
double determinant(const IntegerMatrix& matrix) {
  return matrix.cast<double>().determinant();
}

TEST(TreeCotree, LeavesOneMinusTheEulerCharacteristicOverAndSpansTheRest) {
  for (const auto& [name, surface] : allSurfaces()) {
    SCOPED_TRACE(name);
    const TreeCotree trees = treesOf(surface);
    const Index loops = surfaces::loopCount(surface);
    EXPECT_EQ(static_cast<Index>(trees.leftover.size()),
              (loops == 0 ? 2 : 1) - surface.eulerCharacteristic());
    EXPECT_TRUE(std::is_sorted(trees.leftover.begin(), trees.leftover.end()));
    EXPECT_EQ(rootCount(trees.vertex_parent), 1);
    EXPECT_EQ(trees.vertex_parent[0], kNone);
    // With a boundary the root is the face outside.
    EXPECT_EQ(rootCount(trees.face_parent), loops == 0 ? 1 : 0);
    EXPECT_EQ(usesOfEdges(surface, trees), std::vector<int>(surface.edgeCount(), 1));
  }
}

TEST(TreeCotree, RelativeTreesGrowFromTheWholeBoundaryAndUseInnerEdgesAlone) {
  for (const auto& [name, surface] : surfaces::bordered()) {
    SCOPED_TRACE(name);
    const TreeCotree trees = relativeTreesOf(surface);
    EXPECT_EQ(static_cast<Index>(trees.leftover.size()), 1 - surface.eulerCharacteristic());
    EXPECT_TRUE(std::is_sorted(trees.leftover.begin(), trees.leftover.end()));
    for (Index v = 0; v < surface.vertexCount(); ++v) {
      EXPECT_EQ(trees.vertex_parent[v] == kNone, surface.isBoundaryVertex(v)) << "vertex " << v;
    }
    EXPECT_EQ(rootCount(trees.face_parent), 1);
    std::vector<int> inner(surface.edgeCount());
    for (Index e = 0; e < surface.edgeCount(); ++e) inner[e] = surface.isBoundaryEdge(e) ? 0 : 1;
    EXPECT_EQ(usesOfEdges(surface, trees), inner);
  }
}

TEST(TreeCotree, CochainsAreClosedAndCrossOneLeftoverEdgeEach) {
  for (const auto& [name, surface] : allSurfaces()) {
    SCOPED_TRACE(name);
    expectCohomologyBasis(surface, treesOf(surface));
  }
}

TEST(TreeCotree, RelativeCochainsAreClosedAndVanishOnTheBoundary) {
  for (const auto& [name, surface] : surfaces::bordered()) {
    SCOPED_TRACE(name);
    const TreeCotree trees = relativeTreesOf(surface);
    expectCohomologyBasis(surface, trees);
    for (const Cochain& cochain : cohomologyBasis(surface, trees)) {
      for (const CochainTerm& term : cochain) EXPECT_FALSE(surface.isBoundaryEdge(term.edge));
    }
  }
}

TEST(TreeCotree, IntersectionMatrixIsAntisymmetricWithDeterminantOne) {
  for (const auto& [name, surface] : surfaces::closed()) {
    SCOPED_TRACE(name);
    const auto basis = cohomologyBasis(surface, treesOf(surface));
    if (basis.empty()) continue;
    const IntegerMatrix j = intersectionMatrix(surface, basis, basis);
    EXPECT_EQ(j, -j.transpose());
    EXPECT_NEAR(determinant(j), 1, 1e-6);
  }
}

TEST(TreeCotree, RelativeIntersectionMatrixHasTheRankOfTheHandles) {
  for (const auto& [name, surface] : surfaces::bordered()) {
    SCOPED_TRACE(name);
    const auto basis = cohomologyBasis(surface, relativeTreesOf(surface));
    if (basis.empty()) continue;
    const IntegerMatrix j = intersectionMatrix(surface, basis, basis);
    EXPECT_EQ(j, -j.transpose());
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(j.cast<double>());
    EXPECT_EQ(lu.rank(), 2 * surfaces::genusOf(surface));
    EXPECT_EQ(lu.dimensionOfKernel(), surfaces::loopCount(surface) - 1);
  }
}

TEST(TreeCotree, AbsoluteAndRelativeCochainsPairPerfectly) {
  for (const auto& [name, surface] : surfaces::bordered()) {
    SCOPED_TRACE(name);
    const auto absolute = cohomologyBasis(surface, treesOf(surface));
    const auto relative = cohomologyBasis(surface, relativeTreesOf(surface));
    ASSERT_EQ(absolute.size(), relative.size());
    if (absolute.empty()) continue;
    const IntegerMatrix pairing = intersectionMatrix(surface, relative, absolute);
    EXPECT_NEAR(std::abs(determinant(pairing)), 1, 1e-6);
    EXPECT_EQ(intersectionMatrix(surface, absolute, relative), -pairing.transpose());
  }
}

TEST(TreeCotree, ExactCochainsMeetNothing) {
  const Connectivity surface = connect(shapes::chainOfTori(2));
  std::mt19937 random(3);
  std::vector<Integer> potential(surface.vertexCount());
  for (Integer& value : potential) value = static_cast<Integer>(random() % 11) - 5;
  std::vector<CochainTerm> terms;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    terms.push_back({e, potential[surface.head(h)] - potential[surface.tail(h)]});
  }
  const Cochain exact = gatherTerms(terms);
  const auto basis = cohomologyBasis(surface, treesOf(surface));
  EXPECT_EQ(intersectionMatrix(surface, {exact}, basis), IntegerMatrix::Zero(1, 4));
  EXPECT_EQ(intersectionMatrix(surface, basis, {exact}), IntegerMatrix::Zero(4, 1));
}

TEST(TreeCotree, TorusGridFormsMeetOnceWithTheOrientationOfTheGrid) {
  // du counts steps along the first direction of the grid, dv along the second; as (u, v) is an
  // oriented chart, du ^ dv integrates to +1 per turn, m n over the whole grid.
  constexpr Index kM = 7;
  constexpr Index kN = 5;
  const Connectivity surface = connect(shapes::torusGrid(kM, kN));
  const auto step = [](Index from, Index to, Index n) {
    const Index d = (to - from + n) % n;
    return d == n - 1 ? -1 : d;
  };
  Cochain du;
  Cochain dv;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    const Index a = surface.tail(h);
    const Index b = surface.head(h);
    du.push_back({e, step(a / kN, b / kN, kM)});
    dv.push_back({e, step(a % kN, b % kN, kN)});
  }
  expectClosed(surface, du);
  expectClosed(surface, dv);
  IntegerMatrix expected(2, 2);
  expected << 0, kM * kN, -kM * kN, 0;
  EXPECT_EQ(intersectionMatrix(surface, {du, dv}, {du, dv}), expected);
}

TEST(TreeCotree, RenumberingKeepsTheDeterminant) {
  std::mt19937 random(11);
  const Connectivity original = connect(shapes::chainOfTori(2));
  for (int trial = 0; trial < 20; ++trial) {
    const Connectivity surface = surfaces::renumbered(original, random);
    const auto basis = cohomologyBasis(surface, treesOf(surface));
    ASSERT_EQ(basis.size(), 4);
    const IntegerMatrix j = intersectionMatrix(surface, basis, basis);
    EXPECT_EQ(j, -j.transpose());
    EXPECT_NEAR(determinant(j), 1, 1e-6);
  }
}

TEST(TreeCotree, RenumberingKeepsThePairingWithBoundary) {
  std::mt19937 random(12);
  const Connectivity original = connect(surfaces::withHoles(shapes::chainOfTori(2), 3));
  for (int trial = 0; trial < 20; ++trial) {
    const Connectivity surface = surfaces::renumbered(original, random);
    const auto absolute = cohomologyBasis(surface, treesOf(surface));
    const auto relative = cohomologyBasis(surface, relativeTreesOf(surface));
    ASSERT_EQ(absolute.size(), 6);
    ASSERT_EQ(relative.size(), 6);
    EXPECT_NEAR(std::abs(determinant(intersectionMatrix(surface, relative, absolute))), 1, 1e-6);
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(
        intersectionMatrix(surface, relative, relative).cast<double>());
    EXPECT_EQ(lu.rank(), 4);
  }
}

TEST(TreeCotree, WorksOnATorusOfOneVertexAndTwoFaces) {
  const Connectivity surface = surfaces::smallestTorus();
  const auto basis = cohomologyBasis(surface, treesOf(surface));
  ASSERT_EQ(basis.size(), 2);
  expectClosed(surface, basis[0]);
  EXPECT_EQ(std::abs(intersectionMatrix(surface, basis, basis)(0, 1)), 1);
}

TEST(TreeCotree, RefusesSeveralComponents) {
  const std::vector<std::pair<TriangleSoup, TriangleSoup>> pairs = {
      {shapes::tetrahedron(), shapes::tetrahedron()},
      {shapes::disk(), shapes::annulus()},
      {shapes::tetrahedron(), shapes::disk()},
      {shapes::disk(), shapes::tetrahedron()}};
  for (const auto& [a, b] : pairs) {
    const Connectivity surface = connect(shapes::together(a, b));
    EXPECT_THAT(computeTreeCotree(surface), FailsWith(Reason::kUnsupportedTopology));
    EXPECT_THAT(computeRelativeTreeCotree(surface), FailsWith(Reason::kUnsupportedTopology));
  }
}

TEST(TreeCotree, RelativeTreesNeedABoundary) {
  EXPECT_THAT(computeRelativeTreeCotree(connect(shapes::torusGrid(4, 4))),
              FailsWith(Reason::kUnsupportedTopology));
}

}  // namespace
}  // namespace moduli
