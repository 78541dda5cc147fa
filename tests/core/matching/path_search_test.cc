#include "core/matching/path_search.h"

#include <cmath>

#include "tests/core/matching/cover_samples.h"

namespace moduli {
namespace {

SurfacePoint middleOf(Index face) {
  return {face, {0.5, 0.3, 0.2}};
}

/// What differs of two motions at most.
double difference(const Motion& x, const Motion& y) {
  return (x - y).cwiseAbs().maxCoeff();
}

/// Whether the straight way from a point, in its face's coordinates, ends at another one.
void expectArrival(const CoverSurface& cover, const SurfacePoint& from, const SurfacePoint& to,
                   const Motion& motion) {
  const CoverPlane plane = cover.plane();
  const CoverArrival end =
      walkStraight(cover, from.face, cover.place(from),
                   plane.normalized(Eigen::Vector3d(motion * cover.place(to))));
  EXPECT_EQ(end.face, to.face);
  EXPECT_LT((end.place - cover.place(to)).norm(), 1e-10);
}

TEST(PathSearch, TellsWhereAStraightWayEnds) {
  for (const TriangleSoup& soup : {lumpyTorus(12, 2), lumpyPlate(4, 2)}) {
    const TriangleMesh mesh = meshOf(soup);
    const CoverSurface cover = coverOf(mesh);
    PathSearch search(cover, mesh.vertexCount());
    search.searchAll();
    const SurfacePoint from = middleOf(0);
    search.start(from);
    EXPECT_EQ(difference(*search.find(middleOf(0)), Motion::Identity()), 0);
    for (Index face = 1; face < mesh.faceCount(); face += 17) {
      SCOPED_TRACE(face);
      const auto motion = search.find(middleOf(face));
      ASSERT_TRUE(motion.has_value());
      expectArrival(cover, from, middleOf(face), *motion);
    }
  }
}

TEST(PathSearch, CopiesSearchByThemselves) {
  const TriangleMesh mesh = meshOf(lumpyPlate(4, 2));
  const CoverSurface cover = coverOf(mesh);
  PathSearch one(cover, mesh.vertexCount());
  one.searchAll();
  const Index last = mesh.faceCount() - 1;
  one.start(middleOf(0));
  const Motion near = *one.find(middleOf(7)), far = *one.find(middleOf(last));
  PathSearch first = one, second = one;
  first.start(middleOf(0));
  second.start(middleOf(last));
  for (Index face = 1; face < last; face += 29) second.find(middleOf(face));
  // Asked in another order, and while the other one went elsewhere.
  EXPECT_EQ(difference(*first.find(middleOf(last)), far), 0);
  EXPECT_EQ(difference(*first.find(middleOf(7)), near), 0);
}

TEST(PathSearch, FindsNothingFarAwayUnlessItIsToSearchAll) {
  const TriangleMesh mesh = meshOf(lumpyTorus(60, 2));
  ASSERT_GT(mesh.vertexCount(), 2000);
  const CoverSurface cover = coverOf(mesh);
  PathSearch search(cover, mesh.vertexCount());
  const Index middle = mesh.faceCount() / 2;
  search.start(middleOf(0));
  EXPECT_FALSE(search.find(middleOf(middle)).has_value());
  search.searchAll();
  search.start(middleOf(0));
  EXPECT_TRUE(search.find(middleOf(middle)).has_value());
}

}  // namespace
}  // namespace moduli
