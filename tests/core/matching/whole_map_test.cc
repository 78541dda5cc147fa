#include "core/matching/whole_map.h"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "core/matching/harmonic_match.h"
#include "core/matching/map_report.h"
#include "core/matching/settling.h"
#include "core/spherical/exact_sign.h"
#include "tests/core/matching/cover_samples.h"
#include "tests/core/matching/lumps.h"
#include "tests/core/spherical/sphere_testing.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Vector3d;
using surfaces::MappedSurface;

ThinnedSurface thinnedTo(const TriangleMesh& mesh, Index wanted) {
  Context context;
  auto thinned = thinSurface(context, mesh, wanted);
  EXPECT_OK(thinned);
  return *std::move(thinned);
}

Index foldedFaces(const Connectivity& surface, const Points3& points) {
  Index folded = 0;
  for (const auto& [i, j, k] : surface.faces()) {
    if (spherical::orientationSign(points[i], points[j], points[k]) <= 0) ++folded;
  }
  return folded;
}

Points3 wholeOf(const ThinnedSurface& thinned, const MappedSurface& a, const SphereLocator& sphere,
                const std::vector<Vector3d>& positions, const Points3& points) {
  Context context;
  auto whole = mapWhole(context, thinned, a.mesh, {sphere, positions}, points);
  EXPECT_OK(whole);
  EXPECT_EQ(whole->size(), a.points.size());
  EXPECT_EQ(foldedFaces(a.surface(), *whole), 0);
  return *std::move(whole);
}

// Of images that began at the vertices that stayed, moved by up to `noise`.
double meanErrorOnSphere(double resolution, Index wanted, double noise) {
  const MappedSurface a = surfaces::roundSphere(resolution, 5);
  const ThinnedSurface thinned = thinnedTo(a.mesh, wanted);
  const SphereLocator sphere = *SphereLocator::make(a.surface(), a.points);
  surfaces::RandomSphere random(3);
  Points3 points;
  for (const Index v : thinned.vertices) {
    points.push_back(random.awayFrom(a.points[v], noise * random.uniform()));
  }
  EXPECT_EQ(foldedFaces(thinned.mesh.connectivity(), points), 0);
  const Points3 whole = wholeOf(thinned, a, sphere, a.mesh.positions(), points);
  double sum = 0;
  for (std::size_t v = 0; v < whole.size(); ++v) sum += (whole[v] - a.points[v]).norm();
  return sum / static_cast<double>(whole.size());
}

TEST(WholeMap, OfTheIdentityIsNearlyTheIdentityOfASphere) {
  // What relaxing leaves is a small part of the edges of 0.07 that it moves along.
  const double error = meanErrorOnSphere(24, 800, 0);
  std::cout << "mean error " << error << "\n";
  EXPECT_LT(error, 0.07 / 100);
}

TEST(WholeMap, EvensOutWhatIsRough) {
  const double error = meanErrorOnSphere(24, 800, 0.01);
  std::cout << "mean error " << error << "\n";
  EXPECT_LT(error, 0.01);
}

TEST(WholeMap, FoldsNothingWhereTheThinnedMapIsFarFromAnIsometry) {
  const MappedSurface a = surfaces::roundSphere(24, 5), b = surfaces::roundSphere(16, 2);
  const ThinnedSurface thinned = thinnedTo(a.mesh, 400);
  const SphereLocator sphere = *SphereLocator::make(b.surface(), b.points);
  // A Möbius map that draws most of the sphere to one side, ten times as large there.
  Points3 points;
  for (const Index v : thinned.vertices) {
    const Vector3d& p = a.points[v];
    const double square = 10, t = p[2];
    const double up = ((square + 1) * t + (square - 1)) / ((square - 1) * t + (square + 1));
    const double side = 2 * std::sqrt(square) / ((square - 1) * t + (square + 1));
    points.push_back(Vector3d(side * p[0], side * p[1], up).normalized());
  }
  ASSERT_EQ(foldedFaces(thinned.mesh.connectivity(), points), 0);
  wholeOf(thinned, a, sphere, b.mesh.positions(), points);
}

TEST(WholeMap, StopsWhenCancelled) {
  const MappedSurface a = surfaces::roundSphere(12, 5);
  const ThinnedSurface thinned = thinnedTo(a.mesh, 200);
  const SphereLocator sphere = *SphereLocator::make(a.surface(), a.points);
  Points3 points;
  for (const Index v : thinned.vertices) points.push_back(a.points[v]);
  Context context;
  context.setDeadline(Context::Clock::now());
  EXPECT_THAT(mapWhole(context, thinned, a.mesh, {sphere, a.mesh.positions()}, points),
              FailsWith(Reason::kDeadlineExceeded));
}

/// The identity of a surface with handles by way of a thinned one.
MapErrors identityWithHandles(const TriangleSoup& soup, Index wanted) {
  const TriangleMesh mesh = meshOf(soup);
  const CoverSurface cover = coverOf(mesh);
  const ThinnedSurface thinned = thinnedTo(mesh, wanted);
  const std::vector<SurfacePoint> targets = vertexTargets(mesh, thinned.vertices);
  Context context;
  auto match = matchHarmonically(context, thinned.mesh.connectivity(), thinned.mesh.edgeLengths(),
                                 cover, targets);
  EXPECT_OK(match);
  EXPECT_OK(settle(context, thinned.mesh, mesh, cover, targets, match->map));
  const auto whole = mapWhole(context, thinned, mesh, mesh, cover, match->map);
  EXPECT_OK(whole);
  expectConsistent(mesh.connectivity(), cover, *whole);
  const VertexLinks links = linksOf(mesh.connectivity(), cover, *whole);
  EXPECT_NEAR(coveredArea(cover.geometry, mesh.connectivity(), links) / cover.area, 1, 1e-9);
  const MapErrors errors = errorsOf(mesh, whole->images, mesh.positions());
  std::cout << mesh.vertexCount() << " vertices by way of " << wanted << ": mean error "
            << errors.mean << ", largest " << errors.largest << "\n";
  return errors;
}

TEST(WholeMap, OfTheIdentityIsNearlyTheIdentityOfATorus) {
  // Edges of the thinned mesh are 0.06 long.
  EXPECT_LT(identityWithHandles(lumpyTorus(28, 1), 600).mean, 0.06 / 20);
}

TEST(WholeMap, OfTheIdentityIsNearlyTheIdentityOfAPlateWithTwoHoles) {
  EXPECT_LT(identityWithHandles(lumpyPlate(8, 2), 600).mean, 0.06 / 20);
}

}  // namespace
}  // namespace moduli
