#include "core/matching/unfold_sphere.h"

#include "core/mesh/samples.h"
#include "core/spherical/map_quality.h"
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

TEST(UnfoldSphere, SaysWhereNothingIsLeft) {
  const TriangleMesh mesh = sphere(4);
  Points3 inside_out = mesh.positions();
  for (Eigen::Vector3d& p : inside_out) p = -p;
  for (Eigen::Vector3d& p : inside_out) p.x() = -p.x();
  for (Eigen::Vector3d& p : inside_out) p.y() = -p.y();
  Context context;
  EXPECT_THAT(unfoldSphere(context, mesh, inside_out), FailsWith(Reason::kFoldedMap));
}

}  // namespace
}  // namespace moduli
