#include "core/matching/ring_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "core/matching/capped_disk.h"
#include "tests/core/matching/disk_samples.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using surfaces::mesh;
using surfaces::sample;

RingMesh ringsOf(const Connectivity& surface) {
  auto rings = RingMesh::make(surface);
  EXPECT_OK(rings);
  return *std::move(rings);
}

/// Begins at its lowest number.
std::vector<Index> normalized(std::vector<Index> ring) {
  std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
  return ring;
}

/// Every face is seen from its three corners alike, no edge is doubled, and the surface is still a
/// sphere: V - E + F = 2.
void expectSphere(const RingMesh& rings, Index vertices) {
  std::set<Triangle> faces;
  std::size_t corners = 0, neighbours = 0, present = 0;
  for (Index v = 0; v < vertices; ++v) {
    if (!rings.isPresent(v)) continue;
    ++present;
    const std::vector<Index>& ring = rings.ring(v);
    ASSERT_GE(ring.size(), 3u);
    EXPECT_EQ(std::set<Index>(ring.begin(), ring.end()).size(), ring.size());
    neighbours += ring.size();
    for (std::size_t i = 0; i < ring.size(); ++i) {
      ASSERT_TRUE(rings.isPresent(ring[i]));
      Triangle face = {v, ring[i], ring[(i + 1) % ring.size()]};
      std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
      faces.insert(face);
      ++corners;
    }
  }
  EXPECT_EQ(corners, 3 * faces.size());
  EXPECT_EQ(present - neighbours / 2 + faces.size(), 2u);
  EXPECT_EQ(static_cast<Index>(present), rings.vertexCount());
}

TEST(RingMesh, IsASphereAfterEveryCollapseAndComesBackAsItWas) {
  const TriangleMesh round = mesh(sample("sphere", {{"resolution", 3}, {"seed", 2}}));
  RingMesh rings = ringsOf(round.connectivity());
  const Index count = round.vertexCount();
  std::vector<std::vector<Index>> before;
  for (Index v = 0; v < count; ++v) before.push_back(normalized(rings.ring(v)));
  expectSphere(rings, count);

  std::mt19937 random(4);
  int collapses = 0;
  for (int attempt = 0; attempt < 100000 && rings.vertexCount() > 4; ++attempt) {
    const auto v = static_cast<Index>(random() % count);
    if (!rings.isPresent(v)) continue;
    const Index u = rings.ring(v)[random() % rings.ring(v).size()];
    if (!rings.canCollapse(v, u)) continue;
    rings.collapse(v, u);
    ++collapses;
    expectSphere(rings, count);
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_EQ(rings.vertexCount(), 4);  // Every sphere comes down to a tetrahedron.
  for (; collapses > 0; --collapses) {
    const RingMesh::Collapse undone = rings.restore();
    EXPECT_TRUE(rings.isPresent(undone.removed));
    expectSphere(rings, count);
    if (::testing::Test::HasFailure()) return;
  }
  for (Index v = 0; v < count; ++v) EXPECT_EQ(normalized(rings.ring(v)), before[v]);
}

/// No edge inside joins vertices of the boundary, and no face of the disk has all corners there.
void expectDisk(const RingMesh& rings) {
  const std::vector<Index>& rim = rings.ring(rings.pole());
  ASSERT_GE(rim.size(), 3u);
  for (const Index v : rim) {
    EXPECT_TRUE(rings.isRim(v));
    const std::vector<Index>& ring = rings.ring(v);
    EXPECT_EQ(std::count_if(ring.begin(), ring.end(), [&](Index w) { return rings.isRim(w); }), 2);
    EXPECT_GE(ring.size(), 4u);
  }
}

TEST(RingMesh, OfADiskStaysOneAndComesBackAsItWas) {
  const TriangleMesh flat = mesh(sample("disk", {{"resolution", 4}, {"seed", 2}}));
  const TriangleMesh capped = *cappedDisk(flat);
  const Index count = capped.vertexCount(), pole = count - 1;
  auto made = RingMesh::make(capped.connectivity(), pole);
  ASSERT_OK(made);
  RingMesh& rings = *made;
  std::vector<std::vector<Index>> before;
  for (Index v = 0; v < count; ++v) before.push_back(normalized(rings.ring(v)));
  EXPECT_TRUE(rings.isCap(3, pole, 4));
  EXPECT_FALSE(rings.isCap(3, 5, 4));
  rings.hold(7);
  expectDisk(rings);

  std::mt19937 random(4);
  int collapses = 0;
  for (int attempt = 0; attempt < 100000 && rings.vertexCount() > 5; ++attempt) {
    const auto v = static_cast<Index>(random() % count);
    if (!rings.isPresent(v)) continue;
    const Index u = rings.ring(v)[random() % rings.ring(v).size()];
    if (!rings.canCollapse(v, u)) continue;
    EXPECT_TRUE(!rings.isRim(v) || rings.isRim(u));
    rings.collapse(v, u);
    ++collapses;
    expectSphere(rings, count);
    expectDisk(rings);
    if (::testing::Test::HasFailure()) return;
  }
  // A boundary of three around one vertex, which is the one that is held.
  EXPECT_EQ(rings.vertexCount(), 5);
  EXPECT_TRUE(rings.isPresent(7));
  EXPECT_TRUE(rings.isPresent(pole));
  for (; collapses > 0; --collapses) rings.restore();
  for (Index v = 0; v < count; ++v) EXPECT_EQ(normalized(rings.ring(v)), before[v]);
}

TEST(RingMesh, OfADiskKeepsTheLastVertexInside) {
  const TriangleMesh disk = *TriangleMesh::fromSoup(
      {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}});
  const TriangleMesh capped = *cappedDisk(disk);
  auto rings = RingMesh::make(capped.connectivity(), 4);
  ASSERT_OK(rings);
  for (const Index v : {1, 2, 3}) EXPECT_FALSE(rings->canCollapse(0, v));
}

TEST(RingMesh, RefusesADiskWithAnEdgeAcross) {
  const TriangleMesh square = *TriangleMesh::fromSoup(twoTriangles());
  const TriangleMesh capped = *cappedDisk(square);
  EXPECT_THAT(RingMesh::make(capped.connectivity(), 4), FailsWith(Reason::kUnsupportedTopology));
}

TEST(RingMesh, ATetrahedronKeepsItsVertices) {
  const Connectivity surface =
      *Connectivity::fromFaces(4, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
  const RingMesh rings = ringsOf(surface);
  EXPECT_FALSE(rings.canCollapse(0, 1));
}

TEST(RingMesh, RefusesAWaist) {
  // A double pyramid over a triangle: 0, 1, 2 are joined to each other without a face between them,
  // so that 0 cannot go into 1.
  const Connectivity surface = *Connectivity::fromFaces(
      5, {{3, 0, 1}, {3, 1, 2}, {3, 2, 0}, {4, 1, 0}, {4, 2, 1}, {4, 0, 2}});
  const RingMesh rings = ringsOf(surface);
  EXPECT_FALSE(rings.canCollapse(0, 1));
  EXPECT_TRUE(rings.canCollapse(3, 0));
}

TEST(RingMesh, NeedsAClosedSurfaceWithoutDoubledEdges) {
  const TriangleMesh disk = mesh(sample("disk", {{"resolution", 2}}));
  EXPECT_THAT(RingMesh::make(disk.connectivity()), FailsWith(Reason::kUnsupportedTopology));
  const Connectivity pillow = *Connectivity::fromFaces(3, {{0, 1, 2}, {0, 2, 1}});
  EXPECT_THAT(RingMesh::make(pillow), FailsWith(Reason::kUnsupportedTopology));
}

TEST(RingMesh, BringsVerticesBackInGroupsWithoutEdges) {
  const TriangleMesh sphere = mesh(sample("sphere", {{"resolution", 6}}));
  RingMesh rings = ringsOf(sphere.connectivity());
  const RingMesh whole = rings;
  for (int round = 0; round < 3; ++round) {
    for (Index v = 0; v < sphere.vertexCount(); ++v) {
      if (!rings.isPresent(v)) continue;
      const std::vector<Index> ring = rings.ring(v);
      const auto into =
          std::find_if(ring.begin(), ring.end(), [&](Index w) { return rings.canCollapse(v, w); });
      if (into != ring.end()) rings.collapse(v, *into);
    }
  }
  const auto gone = static_cast<Index>(rings.collapses().size());
  ASSERT_GT(gone, sphere.vertexCount() / 2);
  EXPECT_TRUE(restoreSeparated(rings, 0).empty());
  EXPECT_EQ(restoreSeparated(rings, 1).size(), 1U);
  Index back = 1;
  std::size_t largest = 0;
  while (!rings.collapses().empty()) {
    const auto group = restoreSeparated(rings, 7);
    ASSERT_GE(group.size(), 1U);
    ASSERT_LE(group.size(), 7U);
    largest = std::max(largest, group.size());
    back += static_cast<Index>(group.size());
    for (const auto& [v, kept] : group) {
      EXPECT_TRUE(rings.isPresent(v));
      const std::vector<Index>& ring = rings.ring(v);
      EXPECT_NE(std::find(ring.begin(), ring.end(), kept), ring.end());
      for (const auto& other : group) {
        EXPECT_EQ(std::count(ring.begin(), ring.end(), other.removed), 0);
      }
    }
  }
  EXPECT_EQ(back, gone);
  EXPECT_GT(largest, 1U);
  for (Index v = 0; v < sphere.vertexCount(); ++v) {
    std::vector<Index> ring = rings.ring(v);
    std::rotate(ring.begin(), std::find(ring.begin(), ring.end(), whole.ring(v).front()),
                ring.end());
    EXPECT_EQ(ring, whole.ring(v));
  }
}

TEST(RingMesh, SeparatesVerticesIntoFewSetsWithoutEdges) {
  const TriangleMesh sphere = mesh(sample("sphere", {{"resolution", 6}}));
  RingMesh rings = ringsOf(sphere.connectivity());
  const Index gone = rings.ring(7).front();
  ASSERT_TRUE(rings.canCollapse(gone, 7));
  rings.collapse(gone, 7);
  std::vector<Index> vertices;
  std::size_t most = 0;
  for (Index v = sphere.vertexCount() - 1; v >= 0; --v) {
    if (!rings.isPresent(v)) continue;
    vertices.push_back(v);
    most = std::max(most, rings.ring(v).size());
  }
  const auto sets = separatedSets(rings, vertices);
  EXPECT_LE(sets.size(), most + 1);  // Greedy: one more than the neighbours at most.
  std::vector<Index> all;
  for (const std::vector<Index>& set : sets) {
    all.insert(all.end(), set.begin(), set.end());
    for (const Index v : set) {
      for (const Index w : rings.ring(v)) EXPECT_EQ(std::count(set.begin(), set.end(), w), 0);
    }
  }
  std::sort(all.begin(), all.end());
  std::sort(vertices.begin(), vertices.end());
  EXPECT_EQ(all, vertices);
  EXPECT_TRUE(separatedSets(rings, {}).empty());
}

}  // namespace
}  // namespace moduli
