#include "core/parameterize/disk_layout.h"

#include <cmath>
#include <numbers>

#include "core/hyperbolic/length_spectrum.h"
#include "core/hyperbolic/straight_faces.h"
#include "core/topology/surface_topology.h"
#include "tests/core/hyperbolic/groups.h"
#include "tests/core/parameterize/hyperbolic_surfaces.h"

namespace moduli {
namespace {

Development developed(const HyperbolicTriangles& triangles, Index root = kNone) {
  Context context;
  DevelopOptions options;
  options.root = root;
  auto development = develop(context, triangles, options);
  EXPECT_OK(development);
  return *std::move(development);
}

/// Edges are as long as they are, in one sheet that is cut as it must be.
void expectSewn(const HyperbolicTriangles& triangles, const DiskLayout& layout) {
  const DiskFaces disk{{triangles.surface, layout.points, layout.corner}, layout.neighbours};
  EXPECT_LT(layout.closure, 1e-12);
  for (Index h = 0; h < triangles.surface.halfedgeCount(); ++h) {
    ASSERT_NEAR(disk.length(h), triangles.lengths[h], 1e-12);
    ASSERT_NEAR(disk.angle(h), triangles.angles[h], 1e-11);
  }
  ASSERT_TRUE(disk.plane.namesAllCorners());
  EXPECT_EQ(disk.plane.eulerCharacteristic(), 1);
  EXPECT_NEAR(disk.area(), -2 * std::numbers::pi * triangles.surface.eulerCharacteristic(), 1e-11);
  expectSeams(disk);
}

/// No cut ends inside the polygon: but where it ends, a vertex has one image.
void expectNoLooseCuts(const HyperbolicTriangles& triangles, const DiskLayout& layout) {
  const Connectivity& surface = triangles.surface;
  const PlanarFaces plane{surface, layout.points, layout.corner};
  std::vector<int> cuts(surface.vertexCount(), 0);
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const Index twin = surface.twin(h);
    if (twin == kNone || h > twin || !plane.isSeam(h)) continue;
    ++cuts[surface.tail(h)];
    ++cuts[surface.head(h)];
  }
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (!surface.isBoundaryVertex(v)) {
      EXPECT_NE(cuts[v], 1);
    }
  }
}

TEST(DiskLayout, OfRegularSurfacesIsADomainFromEveryFace) {
  const double eta = 2 * std::cos(2 * std::numbers::pi / 7);
  const struct {
    const char* kind;
    int genus;
    double systole;
    std::size_t systoles;
  } known[] = {{"bolza", 2, 2 * std::acosh(1 + std::sqrt(2)), 12},
               {"klein", 3, 8 * std::acosh((1 + eta) / 2), 21}};
  for (const auto& [kind, genus, systole, systoles_count] : known) {
    const HyperbolicTriangles triangles = regularSample(kind);
    for (const Index root : {0, 5, 11, 15}) {
      SCOPED_TRACE(testing::Message() << kind << " from face " << root);
      const DiskLayout layout = sewUp(triangles, developed(triangles, root));
      expectSewn(triangles, layout);
      expectNoLooseCuts(triangles, layout);
      // The neighbours are enough for the group.
      Context context;
      const auto polygon = orbitPolygon(context, layout.neighbours, genus);
      ASSERT_OK(polygon);
      const auto shortest = systoles(context, *polygon);
      ASSERT_OK(shortest);
      EXPECT_EQ(shortest->geodesics.size(), systoles_count);
      EXPECT_NEAR(shortest->geodesics[0].length, systole, 1e-10);
    }
  }
}

TEST(DiskLayout, DoesNotMindLoopsAndFacesWithOneVertex) {
  for (const int genus : {2, 3, 4}) {
    const auto triangles = hyperbolicTriangles(polygonSurface(genus));
    ASSERT_OK(triangles);
    const DiskLayout layout = sewUp(*triangles, developed(*triangles));
    expectSewn(*triangles, layout);
  }
}

TEST(DiskLayout, OfABorderedSurfaceIsCutFromSideToSide) {
  const IntrinsicSurface pants = hexagonPants({2, 2.4, 3});
  Context context;
  const Uniformization found = uniformized(chordsOf(pants));
  const StraightFaces faces = straightFaces(found.metric);
  const auto count = static_cast<std::ptrdiff_t>(pants.connectivity.halfedgeCount());
  const HyperbolicTriangles triangles{pants.connectivity,
                                      {faces.lengths.begin(), faces.lengths.begin() + count},
                                      {faces.angles.begin(), faces.angles.begin() + count}};
  const DiskLayout layout = sewUp(triangles, developed(triangles));
  expectSewn(triangles, layout);
  expectNoLooseCuts(triangles, layout);
  // Cut twice, pants are a disk with three images of one boundary loop or two of each of two.
  const DiskFaces disk{{triangles.surface, layout.points, layout.corner}, layout.neighbours};
  EXPECT_EQ(layout.neighbours.size() % 2, 0U);
  EXPECT_GE(layout.neighbours.size(), 4U);
  EXPECT_GE(expectStraightBoundary(disk), 4);
}

TEST(DiskLayout, MeasuresItsRadius) {
  const HyperbolicTriangles triangles = regularSample("klein");
  const DiskLayout layout = sewUp(triangles, developed(triangles));
  double farthest = 0;
  for (const Complex point : layout.points) {
    farthest = std::max(farthest, hyperbolicDistance(point, 0.0));
  }
  EXPECT_EQ(layout.radius, farthest);
}

TEST(DiskLayout, ClosureTellsOfLengthsThatDoNotFit) {
  HyperbolicTriangles triangles = regularSample("klein");
  const Index h = 40, twin = triangles.surface.twin(h);
  triangles.lengths[h] = triangles.lengths[twin] = triangles.lengths[h] * (1 + 1e-8);
  const double closure = sewUp(triangles, developed(triangles)).closure;
  EXPECT_GT(closure, 1e-9);
  EXPECT_LT(closure, 1e-6);
}

}  // namespace
}  // namespace moduli
