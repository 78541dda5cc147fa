#include "core/matching/thinned_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>
#include <numeric>
#include <set>

#include "core/matching/map_report.h"
#include "core/matching/nearest_in_triangle.h"
#include "core/mesh/samples.h"
#include "core/mesh/triangle_geometry.h"
#include "tests/core/matching/cover_samples.h"
#include "tests/core/matching/lumps.h"
#include "tests/core/matching/renumbered.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

constexpr Index kWanted = 600;

ThinnedSurface thinnedTo(const TriangleMesh& mesh, Index wanted) {
  Context context;
  auto thinned = thinSurface(context, mesh, wanted);
  EXPECT_OK(thinned);
  return *std::move(thinned);
}

double sumOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

std::vector<double> vertexShares(const TriangleMesh& mesh) {
  std::vector<double> shares(mesh.vertexCount(), 0.0);
  const std::vector<double> areas = mesh.faceAreas();
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    for (const Index v : mesh.connectivity().face(f)) shares[v] += areas[f] / 3;
  }
  return shares;
}

TEST(ThinnedSurface, IsOfTheSameTopologyThroughSomeOfTheVertices) {
  for (const TriangleSoup& soup : {lump(24, 1), lumpyTorus(28, 1), lumpyPlate(8, 2)}) {
    const TriangleMesh whole = meshOf(soup);
    const ThinnedSurface thinned = thinnedTo(whole, kWanted);
    const Connectivity& surface = thinned.mesh.connectivity();
    ASSERT_GT(whole.vertexCount(), 2 * kWanted);
    EXPECT_EQ(thinned.mesh.vertexCount(), kWanted);
    EXPECT_EQ(surface.eulerCharacteristic(), whole.connectivity().eulerCharacteristic());
    EXPECT_TRUE(std::is_sorted(thinned.vertices.begin(), thinned.vertices.end()));
    for (Index v = 0; v < kWanted; ++v) {
      EXPECT_EQ(thinned.mesh.positions()[v], whole.positions()[thinned.vertices[v]]);
    }
    // Chords of edges h long on curvatures k cut (k h)^2 / 24 of a length off; with h = sqrt(2.3 /
    // 600) = 0.06 of the root of the area and curvatures of up to 12 that is 2 % at most.
    EXPECT_NEAR(thinned.mesh.area() / whole.area(), 1, 0.04);
  }
}

TEST(ThinnedSurface, HasNoNewNeedles) {
  const TriangleMesh whole = meshOf(lump(24, 1));
  const ThinnedSurface thinned = thinnedTo(whole, kWanted);
  const auto thinnest = [](const TriangleMesh& mesh) {
    double least = 1;
    for (const auto& [i, j, k] : mesh.connectivity().faces()) {
      const auto& p = mesh.positions();
      least = std::min(least, triangleShape(p[i], p[j], p[k]).relative_area);
    }
    return least;
  };
  EXPECT_GE(thinnest(thinned.mesh), std::min(0.1, thinnest(whole)));
}

TEST(ThinnedSurface, LeadsBackToTheWhole) {
  const TriangleMesh whole = meshOf(lumpyTorus(24, 1));
  ThinnedSurface thinned = thinnedTo(whole, 300);
  const RingMesh before = *RingMesh::make(whole.connectivity());
  while (thinned.rings.vertexCount() < whole.vertexCount()) thinned.rings.restore();
  for (Index v = 0; v < whole.vertexCount(); ++v) {
    const std::set<Index> one(before.ring(v).begin(), before.ring(v).end());
    const std::set<Index> other(thinned.rings.ring(v).begin(), thinned.rings.ring(v).end());
    EXPECT_EQ(one, other);
  }
}

TEST(ThinnedSurface, DoesNotDependOnNumbersPlaceAndSize) {
  const TriangleSoup soup = lump(20, 1);
  const Renumbered other = renumbered(moved(soup), 3);
  const ThinnedSurface one = thinnedTo(meshOf(soup), kWanted);
  const ThinnedSurface two = thinnedTo(meshOf(other.soup), kWanted);
  std::set<Index> images;
  for (const Index v : one.vertices) images.insert(other.image[v]);
  EXPECT_EQ(images, std::set<Index>(two.vertices.begin(), two.vertices.end()));
}

TEST(ThinnedSurface, GathersAllThereIsNearWhereItWas) {
  const TriangleMesh whole = meshOf(lump(24, 1));
  const ThinnedSurface thinned = thinnedTo(whole, kWanted);
  const std::vector<double> gathered = moduli::gathered(whole, thinned, vertexShares(whole));
  ASSERT_EQ(gathered.size(), thinned.vertices.size());
  EXPECT_NEAR(sumOf(gathered) / whole.area(), 1, 1e-12);
  // Against the areas of the thinned mesh itself, smoothed: the first moments agree within an edge
  // of 0.06 of the root of the area.
  const std::vector<double> own = vertexShares(thinned.mesh);
  Vector3d gap = Vector3d::Zero();
  double away = 0;
  for (std::size_t v = 0; v < own.size(); ++v) {
    const Vector3d& p = thinned.mesh.positions()[v];
    gap += (gathered[v] / sumOf(gathered) - own[v] / sumOf(own)) * p;
    away += std::abs(gathered[v] / sumOf(gathered) - own[v] / sumOf(own));
  }
  std::cout << "moments apart " << gap.norm() / std::sqrt(whole.area()) << ", shares " << away
            << "\n";
  EXPECT_LT(gap.norm() / std::sqrt(whole.area()), 0.06);
  EXPECT_LT(away, 0.5);  // 2 were all of it elsewhere.
}

TEST(ThinnedSurface, FindsVerticesWhereTheyAre) {
  const TriangleMesh whole = meshOf(lump(24, 1));
  const ThinnedSurface thinned = thinnedTo(whole, kWanted);
  std::vector<SurfacePoint> points;
  for (Index v = 0; v < kWanted; ++v) {
    points.push_back(vertexPoint(thinned.mesh.connectivity(), v));
  }
  const std::vector<SurfacePoint> found = onWhole(whole, thinned, points);
  for (Index v = 0; v < kWanted; ++v) {
    EXPECT_EQ(spacePoint(whole.connectivity(), whole.positions(), found[v]),
              thinned.mesh.positions()[v]);
  }
}

// Of all faces, one by one.
double distanceTo(const TriangleMesh& mesh, const Vector3d& place) {
  const auto& p = mesh.positions();
  double least = std::numeric_limits<double>::infinity();
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    const auto& [i, j, k] = mesh.connectivity().face(f);
    const SurfacePoint point = {f, nearestInTriangle(place, p[i], p[j], p[k])};
    const Vector3d there = spacePoint(mesh.connectivity(), p, point);
    least = std::min(least, (there - place).norm());
  }
  return least;
}

TEST(ThinnedSurface, FindsPointsAsNearAsAllFacesHave) {
  const TriangleMesh whole = meshOf(lump(16, 1));
  const ThinnedSurface thinned = thinnedTo(whole, 300);
  std::vector<SurfacePoint> points;
  for (Index f = 0; f < thinned.mesh.faceCount(); f += 7) {
    points.push_back({f, {1.0 / 3, 1.0 / 3, 1.0 / 3}});
  }
  const std::vector<SurfacePoint> found = onWhole(whole, thinned, points);
  int apart = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d place =
        spacePoint(thinned.mesh.connectivity(), thinned.mesh.positions(), points[i]);
    const Vector3d there = spacePoint(whole.connectivity(), whole.positions(), found[i]);
    const double least = distanceTo(whole, place);
    // The vertex nearest to a place is not always one of the nearest face: an edge at most.
    EXPECT_LT((there - place).norm(), least + 0.06 * std::sqrt(whole.area()));
    if ((there - place).norm() > least + 1e-12) ++apart;
  }
  EXPECT_LE(apart, static_cast<int>(points.size() / 10));
}

TEST(ThinnedSurface, IsOfClosedSurfacesAlone) {
  Context context;
  TriangleSoup open = lump(8, 1);
  open.faces.pop_back();
  EXPECT_THAT(thinSurface(context, meshOf(open), 50), FailsWith(Reason::kUnsupportedTopology));
}

TEST(NearestInTriangle, ProjectsOntoInsidesSidesAndCorners) {
  const Vector3d a(0, 0, 0), b(2, 0, 0), c(0, 2, 0);
  using Weights = std::array<double, 3>;
  EXPECT_EQ(nearestInTriangle(Vector3d(0.5, 0.5, 3), a, b, c), (Weights{0.5, 0.25, 0.25}));
  EXPECT_EQ(nearestInTriangle(Vector3d(2, 2, 0), a, b, c), (Weights{0, 0.5, 0.5}));
  EXPECT_EQ(nearestInTriangle(Vector3d(1, -1, 0), a, b, c), (Weights{0.5, 0.5, 0}));
  EXPECT_EQ(nearestInTriangle(Vector3d(-1, -1, 1), a, b, c), (Weights{1, 0, 0}));
  EXPECT_EQ(nearestInTriangle(Vector3d(3, 0, 1), a, b, a), (Weights{0, 1, 0}));  // A segment.
}

}  // namespace
}  // namespace moduli
