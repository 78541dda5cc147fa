#include "core/topology/surface_topology.h"

#include "tests/core/mesh/shapes.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Connectivity connect(const TriangleSoup& soup) {
  auto surface = Connectivity::fromFaces(static_cast<Index>(soup.vertices.size()), soup.faces);
  EXPECT_OK(surface);
  return *std::move(surface);
}

struct Expected {
  TriangleSoup soup;
  Index components, loops, genus, euler;
};

TEST(SurfaceTopology, KnownSurfaces) {
  const std::vector<Expected> table = {
      {shapes::tetrahedron(), 1, 0, 0, 2},
      {shapes::octahedron(), 1, 0, 0, 2},
      {shapes::icosahedron(), 1, 0, 0, 2},
      {shapes::torusGrid(5, 4), 1, 0, 1, 0},
      {shapes::chainOfTori(2), 1, 0, 2, -2},
      {shapes::chainOfTori(5), 1, 0, 5, -8},
      {shapes::disk(), 1, 1, 0, 1},
      {shapes::annulus(), 1, 2, 0, 0},
      {shapes::pants(), 1, 3, 0, -1},
      {shapes::together(shapes::torusGrid(4, 4), shapes::chainOfTori(2)), 2, 0, 3, -2},
      {shapes::together(shapes::disk(), shapes::annulus()), 2, 3, 0, 1},
  };
  for (const Expected& expected : table) {
    const SurfaceTopology topology = computeTopology(connect(expected.soup));
    EXPECT_EQ(topology.components, expected.components);
    EXPECT_EQ(topology.boundary_loops.size(), expected.loops);
    EXPECT_EQ(topology.genus, expected.genus);
    EXPECT_EQ(topology.euler_characteristic, expected.euler);
  }
}

TEST(SurfaceTopology, PuncturedTorusKeepsItsGenus) {
  TriangleSoup soup = shapes::torusGrid(6, 6);
  soup.faces.erase(soup.faces.begin() + 17);
  const SurfaceTopology topology = computeTopology(connect(soup));
  EXPECT_EQ(topology.genus, 1);
  ASSERT_EQ(topology.boundary_loops.size(), 1);
  EXPECT_EQ(topology.boundary_loops[0].size(), 3);
}

TEST(SurfaceTopology, LoopsAreChainsOfBoundaryHalfedges) {
  const Connectivity surface = connect(shapes::pants());
  const SurfaceTopology topology = computeTopology(surface);
  std::size_t total = 0;
  for (const auto& loop : topology.boundary_loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      EXPECT_EQ(surface.twin(loop[i]), kNone);
      EXPECT_EQ(surface.head(loop[i]), surface.tail(loop[(i + 1) % loop.size()]));
    }
    total += loop.size();
  }
  EXPECT_EQ(total, 16 + 4 + 4);
}

TEST(SurfaceTopology, ComponentsAreNumberedByTheirLowestFace) {
  TriangleSoup soup = shapes::together(shapes::tetrahedron(), shapes::tetrahedron());
  std::swap(soup.faces[0], soup.faces[5]);
  const SurfaceTopology topology = computeTopology(connect(soup));
  EXPECT_EQ(topology.component, (std::vector<Index>{0, 1, 1, 1, 0, 1, 0, 0}));
}

}  // namespace
}  // namespace moduli
