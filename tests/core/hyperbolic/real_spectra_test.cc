// Closed geodesics and pairs of pants of real meshes.

#include <algorithm>
#include <string>
#include <vector>

#include "core/hyperbolic/fuchsian_group.h"
#include "core/hyperbolic/pants.h"
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

std::vector<double> lengthsOf(const LengthSpectrum& spectrum) {
  std::vector<double> lengths;
  for (const ClosedGeodesic& geodesic : spectrum.geodesics) lengths.push_back(geodesic.length);
  return lengths;
}

void expectNear(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

class RealSpectra : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, RealSpectra,
                         testing::Values("genus2/cfwen__eight.off",
                                         "genus2/ceaedf__cup_input_simple_10000.off",
                                         "genus2/odedstein__skull_low_resolution.obj"));

TEST_P(RealSpectra, DoNotDependOnTheLayoutAndFollowFromThePants) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const auto triangles = uniformizeFile(path);
  ASSERT_OK(triangles);
  std::vector<double> first;
  double length = 0;
  for (const Index root : {kNone, Index{0}, Index{1000}}) {
    Context context;
    DevelopOptions layout;
    layout.root = root;
    const auto group = computeFuchsianGroup(context, *triangles, layout);
    ASSERT_OK(group);
    const int genus = static_cast<int>(group->generators.size()) / 2;
    const auto polygon = orbitPolygon(context, group->generators, genus);
    ASSERT_OK(polygon);
    if (root == kNone) {
      const auto shortest = systoles(context, *polygon);
      ASSERT_OK(shortest);
      length = 1.5 * shortest->geodesics[0].length;
    }
    const auto spectrum = lengthSpectrum(context, *polygon, length);
    ASSERT_OK(spectrum);
    EXPECT_EQ(spectrum->complete_to, length);
    if (root == kNone) first = lengthsOf(*spectrum);
    expectNear(lengthsOf(*spectrum), first, 1e-8);
    const auto pants = pantsDecomposition(context, *polygon);
    ASSERT_OK(pants);
    EXPECT_LT(pants->seam_error, 1e-8);
    const auto rebuilt = groupFromFenchelNielsen(pants->coordinates);
    ASSERT_OK(rebuilt);
    const auto again = orbitPolygon(context, rebuilt->generators, genus);
    ASSERT_OK(again);
    const auto same = lengthSpectrum(context, *again, length);
    ASSERT_OK(same);
    expectNear(lengthsOf(*same), first, 1e-8);
    if (root == kNone)
      std::cout << "radius " << polygon->radius << ", " << first.size() << " geodesics from "
                << first.front() << " to " << length << ", " << spectrum->elements
                << " elements, pants up to " << pants->coordinates.lengths.back() << ", seams to "
                << pants->seam_error << "\n";
  }
}

}  // namespace
}  // namespace moduli
