#include "core/matching/thinning.h"

#include <gtest/gtest.h>

#include "core/spherical/exact_sign.h"
#include "tests/core/spherical/sphere_testing.h"

namespace moduli {
namespace {

using surfaces::MappedSurface;

int badFaces(const RingMesh& rings, Index vertices, const FaceRule& rule) {
  int bad = 0;
  for (Index v = 0; v < vertices; ++v) {
    if (!rings.isPresent(v)) continue;
    const std::vector<Index>& ring = rings.ring(v);
    for (std::size_t i = 0; i < ring.size(); ++i) {
      if (!rule(v, ring[i], ring[(i + 1) % ring.size()])) ++bad;
    }
  }
  return bad / 3;
}

FaceRule positive(const Points3& points) {
  return [&](Index a, Index b, Index c) {
    return spherical::orientationSign(points[a], points[b], points[c]) > 0;
  };
}

TEST(Thinning, ThinsEvenlyAndObeysTheRule) {
  const MappedSurface map = surfaces::roundSphere(12, 5);
  RingMesh rings = *RingMesh::make(map.surface());
  Context context;
  const std::vector<char> all(map.points.size(), 1);
  ASSERT_OK(thinEvenly(context, rings, map.mesh.positions(), all, positive(map.points), 100));
  EXPECT_EQ(rings.vertexCount(), 100);
  EXPECT_EQ(badFaces(rings, map.mesh.vertexCount(), positive(map.points)), 0);
  // A hundred points spread evenly have edges of about sqrt(4 pi / 100 * 2 / sqrt 3) = 0.38.
  double longest = 0;
  for (Index v = 0; v < map.mesh.vertexCount(); ++v) {
    if (!rings.isPresent(v)) continue;
    for (const Index w : rings.ring(v)) {
      longest = std::max(longest, (map.points[v] - map.points[w]).norm());
    }
  }
  EXPECT_LT(longest, 3 * 0.38);
}

TEST(Thinning, KeepsWhatMayNotMove) {
  const MappedSurface map = surfaces::roundSphere(6, 5);
  RingMesh rings = *RingMesh::make(map.surface());
  Context context;
  std::vector<char> movable(map.points.size(), 1);
  for (std::size_t v = 0; v < movable.size(); v += 3) movable[v] = 0;
  const FaceRule any = [](Index, Index, Index) { return true; };
  ASSERT_OK(thinEvenly(context, rings, map.mesh.positions(), movable, any, 4));
  for (std::size_t v = 0; v < movable.size(); v += 3) {
    EXPECT_TRUE(rings.isPresent(static_cast<Index>(v)));
  }
}

TEST(Thinning, TakesOutPlantedFoldsAndLittleElse) {
  const MappedSurface map = surfaces::roundSphere(8, 5);
  Points3 points = map.points;
  surfaces::RandomSphere random(6);
  constexpr int kPlanted = 20;
  for (int i = 0; i < kPlanted; ++i) {
    points[(37 * i) % points.size()] = random.direction();
  }
  RingMesh rings = *RingMesh::make(map.surface());
  const Index before = rings.vertexCount();
  EXPECT_GT(badFaces(rings, before, positive(points)), kPlanted);
  EXPECT_TRUE(thinUntil(rings, map.mesh.positions(), positive(points)));
  EXPECT_EQ(badFaces(rings, before, positive(points)), 0);
  EXPECT_GE(rings.vertexCount(), before - 2 * kPlanted);
  EXPECT_LT(rings.vertexCount(), before);
}

TEST(Thinning, SaysWhenNothingObeysTheRule) {
  const MappedSurface map = surfaces::roundSphere(3, 5);
  RingMesh rings = *RingMesh::make(map.surface());
  const FaceRule none = [](Index, Index, Index) { return false; };
  EXPECT_FALSE(thinUntil(rings, map.mesh.positions(), none));
}

}  // namespace
}  // namespace moduli
