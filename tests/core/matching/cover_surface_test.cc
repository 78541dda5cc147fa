#include "core/matching/cover_surface.h"

#include <cmath>
#include <iostream>
#include <numbers>

#include "core/mesh/read.h"
#include "core/mesh/sample_tools.h"
#include "tests/bench/retrieval/remesh.h"
#include "tests/core/matching/cover_samples.h"

namespace moduli {
namespace {

void expectSound(const CoverSurface& cover, double area) {
  const VertexLinks links = ownLinks(cover, vertexFrames(cover));
  EXPECT_NEAR(cover.area, area, 1e-9 * area);
  EXPECT_LT(closureResidual(cover.surface, links), 1e-10);
  EXPECT_EQ(countFolded(cover.surface, links), 0);
  // Around a vertex the faces meet again: the frame comes back to itself.
  for (Index v = 0; v < cover.surface.vertexCount(); ++v) {
    Motion around = Motion::Identity();
    const Index first = cover.surface.outgoing(v);
    Index h = first;
    do {
      around = around * cover.across[Connectivity::previous(h)];
      h = cover.surface.rotate(h);
    } while (h != first);
    ASSERT_LT(distanceToUnit(around), 1e-8) << v;
  }
}

TEST(CoverSurface, HasTheAreaOfGaussAndBonnetAndNoCones) {
  expectSound(coverOf(meshOf(lumpyTorus(12, 3))), 1);
  expectSound(coverOf(meshOf(lumpyPlate(4, 3))), 4 * std::numbers::pi);
  const auto three = makeSample("genus", {{"genus", 3}, {"resolution", 4}});
  expectSound(coverOf(meshOf(*three)), 8 * std::numbers::pi);
}

TEST(CoverSurface, OfATorusChangesCoordinatesByShiftsAlone) {
  const CoverSurface cover = coverOf(meshOf(lumpyTorus(12, 3)));
  for (const Motion& across : cover.across) {
    EXPECT_EQ((across.topLeftCorner<2, 2>()), Eigen::Matrix2d::Identity());
  }
}

TEST(CoverSurface, FindsPointsAgain) {
  for (const TriangleSoup& soup : {lumpyTorus(8, 3), lumpyPlate(4, 3)}) {
    const CoverSurface cover = coverOf(meshOf(soup));
    for (Index f = 0; f < cover.surface.faceCount(); f += 7) {
      const SurfacePoint point{f, {0.2, 0.7, 0.1}};
      const SurfacePoint back = cover.pointAt(f, cover.place(point));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(back.barycentric[c], point.barycentric[c], 1e-13);
    }
  }
}

TEST(CoverSurface, StraightWaysLeadToTheSamePointThereAndBack) {
  SampleRandom random(2);
  for (const TriangleSoup& soup : {lumpyTorus(8, 3), lumpyPlate(4, 3)}) {
    const CoverSurface cover = coverOf(meshOf(soup));
    const CoverPlane plane = cover.plane();
    for (Index f = 0; f < cover.surface.faceCount(); f += 5) {
      // From a corner, a side and the middle: ways along edges and through vertices among them.
      for (const SurfacePoint& point : {SurfacePoint{f, {1, 0, 0}}, SurfacePoint{f, {0.5, 0.5, 0}},
                                        SurfacePoint{f, {0.3, 0.3, 0.4}}}) {
        const Eigen::Vector3d from = cover.place(point);
        const Motion frame = plane.shift(plane.wayTo(from));
        const Eigen::Vector2d way(random.uniform() - 0.5, random.uniform() - 0.5);
        const Eigen::Vector3d to = frame * plane.pointAt(way);
        const CoverArrival end = walkStraight(cover, f, from, to);
        EXPECT_GT(cover.weights(end.face, end.place).minCoeff(), -1e-9);
        EXPECT_LT((end.motion * end.place - to).norm(), 1e-11);
        const CoverArrival back =
            walkStraight(cover, end.face, end.place,
                         plane.normalized(Eigen::Vector3d(plane.inverse(end.motion) * from)));
        EXPECT_LT((end.motion * back.motion * back.place - from).norm(), 1e-11);
      }
    }
  }
}

TEST(CoverSurface, MovesVerticesWhereStraightFacesFold) {
  Context context;
  MODULI_NEED_SHARED_MESH(boot, "genus3plus/odedstein__boot.obj");
  const TriangleMesh mesh = meshOf(simplified(*readMeshFile(context, boot), 20000));
  const CoverSurface cover = coverOf(mesh);
  std::cout << cover.unfolded << " faces had been folded\n";
  EXPECT_GT(cover.unfolded, 0);
  expectSound(cover, 44 * std::numbers::pi);
}

}  // namespace
}  // namespace moduli
