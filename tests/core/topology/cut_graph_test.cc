#include "core/topology/cut_graph.h"

#include <set>

#include "core/topology/tree_cotree.h"
#include "tests/core/topology/surfaces.h"

namespace moduli {
namespace {

using surfaces::Named;

std::vector<Index> cutsOf(const Connectivity& surface) {
  auto trees = surfaces::loopCount(surface) == 0 ? computeTreeCotree(surface)
                                                 : computeRelativeTreeCotree(surface);
  EXPECT_OK(trees);
  return cutGraph(surface, *trees);
}

/// What remains of a surface that is cut along edges.
struct Pieces {
  Index components = 0;
  Index euler = 0;
};

/// Faces hang together across edges that are not cut, and so do their corners at a vertex.
Pieces cutOpen(const Connectivity& surface, const std::vector<Index>& cuts) {
  const std::set<Index> cut(cuts.begin(), cuts.end());
  DisjointSets faces(surface.faceCount());
  DisjointSets corners(surface.halfedgeCount());
  Pieces pieces{surface.faceCount(), surface.faceCount()};
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    const Index twin = surface.twin(h);
    const bool doubled = cut.count(e) > 0 && twin != kNone;
    pieces.euler -= doubled ? 2 : 1;
    if (doubled || twin == kNone) continue;
    if (faces.join(h / 3, twin / 3)) --pieces.components;
    corners.join(h, Connectivity::next(twin));
    corners.join(twin, Connectivity::next(h));
  }
  for (Index c = 0; c < surface.halfedgeCount(); ++c) {
    if (corners.root(c) == c) ++pieces.euler;
  }
  return pieces;
}

void expectDisk(const Pieces& pieces) {
  EXPECT_EQ(pieces.components, 1);
  EXPECT_EQ(pieces.euler, 1);
}

/// Ends of cuts per vertex.
std::vector<Index> degrees(const Connectivity& surface, const std::vector<Index>& cuts) {
  std::vector<Index> degree(surface.vertexCount(), 0);
  for (const Index e : cuts) {
    ++degree[surface.tail(surface.halfedge(e))];
    ++degree[surface.head(surface.halfedge(e))];
  }
  return degree;
}

std::vector<Named> surfacesToCut() {
  std::vector<Named> list = surfaces::bordered();
  for (Named& named : surfaces::closed()) {
    if (surfaces::genusOf(named.surface) > 0) list.push_back(std::move(named));
  }
  return list;
}

TEST(CutGraph, LeavesADisk) {
  for (const auto& [name, surface] : surfacesToCut()) {
    SCOPED_TRACE(name);
    const std::vector<Index> cuts = cutsOf(surface);
    EXPECT_TRUE(std::is_sorted(cuts.begin(), cuts.end()));
    expectDisk(cutOpen(surface, cuts));
  }
}

TEST(CutGraph, HasNoDanglingEnds) {
  for (const auto& [name, surface] : surfacesToCut()) {
    SCOPED_TRACE(name);
    const std::vector<Index> degree = degrees(surface, cutsOf(surface));
    for (Index v = 0; v < surface.vertexCount(); ++v) {
      if (surface.isBoundaryVertex(v)) continue;
      EXPECT_NE(degree[v], 1) << "vertex " << v;
    }
  }
}

TEST(CutGraph, NeedsEachOfItsEdges) {
  for (const auto& [name, surface] : surfacesToCut()) {
    SCOPED_TRACE(name);
    const std::vector<Index> cuts = cutsOf(surface);
    const std::size_t step = 1 + cuts.size() / 20;
    for (std::size_t k = 0; k < cuts.size(); k += step) {
      std::vector<Index> fewer = cuts;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
      EXPECT_EQ(cutOpen(surface, fewer).euler, 0) << "edge " << cuts[k];
    }
  }
}

TEST(CutGraph, ClosedSurfacesHaveAGraphOfEulerCharacteristicOneMinusTwiceTheGenus) {
  for (const auto& [name, surface] : surfaces::closed()) {
    SCOPED_TRACE(name);
    const Index genus = surfaces::genusOf(surface);
    if (genus == 0) continue;
    const std::vector<Index> cuts = cutsOf(surface);
    const std::vector<Index> degree = degrees(surface, cuts);
    const auto vertices =
        std::count_if(degree.begin(), degree.end(), [](Index d) { return d > 0; });
    EXPECT_EQ(vertices - static_cast<Index>(cuts.size()), 1 - 2 * genus);
  }
}

TEST(CutGraph, RunsAlongNoBoundaryEdge) {
  for (const auto& [name, surface] : surfaces::bordered()) {
    SCOPED_TRACE(name);
    for (const Index e : cutsOf(surface)) EXPECT_FALSE(surface.isBoundaryEdge(e));
  }
}

TEST(CutGraph, IsEmptyOnTheSphereAndTheDisk) {
  EXPECT_TRUE(cutsOf(surfaces::connect(shapes::icosahedron())).empty());
  EXPECT_TRUE(cutsOf(surfaces::doubled(shapes::disk())).empty());
  EXPECT_TRUE(cutsOf(surfaces::connect(shapes::disk())).empty());
}

TEST(CutGraph, OfTheSmallestTorusIsTwoLoops) {
  EXPECT_EQ(cutsOf(surfaces::smallestTorus()).size(), 2);
}

TEST(CutGraph, TheCheckForADiskSeesOtherSurfaces) {
  const Connectivity torus = surfaces::connect(shapes::torusGrid(4, 4));
  EXPECT_EQ(cutOpen(torus, {}).euler, 0);
  std::vector<Index> all(torus.edgeCount());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(cutOpen(torus, all).components, torus.faceCount());
  EXPECT_EQ(cutOpen(torus, all).euler, torus.faceCount());
}

}  // namespace
}  // namespace moduli
