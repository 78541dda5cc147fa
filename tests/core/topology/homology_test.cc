#include "core/topology/homology.h"

#include <cstdlib>
#include <set>

#include "core/topology/tree_cotree.h"
#include "tests/core/topology/surfaces.h"

namespace moduli {
namespace {

using surfaces::allSurfaces;
using surfaces::Named;
using surfaces::relativeTreesOf;
using surfaces::treesOf;

/// Per vertex how often a walk arrives there minus how often it leaves.
std::vector<int> boundaryOf(const Connectivity& surface, const Walk& walk) {
  std::vector<int> boundary(surface.vertexCount(), 0);
  for (const Step& step : walk) {
    ++boundary[surfaces::endOf(surface, step)];
    --boundary[surfaces::startOf(surface, step)];
  }
  return boundary;
}

void expectNoVertexTwice(const Connectivity& surface, const Walk& walk) {
  std::set<Index> met;
  for (const Step& step : walk) {
    EXPECT_TRUE(met.insert(surfaces::startOf(surface, step)).second);
  }
}

TEST(Homology, WalksAreSimpleLoops) {
  for (const auto& [name, surface] : allSurfaces()) {
    SCOPED_TRACE(name);
    const TreeCotree trees = treesOf(surface);
    const std::vector<Walk> walks = homologyBasis(surface, trees);
    ASSERT_EQ(walks.size(), trees.leftover.size());
    for (const Walk& walk : walks) {
      surfaces::expectPath(surface, walk);
      expectNoVertexTwice(surface, walk);
      EXPECT_EQ(boundaryOf(surface, walk), std::vector<int>(surface.vertexCount(), 0));
    }
  }
}

TEST(Homology, WalksAreDualToTheCochains) {
  for (const auto& [name, surface] : allSurfaces()) {
    SCOPED_TRACE(name);
    const TreeCotree trees = treesOf(surface);
    EXPECT_EQ(surfaces::periods(cohomologyBasis(surface, trees), homologyBasis(surface, trees)),
              surfaces::identity(trees.leftover.size()));
  }
}

TEST(Homology, RelativeWalksAreLoopsOrEndOnTheBoundary) {
  int loops = 0;
  int arcs = 0;
  for (const auto& [name, surface] : surfaces::bordered()) {
    SCOPED_TRACE(name);
    for (const Walk& walk : homologyBasis(surface, relativeTreesOf(surface))) {
      surfaces::expectPath(surface, walk);
      expectNoVertexTwice(surface, walk);
      const Index start = surfaces::startOf(surface, walk.front());
      const Index end = surfaces::endOf(surface, walk.back());
      EXPECT_TRUE(start == end || surface.isBoundaryVertex(end));
      EXPECT_EQ(surface.isBoundaryVertex(start), surface.isBoundaryVertex(end));
      ++(surface.isBoundaryVertex(end) ? arcs : loops);
      for (std::size_t i = 1; i < walk.size(); ++i) {
        EXPECT_FALSE(surface.isBoundaryVertex(surfaces::startOf(surface, walk[i])));
      }
      for (const Step& step : walk) EXPECT_FALSE(surface.isBoundaryEdge(step.edge));
    }
  }
  EXPECT_GT(loops, 0);
  EXPECT_GT(arcs, 0);
}

TEST(Homology, RelativeWalksAreDualToTheRelativeCochains) {
  for (const auto& [name, surface] : surfaces::bordered()) {
    SCOPED_TRACE(name);
    const TreeCotree trees = relativeTreesOf(surface);
    EXPECT_EQ(surfaces::periods(cohomologyBasis(surface, trees), homologyBasis(surface, trees)),
              surfaces::identity(trees.leftover.size()));
  }
}

TEST(Homology, AnArcJoinsTheBoundariesOfAnAnnulus) {
  const Connectivity surface = surfaces::connect(shapes::annulus());
  const std::vector<Walk> walks = homologyBasis(surface, relativeTreesOf(surface));
  ASSERT_EQ(walks.size(), 1);
  const auto loops = computeTopology(surface).boundary_loops;
  const auto liesOn = [&](const std::vector<Index>& loop, Index v) {
    return std::any_of(loop.begin(), loop.end(), [&](Index h) { return surface.tail(h) == v; });
  };
  const Index start = surfaces::startOf(surface, walks[0].front());
  const Index end = surfaces::endOf(surface, walks[0].back());
  EXPECT_NE(liesOn(loops[0], start), liesOn(loops[0], end));
}

TEST(Homology, TheLoopOfAnAnnulusIsItsBoundaryUpToDirection) {
  const Connectivity surface = surfaces::connect(shapes::annulus());
  const std::vector<Cochain> cochains = cohomologyBasis(surface, treesOf(surface));
  ASSERT_EQ(cochains.size(), 1);
  Integer sum = 0;
  for (const std::vector<Index>& loop : computeTopology(surface).boundary_loops) {
    Walk walk;
    for (const Index h : loop) walk.push_back({surface.edge(h), surface.sign(h)});
    EXPECT_EQ(std::abs(integrate(cochains[0], walk)), 1);
    sum += integrate(cochains[0], walk);
  }
  EXPECT_EQ(sum, 0);
}

TEST(Homology, BasedLoopsStartAtTheRootAndHaveThePeriodsOfTheFreeOnes) {
  for (const auto& [name, surface] : allSurfaces()) {
    SCOPED_TRACE(name);
    const TreeCotree trees = treesOf(surface);
    std::vector<Walk> loops;
    for (std::size_t k = 0; k < trees.leftover.size(); ++k) {
      loops.push_back(basedLoop(surface, trees, k));
      surfaces::expectPath(surface, loops.back());
      EXPECT_EQ(surfaces::startOf(surface, loops.back().front()), 0);
      EXPECT_EQ(surfaces::endOf(surface, loops.back().back()), 0);
    }
    EXPECT_EQ(surfaces::periods(cohomologyBasis(surface, trees), loops),
              surfaces::identity(loops.size()));
  }
}

TEST(Homology, InverseWalksHaveOppositePeriods) {
  const Connectivity surface = surfaces::connect(shapes::chainOfTori(2));
  const TreeCotree trees = treesOf(surface);
  for (const Walk& walk : homologyBasis(surface, trees)) {
    surfaces::expectPath(surface, inverseWalk(walk));
    EXPECT_EQ(inverseWalk(inverseWalk(walk)), walk);
    for (const Cochain& cochain : cohomologyBasis(surface, trees)) {
      EXPECT_EQ(integrate(cochain, inverseWalk(walk)), -integrate(cochain, walk));
    }
  }
}

TEST(Homology, IntegralsAddUpValuesAlongTheWalk) {
  const Cochain cochain = {{2, 5}, {7, -3}, {9, 1}};
  EXPECT_EQ(integrate(cochain, {}), 0);
  EXPECT_EQ(integrate({}, {{2, 1}}), 0);
  EXPECT_EQ(integrate(cochain, {{2, 1}, {3, 1}, {7, -1}, {2, 1}, {10, 1}}), 13);
  EXPECT_EQ(integrate(cochain, {{0, 1}, {9, -1}}), -1);
}

}  // namespace
}  // namespace moduli
