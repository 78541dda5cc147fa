// Real meshes in the Poincaré disk.

#include <algorithm>
#include <cmath>

#include "core/signature/compute.h"
#include "tests/core/parameterize/hyperbolic_surfaces.h"

namespace moduli {
namespace {

/// The signature comes from the surface's (or its double's) own flipped triangulation.
void expectLengthsOfSignature(const Parameterization& map, const TriangleSoup& soup) {
  Context context;
  const auto prepared = prepareMesh(context, soup, {});
  ASSERT_OK(prepared);
  SignatureOptions options;
  options.space = Space::kConformal;
  const auto signature = computeSignature(context, *prepared, options);
  ASSERT_OK(signature);
  // The map would take the other starting triangulation, whose metric differs, where faces fold.
  ASSERT_EQ(map.certificate.flips, signature->certificate.flips);
  std::vector<double> boundary = map.hyperbolic->boundary_lengths;
  std::sort(boundary.begin(), boundary.end());
  expectNear(boundary, signature->conformal->boundary_lengths, 1e-9);
  const std::vector<double>& spectrum = signature->conformal->length_spectrum;
  const std::vector<double> lengths = lengthsOf(map);
  for (const double length : lengths) {
    EXPECT_TRUE(std::any_of(spectrum.begin(), spectrum.end(), [&](double other) {
      return std::abs(other - length) < 1e-9;
    })) << length;
  }
  if (!boundary.empty()) return;
  // Pictures show those up to 1.5 times the shortest; signatures list more where that is short.
  const auto shown = std::count_if(spectrum.begin(), spectrum.end(),
                                   [&](double length) { return length <= 1.5 * spectrum.front(); });
  EXPECT_EQ(lengths.size(), std::min<std::size_t>(12, static_cast<std::size_t>(shown)));
}

class ClosedMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, ClosedMesh,
                         testing::Values("genus2/cfwen__eight.off",
                                         "genus2/odedstein__skull_low_resolution.obj",
                                         "genus3plus/libigl-data__3holes.off",
                                         "genus3plus/libigl-data__fertility.off"));

TEST_P(ClosedMesh, MapsToADomainOfItsGroupWithTheLengthsOfItsSignature) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  Context context;
  const auto soup = readMeshFile(context, path);
  ASSERT_OK(soup);
  const auto given = metricOf(*soup);
  ASSERT_OK(given);
  const auto map = mapped(*given);
  ASSERT_OK(map);
  expectClosedDomain(*given, *map);
  expectLengthsOfSignature(*map, *soup);
}

class BorderedMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, BorderedMesh,
                         testing::Values("genus2/cfwen__eight.hole.off",
                                         "genus1/bff__punctured-torus.obj",
                                         "multi_boundary/gpeyre__pipes.off",
                                         "multi_boundary/libigl-data__halftunnel.off"));

TEST_P(BorderedMesh, HasGeodesicSidesAndTheLengthsOfItsSignature) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  Context context;
  const auto soup = readMeshFile(context, path);
  ASSERT_OK(soup);
  const auto given = metricOf(*soup);
  ASSERT_OK(given);
  const auto map = mapped(*given);
  ASSERT_OK(map);
  expectBorderedImage(*given, *map);
  expectLengthsOfSignature(*map, *soup);
}

TEST(CutFaces, OfARealMeshDoNotFold) {
  MODULI_NEED_SHARED_MESH(path, "genus3plus/odedstein__boot.obj");
  const auto given = metricOfFile(path);
  ASSERT_OK(given);
  HyperbolicOptions options;
  options.refine = false;
  EXPECT_THAT(mapped(*given, options), FailsWith(Reason::kFoldedMap));
  options.refine = true;
  const auto map = mapped(*given, options);
  ASSERT_OK(map);
  ASSERT_TRUE(map->subdivision);
  EXPECT_GT(map->subdivision->faces.size(), 39906U);
  const Connectivity faces = mappedFaces(*given, *map);
  const DiskFaces disk{{faces, map->points, map->corner}, map->hyperbolic->neighbours};
  expectSheet(disk, map->hyperbolic->radius);
  expectSeams(disk);
  expectGeodesics(disk, *map->hyperbolic);
  expectCutFaces(*given, *map->subdivision);
}

TEST(BorderedHyperbolicMap, StandsWhereGeodesicsAreTooManyToFind) {
  MODULI_NEED_SHARED_MESH(path, "multi_boundary/odedstein__plane_holes.obj");
  const auto given = metricOfFile(path);
  ASSERT_OK(given);
  const auto map = mapped(*given);
  ASSERT_OK(map);
  expectBorderedImage(*given, *map);
  EXPECT_EQ(map->hyperbolic->boundary_lengths.size(), 27U);
  EXPECT_TRUE(map->hyperbolic->geodesics.empty());
  ASSERT_EQ(map->certificate.warnings.size(), 1U);
  EXPECT_THAT(map->certificate.warnings[0], testing::StartsWith("GEODESICS_OMITTED: "));
}

}  // namespace
}  // namespace moduli
