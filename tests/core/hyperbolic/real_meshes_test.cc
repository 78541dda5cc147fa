// Every closed real mesh of genus 2 and more has its Fuchsian group.

#include <algorithm>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/hyperbolic/fuchsian_group.h"
#include "core/intrinsic/mollify.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/ricci/uniformize.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Result<HyperbolicTriangles> uniformizeFile(const std::string& path) {
  Context context;
  ASSIGN_OR_RETURN(const TriangleSoup soup, readMeshFile(context, path));
  ASSIGN_OR_RETURN(const PreparedMesh prepared, prepareMesh(context, soup, {}));
  const Connectivity& surface = prepared.mesh.connectivity();
  ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(surface, prepared.mesh.edgeLengths()));
  ASSIGN_OR_RETURN(const Uniformization found, uniformize(context, surface, mollified.lengths));
  return hyperbolicTriangles(found.metric);
}

class EveryMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Folders, EveryMesh, testing::Values("genus2", "genus3plus"));

TEST_P(EveryMesh, HasAGroupThatSatisfiesItsRelation) {
  const std::vector<std::string> paths = sharedMeshes(GetParam());
  if (paths.empty()) GTEST_SKIP() << "no meshes in " << GetParam() << "; set MODULI_SHARED";
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    const auto triangles = uniformizeFile(path);
    ASSERT_OK(triangles);
    Context context;
    const auto group = computeFuchsianGroup(context, *triangles);
    ASSERT_OK(group);
    const FuchsianCertificate& certificate = group->certificate;
    EXPECT_EQ(static_cast<Index>(group->generators.size()),
              2 - triangles->surface.eulerCharacteristic());
    // Promised 1e-8; seen 4e-12 and less.
    EXPECT_LE(certificate.relation_residual, 1e-9);
    EXPECT_LE(certificate.development.vertex_residual, 1e-12);
    EXPECT_LE(certificate.development.determinant_drift, 1e-12);
    // Angles are right to some 1e-16, paths to the corners of the layout to some thousand of these.
    EXPECT_LE(certificate.moved, 1e-11);
    EXPECT_GT(certificate.shortest_generator, 0.1);
  }
}

}  // namespace
}  // namespace moduli
