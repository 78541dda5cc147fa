// Closed geodesics and pairs of pants of real meshes.

#include <chrono>
#include <iostream>
#include <string>
#include <vector>

#include "core/hyperbolic/dirichlet_domain.h"
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

struct Case {
  const char* name;
  double length;  ///< Up to where spectra are compared.
};

class RealSpectra : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Meshes, RealSpectra,
                         testing::Values(Case{"genus2/cfwen__eight.off", 6},
                                         Case{"genus2/ceaedf__cup_input_simple_10000.off", 6},
                                         Case{"genus2/odedstein__skull_low_resolution.obj", 6},
                                         Case{"genus3plus/libigl-data__3holes.off", 5},
                                         Case{"genus3plus/libigl-data__fertility.off", 3},
                                         Case{"genus3plus/ceaedf__botijo.off", 3}));

TEST_P(RealSpectra, DoNotDependOnTheLayoutAndFollowFromThePants) {
  const Case& given = GetParam();
  MODULI_NEED_SHARED_MESH(path, given.name);
  const auto triangles = uniformizeFile(path);
  ASSERT_OK(triangles);
  std::vector<double> first;
  for (const Index root : {kNone, Index{1000}}) {
    Context context;
    DevelopOptions layout;
    layout.root = root;
    const auto group = computeFuchsianGroup(context, *triangles, layout);
    ASSERT_OK(group);
    const auto polygon = orbitPolygon(context, *group);
    ASSERT_OK(polygon);
    const auto start = std::chrono::steady_clock::now();
    const auto shortest = systoles(context, *polygon);
    ASSERT_OK(shortest);
    const double systole = shortest->geodesics[0].length;
    const auto short_ones = lengthSpectrum(context, *polygon, 1.5 * systole);
    ASSERT_OK(short_ones);
    EXPECT_EQ(short_ones->complete_to, 1.5 * systole);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
    const auto spectrum = lengthSpectrum(context, *polygon, given.length);
    ASSERT_OK(spectrum);
    EXPECT_EQ(spectrum->complete_to, given.length);
    if (root == kNone) first = lengthsOf(*spectrum);
    // Elements move 0 by some 12: e^12 1e-16, and a few products.
    expectNear(lengthsOf(*spectrum), first, 1e-9);
    const auto pants = pantsDecomposition(context, *polygon);
    ASSERT_OK(pants);
    EXPECT_LT(pants->seam_error, 1e-8);
    const auto rebuilt = groupFromFenchelNielsen(pants->coordinates);
    ASSERT_OK(rebuilt);
    const auto again = orbitPolygon(context, rebuilt->generators, polygon->genus);
    ASSERT_OK(again);
    const auto same = lengthSpectrum(context, *again, given.length);
    ASSERT_OK(same);
    expectNear(lengthsOf(*same), first, 1e-8);
    std::cout << "genus " << polygon->genus << ", radius " << polygon->radius << ", "
              << first.size() << " geodesics from " << systole << ", " << spectrum->elements
              << " elements, pants up to " << pants->coordinates.lengths.back() << ", seams to "
              << pants->seam_error << "\n";
  }
}

class LongPants : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Meshes, LongPants,
                         testing::Values(Case{"genus3plus/odedstein__boot.obj", 2},
                                         Case{"multi_boundary/gpeyre__pipes.off", 4}));

TEST_P(LongPants, AreFoundAndMakeTheSurface) {
  // Their longest curves are 9.8 and 6.8 long, where the whole surface has 10^7 and 10^5 elements.
  MODULI_NEED_SHARED_MESH(path, GetParam().name);
  const auto triangles = uniformizeFile(path);
  ASSERT_OK(triangles);
  Context context;
  const auto group = computeFuchsianGroup(context, *triangles);
  ASSERT_OK(group);
  const auto polygon = orbitPolygon(context, *group);
  ASSERT_OK(polygon);
  const auto pants = pantsDecomposition(context, *polygon, {.most_parts = 500'000});
  ASSERT_OK(pants);
  ASSERT_EQ(pants->curves.size(), static_cast<std::size_t>(3 * polygon->genus - 3));
  // Seen 1e-11: axes at distance 5 along curves of length 10.
  EXPECT_LT(pants->seam_error, 1e-8);
  const auto rebuilt = groupFromFenchelNielsen(pants->coordinates);
  ASSERT_OK(rebuilt);
  const auto again = orbitPolygon(context, rebuilt->generators, polygon->genus);
  ASSERT_OK(again);
  const auto first = lengthSpectrum(context, *polygon, GetParam().length);
  ASSERT_OK(first);
  const auto second = lengthSpectrum(context, *again, GetParam().length);
  ASSERT_OK(second);
  ASSERT_FALSE(first->geodesics.empty());
  // A foot that is off by the seam's error over the length of the seam, 1e-2 at least, and a curve
  // that passes a dozen of them.
  expectNear(lengthsOf(*second), lengthsOf(*first), 1e-7);
}

}  // namespace
}  // namespace moduli
