#include "core/matching/boundary_map.h"

#include <cmath>
#include <numeric>

#include "core/matching/map_report.h"
#include "core/topology/surface_topology.h"
#include "tests/core/matching/cover_samples.h"
#include "tests/core/matching/renumbered.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

// What holds of every boundary map: points are on the boundary, and each loop goes once around.
void expectOnceAround(const TriangleMesh& a, const TriangleMesh& b, const BoundaryMap& map) {
  const auto loops_a = computeTopology(a.connectivity()).boundary_loops;
  const auto loops_b = computeTopology(b.connectivity()).boundary_loops;
  for (std::size_t i = 0; i < loops_a.size(); ++i) {
    const auto& to = loops_b.at(map.loops[i]);
    Index steps = 0;
    for (const Index h : loops_a[i]) {
      const Index v = a.connectivity().tail(h), edge = map.edges[v];
      EXPECT_NE(std::find(to.begin(), to.end(), edge), to.end());
      EXPECT_EQ(map.points[v].face, edge / 3);
      EXPECT_EQ(map.points[v].barycentric[(edge % 3 + 2) % 3], 0);
      EXPECT_GE(map.steps[h], 0);
      steps += map.steps[h];
    }
    EXPECT_EQ(steps, static_cast<Index>(to.size()));
  }
}

TEST(BoundaryMap, OfTheIdentityIsTheIdentity) {
  for (const auto& soup : {*makeSample("annulus", {{"resolution", 4}, {"seed", 3}}),
                           *makeSample("plate", {{"holes", 3}, {"resolution", 2}})}) {
    const TriangleMesh mesh = meshOf(soup);
    const auto map = fitBoundary(mesh, mesh, vertexTargets(mesh, sameNumbers(mesh)));
    ASSERT_OK(map);
    expectOnceAround(mesh, mesh, *map);
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      if (!mesh.connectivity().isBoundaryVertex(v)) continue;
      // Nothing is to be put in order; lengths along loops are sums of as many edges.
      EXPECT_LT((spaceAt(mesh, map->points[v]) - mesh.positions()[v]).norm(), 1e-13);
    }
  }
}

TEST(BoundaryMap, LoopsGoWhereTheirTargetsAre) {
  const TriangleSoup soup = *makeSample("plate", {{"holes", 4}, {"resolution", 2}});
  const Renumbered other = renumbered(soup, 8);
  const TriangleMesh a = meshOf(soup), b = meshOf(other.soup);
  const auto map = fitBoundary(a, b, vertexTargets(b, other.image));
  ASSERT_OK(map);
  expectOnceAround(a, b, *map);
  const auto loops_a = computeTopology(a.connectivity()).boundary_loops;
  const auto loops_b = computeTopology(b.connectivity()).boundary_loops;
  for (std::size_t i = 0; i < loops_a.size(); ++i) {
    const Index v = a.connectivity().tail(loops_a[i][0]);
    bool met = false;
    for (const Index h : loops_b.at(map->loops[i])) {
      met = met || b.connectivity().tail(h) == other.image[v];
    }
    EXPECT_TRUE(met);
  }
}

TEST(BoundaryMap, PutsTargetsInOrder) {
  const TriangleMesh mesh = meshOf(*makeSample("annulus", {{"resolution", 8}}));
  const Connectivity& surface = mesh.connectivity();
  SampleRandom random(4);
  // Targets within the ring, near boundary vertices up to four edges on: out of order.
  std::vector<SurfacePoint> targets = vertexTargets(mesh, sameNumbers(mesh));
  double edge = 0;
  for (const auto& loop : computeTopology(surface).boundary_loops) {
    edge = std::max(
        edge,
        (mesh.positions()[surface.head(loop[0])] - mesh.positions()[surface.tail(loop[0])]).norm());
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::size_t there = (i + loop.size() + random.next() % 9 - 4) % loop.size();
      targets[surface.tail(loop[i])] = vertexPoint(surface, surface.tail(loop[there]));
    }
  }
  const auto map = fitBoundary(mesh, mesh, targets);
  ASSERT_OK(map);
  expectOnceAround(mesh, mesh, *map);
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    if (!surface.isBoundaryVertex(v)) continue;
    // Means of targets that are at most four edges off; the even share adds a thousandth of that.
    EXPECT_LT((spaceAt(mesh, map->points[v]) - mesh.positions()[v]).norm(), 4.01 * edge);
  }
}

TEST(BoundaryMap, GoesAroundEvenWhereTargetsDoNot) {
  const TriangleMesh mesh = meshOf(*makeSample("annulus", {{"resolution", 4}}));
  const std::vector<SurfacePoint> nowhere(mesh.vertexCount(), vertexPoint(mesh.connectivity(), 5));
  const auto map = fitBoundary(mesh, mesh, nowhere);
  ASSERT_OK(map);
  expectOnceAround(mesh, mesh, *map);
}

TEST(BoundaryMap, NeedsAsManyLoops) {
  const TriangleMesh ring = meshOf(*makeSample("annulus", {{"resolution", 3}}));
  const TriangleMesh disk = meshOf(*makeSample("disk", {{"resolution", 3}}));
  const auto map = fitBoundary(
      ring, disk,
      std::vector<SurfacePoint>(ring.vertexCount(), vertexPoint(disk.connectivity(), 0)));
  EXPECT_EQ(map.status().reason(), Reason::kUnsupportedTopology);
}

}  // namespace
}  // namespace moduli
