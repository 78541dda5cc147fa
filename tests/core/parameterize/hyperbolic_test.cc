// Closed surfaces in the Poincaré disk, and surfaces that have no place there.

#include "core/parameterize/hyperbolic.h"

#include <cmath>
#include <numbers>

#include "core/intrinsic/intrinsic_samples.h"
#include "tests/core/parameterize/hyperbolic_surfaces.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using testing::HasSubstr;

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
