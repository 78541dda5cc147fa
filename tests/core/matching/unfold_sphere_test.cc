#include "core/matching/unfold_sphere.h"

#include <limits>

#include "core/matching/conformal_sphere.h"
#include "core/mesh/samples.h"
#include "core/spherical/map_quality.h"
#include "tests/core/matching/ball_with_limbs.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

TriangleMesh sphere(int resolution) {
  return *TriangleMesh::fromSoup(
      *makeSample("sphere", {{"resolution", static_cast<double>(resolution)}, {"seed", 2}}));
}

TEST(UnfoldSphere, LeavesAMapWithoutFoldsAsItIs) {
  const TriangleMesh mesh = sphere(8);
  Context context;
  const auto points = unfoldSphere(context, mesh, mesh.positions());
  ASSERT_OK(points);
  EXPECT_EQ(*points, mesh.positions());
}

TEST(UnfoldSphere, MovesOnlyTheVerticesOfFoldedFaces) {
  const TriangleMesh mesh = sphere(12);
  Points3 folded = mesh.positions();
  // Each thrown over its ring; far from each other.
  const std::vector<Index> thrown = {40, 300, 700};
  for (const Index v : thrown) {
    folded[v] = (mesh.positions()[v] + Eigen::Vector3d(0.3, -0.2, 0.25)).normalized();
  }
  Context context;
  ASSERT_GT(measureSphereMap(mesh.connectivity(), mesh.edgeLengths(), folded).flipped_faces, 3);
  const auto points = unfoldSphere(context, mesh, folded);
  ASSERT_OK(points);
  EXPECT_EQ(measureSphereMap(mesh.connectivity(), mesh.edgeLengths(), *points).flipped_faces, 0);
  int changed = 0;
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    EXPECT_NEAR((*points)[v].norm(), 1, 1e-12);
    if ((*points)[v] != folded[v]) ++changed;
  }
  EXPECT_LE(changed, 12);  // Those three, and a few that stood in their way.
}

TEST(UnfoldSphere, MapsAnewWhereNothingIsLeft) {
  const TriangleMesh mesh = sphere(12);
  Context context;
  Points3 inside_out = mesh.positions();
  for (Eigen::Vector3d& p : inside_out) p = -p;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Points3& nothing :
       {Points3(mesh.vertexCount(), Eigen::Vector3d::Zero()),
        Points3(mesh.vertexCount(), Eigen::Vector3d::UnitX()),
        Points3(mesh.vertexCount(), Eigen::Vector3d::Constant(nan)), inside_out}) {
    const auto points = unfoldSphere(context, mesh, nothing);
    ASSERT_OK(points);
    const MapQuality quality = measureSphereMap(mesh.connectivity(), mesh.edgeLengths(), *points);
    EXPECT_EQ(quality.flipped_faces, 0);
    EXPECT_NEAR(quality.covering_degree, 1, 1e-9);
  }
}

TEST(UnfoldSphere, ALimbThatIsOnePointComesBackAndTheBallStays) {
  // A limb's vertices fell together, as they do where doubles end.
  const TriangleMesh mesh = ballWithLimbs(10, 4);
  Context context;
  const auto sphere = conformalSphere(context, mesh, true);
  ASSERT_OK(sphere);
  Points3 fallen = sphere->points;
  // One is along (1, 0.1, 0.2), and begins at 1.
  const auto isFar = [&](Index v) { return mesh.positions()[v].x() > 1.5; };
  Index first = 0;
  while (!isFar(first)) ++first;
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    if (isFar(v)) fallen[v] = sphere->points[first];
  }
  const auto points = unfoldSphere(context, mesh, fallen);
  ASSERT_OK(points);
  const MapQuality quality = measureSphereMap(mesh.connectivity(), mesh.edgeLengths(), *points);
  EXPECT_EQ(quality.flipped_faces, 0);
  EXPECT_NEAR(quality.covering_degree, 1, 1e-9);
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    if (mesh.positions()[v].x() < 0.5) {
      EXPECT_EQ((*points)[v], sphere->points[v]);
    }
  }
}

TEST(UnfoldSphere, SaysWhereNothingIsLeftOfADisk) {
  const TriangleMesh mesh = sphere(4);
  Context context;
  const Points3 nothing(mesh.vertexCount(), Eigen::Vector3d::Zero());
  EXPECT_THAT(unfoldSphere(context, mesh, nothing, 0), FailsWith(Reason::kFoldedMap));
}

}  // namespace
}  // namespace moduli
