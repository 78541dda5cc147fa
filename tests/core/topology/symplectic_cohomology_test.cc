#include "core/topology/symplectic_cohomology.h"

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "core/topology/homology.h"
#include "core/topology/homotopy_basis.h"
#include "core/topology/surface_topology.h"
#include "core/topology/tree_cotree.h"
#include "tests/core/topology/surfaces.h"

namespace moduli {
namespace {

void expectClosed(const Connectivity& surface, const Cochain& cochain) {
  std::vector<Integer> dense(surface.edgeCount(), 0);
  for (const CochainTerm& term : cochain) dense[term.edge] = term.value;
  for (Index h = 0; h < surface.halfedgeCount(); h += 3) {
    Integer around = 0;
    for (Index k = h; k < h + 3; ++k) around += surface.sign(k) * dense[surface.edge(k)];
    ASSERT_EQ(around, 0);
  }
}

std::vector<Connectivity> closedSurfaces() {
  std::vector<Connectivity> all;
  std::mt19937 random(2);
  for (const TriangleSoup& soup :
       {shapes::torusGrid(5, 4), shapes::chainOfTori(2), shapes::chainOfTori(5)}) {
    all.push_back(surfaces::connect(soup));
    all.push_back(surfaces::renumbered(all.back(), random));
  }
  all.push_back(surfaces::smallestTorus());
  all.push_back(surfaces::gluedPolygon(surfaces::oppositeSides(4)));
  return all;
}

TEST(SymplecticCohomology, IsAStandardBasisOnEveryClosedSurface) {
  for (const Connectivity& surface : closedSurfaces()) {
    const auto basis = symplecticCohomology(surface);
    ASSERT_OK(basis);
    const auto genus = (2 - surface.eulerCharacteristic()) / 2;
    ASSERT_EQ(static_cast<Index>(basis->size()), 2 * genus);
    for (const Cochain& cochain : *basis) expectClosed(surface, cochain);
    EXPECT_EQ(intersectionMatrix(surface, *basis, *basis), standardSymplecticForm(genus));
    // Unimodular over the loops of the homology, and so a basis of the whole lattice.
    const auto trees = computeTreeCotree(surface);
    ASSERT_OK(trees);
    const auto loops = homologyBasis(surface, *trees);
    Eigen::MatrixXd periods(2 * genus, 2 * genus);
    for (Index a = 0; a < 2 * genus; ++a) {
      for (Index b = 0; b < 2 * genus; ++b) {
        periods(a, b) = static_cast<double>(integrate((*basis)[a], loops[b]));
      }
    }
    EXPECT_NEAR(std::abs(periods.determinant()), 1, 1e-6);
  }
}

TEST(SymplecticCohomology, OfASphereIsEmptyAndOfABorderedSurfaceRefused) {
  const auto none = symplecticCohomology(surfaces::connect(shapes::icosahedron()));
  ASSERT_OK(none);
  EXPECT_TRUE(none->empty());
  EXPECT_THAT(symplecticCohomology(surfaces::connect(shapes::annulus())),
              FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(symplecticCohomology(surfaces::connect(
                  shapes::together(shapes::tetrahedron(), shapes::tetrahedron()))),
              FailsWith(Reason::kUnsupportedTopology));
}

/// The differential of the function that is 1 on a loop and 0 elsewhere.
Cochain loopDifferential(const Connectivity& surface, const std::vector<Index>& loop) {
  std::vector<bool> on(surface.vertexCount(), false);
  for (const Index h : loop) on[surface.tail(h)] = true;
  Cochain result;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    const Integer value = Integer{on[surface.head(h)]} - Integer{on[surface.tail(h)]};
    if (value != 0) result.push_back({e, value});
  }
  return result;
}

Integer periodAround(const Connectivity& surface, const Cochain& cochain,
                     const std::vector<Index>& loop) {
  Walk walk;
  for (const Index h : loop) walk.push_back({surface.edge(h), surface.sign(h)});
  return integrate(cochain, walk);
}

TEST(BorderedCohomology, HasItsProductsAndPeriods) {
  struct Case {
    TriangleSoup soup;
    int holes;
  };
  const std::vector<Case> cases{{shapes::icosahedron(), 1},
                                {shapes::icosahedron(), 3},
                                {shapes::torusGrid(6, 7), 1},
                                {shapes::torusGrid(6, 7), 4},
                                {shapes::chainOfTori(3), 2}};
  for (const Case& each : cases) {
    const Connectivity surface = surfaces::connect(surfaces::withHoles(each.soup, each.holes));
    const SurfaceTopology topology = computeTopology(surface);
    const auto& loops = topology.boundary_loops;
    ASSERT_EQ(static_cast<int>(loops.size()), each.holes);
    const auto found = borderedCohomology(surface, loops);
    ASSERT_OK(found);
    ASSERT_EQ(static_cast<Index>(found->handles.size()), 2 * topology.genus);
    ASSERT_EQ(found->loops.size(), loops.size() - 1);
    EXPECT_EQ(intersectionMatrix(surface, found->handles, found->handles),
              standardSymplecticForm(topology.genus));
    for (const Cochain& handle : found->handles) {
      expectClosed(surface, handle);
      for (const CochainTerm& term : handle) EXPECT_FALSE(surface.isBoundaryEdge(term.edge));
    }
    std::vector<Cochain> differentials;
    for (std::size_t k = 1; k < loops.size(); ++k) {
      differentials.push_back(loopDifferential(surface, loops[k]));
    }
    const auto others = static_cast<Eigen::Index>(differentials.size());
    EXPECT_EQ(intersectionMatrix(surface, found->loops, differentials),
              IntegerMatrix(-IntegerMatrix::Identity(others, others)));
    EXPECT_TRUE(intersectionMatrix(surface, found->loops, found->handles).isZero());
    for (std::size_t k = 0; k < found->loops.size(); ++k) {
      expectClosed(surface, found->loops[k]);
      for (std::size_t loop = 0; loop < loops.size(); ++loop) {
        const Integer expected = loop == 0 ? -1 : (loop == k + 1 ? 1 : 0);
        EXPECT_EQ(periodAround(surface, found->loops[k], loops[loop]), expected);
      }
    }
  }
}

TEST(BorderedCohomology, RefusesClosedAndDisconnectedSurfaces) {
  EXPECT_THAT(borderedCohomology(surfaces::connect(shapes::icosahedron()), {}),
              FailsWith(Reason::kUnsupportedTopology));
}

}  // namespace
}  // namespace moduli
