// Closed surfaces in the Poincaré disk, and surfaces that have no place there.

#include "core/parameterize/hyperbolic.h"

#include <cmath>
#include <iostream>

#include "core/hyperbolic/fuchsian_group.h"
#include "core/hyperbolic/length_spectrum.h"
#include "core/intrinsic/intrinsic_samples.h"
#include "tests/core/parameterize/hyperbolic_surfaces.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using testing::HasSubstr;

/// The group of the generators is that of the neighbours.
void expectOneGroup(const HyperbolicDomain& domain, int genus) {
  ASSERT_EQ(domain.generators.size(), 2 * static_cast<std::size_t>(genus));
  EXPECT_LE(canonicalRelationResidual(domain.generators), 1e-8);
  Context context;
  const auto polygon = orbitPolygon(context, domain.generators, genus);
  ASSERT_OK(polygon);
  for (const Su11& g : domain.neighbours) EXPECT_TRUE(isInGroup(*polygon, g));
  const auto other = orbitPolygon(context, domain.neighbours, genus);
  ASSERT_OK(other);
  for (const Su11& g : domain.generators) EXPECT_TRUE(isInGroup(*other, g));
}

/// All geodesics up to where the map knows them are those of its group.
void expectLengthsOfGroup(const Parameterization& map, int genus) {
  Context context;
  const auto polygon = orbitPolygon(context, map.hyperbolic->generators, genus);
  ASSERT_OK(polygon);
  const auto spectrum = lengthSpectrum(context, *polygon, *map.certificate.spectrum_complete_to);
  ASSERT_OK(spectrum);
  const std::vector<double> lengths = lengthsOf(map);
  ASSERT_FALSE(lengths.empty());
  ASSERT_LE(lengths.size(), spectrum->geodesics.size());
  if (lengths.size() < 12) {
    EXPECT_EQ(lengths.size(), spectrum->geodesics.size());
  }
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_NEAR(lengths[i], spectrum->geodesics[i].length, 1e-9);
  }
}

void expectClosedDomain(const MetricSurface& given, const Parameterization& map) {
  ASSERT_TRUE(map.hyperbolic);
  const Connectivity faces = mappedFaces(given, map);
  const DiskFaces disk{{faces, map.points, map.corner}, map.hyperbolic->neighbours};
  expectSheet(disk, map.hyperbolic->radius);
  expectSeams(disk);
  expectGeodesics(disk, *map.hyperbolic);
  const int genus = 1 - given.surface.eulerCharacteristic() / 2;
  expectOneGroup(*map.hyperbolic, genus);
  expectLengthsOfGroup(map, genus);
  EXPECT_TRUE(map.hyperbolic->boundary_lengths.empty());
  const MapCertificate& certificate = map.certificate;
  EXPECT_TRUE(certificate.warnings.empty());
  EXPECT_LT(*certificate.layout_closure, 1e-6);
  EXPECT_LT(*certificate.cycle_residual, 1e-9);
  EXPECT_NEAR(*certificate.relation_residual, canonicalRelationResidual(map.hyperbolic->generators),
              1e-15);
  std::cout << faces.faceCount() << " faces, radius " << map.hyperbolic->radius << ", "
            << map.hyperbolic->neighbours.size() << " neighbours, area off by "
            << disk.area() + 2 * std::numbers::pi * faces.eulerCharacteristic() << ", closure "
            << *certificate.layout_closure << ", relation " << *certificate.relation_residual
            << ", " << map.hyperbolic->geodesics.size() << " geodesics\n";
}

TEST(HyperbolicMap, OfClosedSamplesIsADomainOfTheirGroup) {
  for (const double seed : {0, 5}) {
    for (const double genus : {2, 3}) {
      SCOPED_TRACE(testing::Message() << "genus " << genus << ", seed " << seed);
      const MetricSurface given =
          metricOfSample("genus", {{"genus", genus}, {"resolution", 4}, {"seed", seed}});
      const auto map = mapped(given);
      ASSERT_OK(map);
      expectClosedDomain(given, *map);
    }
  }
}

TEST(HyperbolicMap, OfBolzaAndKleinIsExact) {
  const double eta = 2 * std::cos(2 * std::numbers::pi / 7);
  const struct {
    const char* kind;
    double systole;
    std::size_t systoles;
  } known[] = {{"bolza", 2 * std::acosh(1 + std::sqrt(2)), 12},
               {"klein", 8 * std::acosh((1 + eta) / 2), 21}};
  for (const auto& [kind, systole, systoles] : known) {
    SCOPED_TRACE(kind);
    const IntrinsicSurface surface = *makeIntrinsicSample(kind);
    const MetricSurface given = chordsOf(surface);
    HyperbolicOptions options;
    options.initial_delaunay = false;
    const auto map = mapped(given, options);
    ASSERT_OK(map);
    ASSERT_FALSE(map->subdivision);
    expectClosedDomain(given, *map);
    const DiskFaces disk{{given.surface, map->points, map->corner}, map->hyperbolic->neighbours};
    for (Index h = 0; h < given.surface.halfedgeCount(); ++h) {
      ASSERT_NEAR(disk.length(h), surface.lengths[given.surface.edge(h)], 1e-12);
    }
    const std::vector<double> lengths = lengthsOf(*map);
    ASSERT_GE(lengths.size(), systoles);
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      if (i < systoles) {
        EXPECT_NEAR(lengths[i], systole, 1e-9);
      } else {
        EXPECT_GT(lengths[i], systole + 0.1);
      }
    }
  }
}

class ClosedMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, ClosedMesh,
                         testing::Values("genus2/cfwen__eight.off",
                                         "genus2/odedstein__skull_low_resolution.obj",
                                         "genus3plus/libigl-data__3holes.off",
                                         "genus3plus/libigl-data__fertility.off"));

TEST_P(ClosedMesh, MapsToADomainOfItsGroup) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const auto given = metricOfFile(path);
  ASSERT_OK(given);
  const auto map = mapped(*given);
  ASSERT_OK(map);
  expectClosedDomain(*given, *map);
}

TEST(HyperbolicMap, LengthsDoNotDependOnNumbersPlaceAndScale) {
  const TriangleSoup soup =
      surfaces::sample("genus", {{"genus", 2}, {"resolution", 4}, {"seed", 2}});
  const auto first = mapped(*metricOf(soup));
  ASSERT_OK(first);
  for (const TriangleSoup& same : {surfaces::renumbered(soup, 3), surfaces::moved(soup, 50)}) {
    const auto second = mapped(*metricOf(same));
    ASSERT_OK(second);
    expectNear(lengthsOf(*second), lengthsOf(*first), 1e-8);
  }
}

TEST(HyperbolicMap, OfTheMirrorImageHasTheSameLengths) {
  const MetricSurface given =
      metricOfSample("genus", {{"genus", 3}, {"resolution", 4}, {"seed", 2}});
  const auto first = mapped(given), second = mapped(mirror(given));
  ASSERT_OK(first);
  ASSERT_OK(second);
  expectNear(lengthsOf(*second), lengthsOf(*first), 1e-8);
}

TriangleSoup twoSpheres() {
  TriangleSoup soup = surfaces::sample("sphere", {{"resolution", 2}});
  const auto count = static_cast<Index>(soup.vertices.size());
  const std::vector<Triangle> faces = soup.faces;
  for (Index v = 0; v < count; ++v) {
    soup.vertices.push_back(soup.vertices[v] + Eigen::Vector3d(5, 0, 0));
  }
  for (const Triangle& face : faces) {
    soup.faces.push_back({face[0] + count, face[1] + count, face[2] + count});
  }
  return soup;
}

TEST(HyperbolicMap, NamesTheTargetThatServesWhereItDoesNot) {
  const struct {
    TriangleSoup soup;
    const char *message, *hint;
  } refused[] = {
      {surfaces::sample("sphere", {{"resolution", 2}}), "a sphere", "--to sphere"},
      {surfaces::sample("torus", {{"resolution", 6}}), "a torus", "--to flat"},
      {surfaces::sample("disk", {{"resolution", 3}}), "a disk", "--to disk"},
      {surfaces::sample("annulus", {{"resolution", 3}}), "an annulus", "--to circle-domain"},
      {twoSpheres(), "2 components", "--component"},
  };
  for (const auto& [soup, message, hint] : refused) {
    SCOPED_TRACE(message);
    const TriangleMesh mesh = surfaces::mesh(soup);
    const auto map = mapped({mesh.connectivity(), mesh.edgeLengths()});
    EXPECT_THAT(map, FailsWith(Reason::kUnsupportedTopology));
    EXPECT_THAT(map.status().message(), HasSubstr(message));
    EXPECT_THAT(map.status().hint(), HasSubstr(hint));
  }
}

TEST(HyperbolicMap, StopsWhenCancelled) {
  const MetricSurface given = metricOfSample("genus", {{"genus", 2}, {"resolution", 4}});
  CancelToken token;
  token.cancel();
  Context context;
  context.setCancelToken(token);
  EXPECT_THAT(parameterizeHyperbolic(context, given.surface, given.lengths, {}),
              FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
