#include "core/parameterize/overlaps.h"

#include <cmath>
#include <complex>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/parameterize/circle_domain.h"
#include "core/parameterize/disk.h"
#include "core/parameterize/flat.h"
#include "core/parameterize/hyperbolic.h"
#include "core/parameterize/rectangle.h"
#include "core/topology/surface_topology.h"
#include "tests/core/parameterize/plane_targets.h"

namespace moduli {
namespace {

using Plane = std::complex<double>;
using Corners = std::array<Plane, 3>;

/// Faces that share no points.
std::int64_t overlapsOf(const std::vector<Corners>& triangles) {
  std::vector<Plane> points;
  std::vector<Index> corner;
  for (const Corners& triangle : triangles) {
    for (const Plane p : triangle) {
      corner.push_back(static_cast<Index>(points.size()));
      points.push_back(p);
    }
  }
  return countOverlaps(points, corner);
}

double cross(Plane a, Plane b) {
  return std::imag(std::conj(a) * b);
}

/// Area of what two triangles share, by clipping one at the sides of the other.
double sharedArea(Corners a, Corners b) {
  if (cross(a[1] - a[0], a[2] - a[0]) < 0) std::swap(a[1], a[2]);
  std::vector<Plane> polygon(b.begin(), b.end());
  for (int c = 0; c < 3; ++c) {
    std::vector<Plane> kept;
    const auto height = [&](Plane p) { return cross(a[(c + 1) % 3] - a[c], p - a[c]); };
    for (std::size_t n = 0; n < polygon.size(); ++n) {
      const Plane p = polygon[n], q = polygon[(n + 1) % polygon.size()];
      const double s = height(p), t = height(q);
      if (s >= 0) kept.push_back(p);
      if ((s > 0 && t < 0) || (s < 0 && t > 0)) kept.push_back(p + s / (s - t) * (q - p));
    }
    polygon = std::move(kept);
  }
  double area = 0;
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    area += cross(polygon[n], polygon[(n + 1) % polygon.size()]) / 2;
  }
  return std::abs(area);
}

TEST(Overlaps, OfTwoTrianglesAreThoseOfTheirInsides) {
  const Corners unit = {Plane(0, 0), Plane(1, 0), Plane(0, 1)};
  EXPECT_EQ(overlapsOf({unit, unit}), 1);
  // The same the other way up, inside, and crossing without a corner inside.
  EXPECT_EQ(overlapsOf({unit, {Plane(0, 0), Plane(0, 1), Plane(1, 0)}}), 1);
  EXPECT_EQ(overlapsOf({unit, {Plane(.1, .1), Plane(.3, .1), Plane(.1, .3)}}), 1);
  EXPECT_EQ(overlapsOf({{Plane(0, 0), Plane(6, 0), Plane(3, 5)},
                        {Plane(0, 3), Plane(3, -2), Plane(6, 3)}}),
            1);
  // Side to side, corner to side, corner to corner, apart, without area.
  EXPECT_EQ(overlapsOf({unit, {Plane(1, 0), Plane(1, 1), Plane(0, 1)}}), 0);
  EXPECT_EQ(overlapsOf({unit, {Plane(.5, .5), Plane(1, .5), Plane(1, 1)}}), 0);
  EXPECT_EQ(overlapsOf({unit, {Plane(1, 0), Plane(2, 0), Plane(2, 1)}}), 0);
  EXPECT_EQ(overlapsOf({unit, {Plane(5, 5), Plane(6, 5), Plane(5, 6)}}), 0);
  EXPECT_EQ(overlapsOf({unit, {Plane(.1, .1), Plane(.2, .2), Plane(.3, .3)}}), 0);
}

TEST(Overlaps, AreSeenToTheLastBit) {
  // x + y <= 1 against its mirror image, moved by one unit in the last place.
  const Corners unit = {Plane(0, 0), Plane(1, 0), Plane(0, 1)};
  const double below = std::nextafter(0.5, 0), above = std::nextafter(0.5, 1);
  EXPECT_EQ(overlapsOf({unit, {Plane(below, .5), Plane(1, .5), Plane(1, 1)}}), 1);
  EXPECT_EQ(overlapsOf({unit, {Plane(.5, .5), Plane(1, .5), Plane(1, 1)}}), 0);
  EXPECT_EQ(overlapsOf({unit, {Plane(above, .5), Plane(1, .5), Plane(1, 1)}}), 0);
}

TEST(Overlaps, AgreeWithClippingOfTrianglesOnAGrid) {
  // Whole corners up to 12: what two triangles share is 0 or larger than 1 / 12^5.
  std::mt19937 random(3);
  std::vector<Corners> triangles;
  const auto whole = [&] { return static_cast<double>(random() % 13); };
  while (triangles.size() < 120) {
    const Corners t = {Plane(whole(), whole()), Plane(whole(), whole()), Plane(whole(), whole())};
    if (std::abs(cross(t[1] - t[0], t[2] - t[0])) < 30) triangles.push_back(t);
  }
  std::int64_t shared = 0;
  for (std::size_t a = 0; a < triangles.size(); ++a) {
    for (std::size_t b = a + 1; b < triangles.size(); ++b) {
      const bool flat =
          cross(triangles[a][1] - triangles[a][0], triangles[a][2] - triangles[a][0]) == 0;
      shared += !flat && sharedArea(triangles[a], triangles[b]) > 1e-9 ? 1 : 0;
    }
  }
  EXPECT_GT(shared, 100);
  EXPECT_EQ(overlapsOf(triangles), shared);
}

/// A grid of squares in the plane, each of two faces.
struct Sheet {
  MetricSurface metric = plate(8, 8, {});
  std::vector<Plane> points;
  std::vector<Index> corner;

  Sheet() {
    FlatOptions options;
    Context context;
    auto flat = parameterizeFlat(context, metric.surface, metric.lengths, options);
    EXPECT_OK(flat);
    points = flat->points;
    corner = flat->corner;
  }
};

TEST(Overlaps, OfAPlantedFaultAreFound) {
  Sheet sheet;
  EXPECT_EQ(countOverlaps(sheet.points, sheet.corner), 0);
  EXPECT_EQ(cutOverlaps(sheet.metric.surface, sheet.points, sheet.corner), 1);
  const std::vector<Plane> before = sheet.points;
  // An inner point pulled across its neighbours.
  Index inner = 0;
  while (sheet.metric.surface.isBoundaryVertex(inner)) ++inner;
  const Index h = sheet.metric.surface.outgoing(inner);
  sheet.points[sheet.corner[h]] += Plane(1.7, 0.1);
  const auto pairs = findOverlaps(sheet.points, sheet.corner, 1000);
  EXPECT_GT(pairs.size(), 3U);
  EXPECT_EQ(countOverlaps(sheet.points, sheet.corner), static_cast<std::int64_t>(pairs.size()));
  EXPECT_EQ(findOverlaps(sheet.points, sheet.corner, 2).size(), 2U);
  EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
  EXPECT_EQ(before.size(), sheet.points.size());
}

TEST(CutOverlaps, OfAStripThatWindsTwiceMakesIslands) {
  // A ring of 40 squares around 0 that goes around twice: all of it lies on itself.
  const int n = 40;
  std::vector<Eigen::Vector3d> positions;
  std::vector<Triangle> faces;
  std::vector<Plane> points;
  for (int i = 0; i <= n; ++i) {
    const double angle = 4 * 3.141592653589793 * i / n;
    for (const double r : {1.0, 2.0}) {
      points.push_back(std::polar(r, angle));
      positions.emplace_back(r, i, 0);
    }
    if (i == n) break;
    faces.push_back({2 * i, 2 * i + 1, 2 * i + 3});
    faces.push_back({2 * i, 2 * i + 3, 2 * i + 2});
  }
  const MetricSurface strip = fromPositions(positions, faces);
  std::vector<Index> corner;
  for (Index h = 0; h < strip.surface.halfedgeCount(); ++h) corner.push_back(strip.surface.tail(h));
  const std::vector<Plane> before = points;
  const std::vector<Index> corner_before = corner;
  EXPECT_GE(countOverlaps(points, corner), 2 * n);
  const Index islands = cutOverlaps(strip.surface, points, corner);
  EXPECT_GE(islands, 2);
  EXPECT_LE(islands, 4);
  EXPECT_EQ(countOverlaps(points, corner), 0);
  // Faces are only moved.
  const PlanarFaces was{strip.surface, before, corner_before}, is{strip.surface, points, corner};
  EXPECT_TRUE(is.namesAllCorners());
  for (Index h = 0; h < strip.surface.halfedgeCount(); ++h) {
    EXPECT_NEAR(std::abs(is.along(h) - was.along(h)), 0, 1e-12);
  }
  const std::vector<Index> island = islandsOf(strip.surface, corner);
  EXPECT_EQ(*std::max_element(island.begin(), island.end()) + 1, islands);
}

TEST(Overlaps, AreNoneInTheImagesOfOtherTargets) {
  Context context;
  const MetricSurface disk = plate(6, 4, {{2, 2}});
  const MetricSurface genus_two = planeSample("genus", {{"genus", 2}, {"resolution", 4}});
  const auto hyperbolic = parameterizeHyperbolic(context, genus_two.surface, genus_two.lengths, {});
  ASSERT_OK(hyperbolic);
  EXPECT_EQ(countOverlaps(hyperbolic->points, hyperbolic->corner), 0);
  const auto ring = parameterizeFlat(context, disk.surface, disk.lengths, {});
  ASSERT_OK(ring);
  EXPECT_EQ(countOverlaps(ring->points, ring->corner), 0);
}

class OpenMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, OpenMesh,
                         testing::Values("disk/libigl-data__camelhead.off", "disk/cfwen__face.off",
                                         "disk/gpeyre__venus.off", "disk/libigl-data__snail.obj"));

TEST_P(OpenMesh, LiesOnItselfInNoImage) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  Context context;
  const auto soup = readMeshFile(context, path);
  ASSERT_OK(soup);
  const MetricSurface given = fromPositions(soup->vertices, soup->faces);
  const auto disk = parameterizeDisk(context, given.surface, given.lengths, soup->vertices, {});
  ASSERT_OK(disk);
  EXPECT_EQ(countOverlaps(disk->points, disk->corner), 0);
  RectangleOptions options;
  const auto loop = computeTopology(given.surface).boundary_loops.at(0);
  for (std::size_t k = 0; k < 4; ++k) {
    options.corners[k] = given.surface.tail(loop[k * loop.size() / 4]);
  }
  const auto rectangle =
      parameterizeRectangle(context, given.surface, given.lengths, soup->vertices, options);
  ASSERT_OK(rectangle);
  EXPECT_EQ(countOverlaps(rectangle->points, rectangle->corner), 0);
  const auto flat = parameterizeFlat(context, given.surface, given.lengths, {});
  ASSERT_OK(flat);
  EXPECT_EQ(countOverlaps(flat->points, flat->corner), 0);
  EXPECT_EQ(flat->certificate.quality.flipped_faces, 0);
  std::cout << *flat->certificate.islands << " islands\n";
}

}  // namespace
}  // namespace moduli
