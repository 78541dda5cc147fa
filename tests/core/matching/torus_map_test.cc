#include "core/matching/torus_map.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <complex>
#include <iostream>
#include <utility>

#include "core/forms/modular.h"
#include "core/mesh/read.h"
#include "tests/core/matching/cover_samples.h"
#include "tests/core/matching/renumbered.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// C / (Z + tau Z) in columns and rows of parallelograms, each cut along a diagonal.
struct Grid {
  Connectivity surface;
  std::vector<double> lengths;
};

Grid gridTorus(Complex tau, int columns, int rows) {
  std::vector<Triangle> faces;
  const auto at = [&](int x, int y) {
    return static_cast<Index>((y % rows) * columns + x % columns);
  };
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      faces.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      faces.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
  Grid grid{*Connectivity::fromFaces(columns * rows, std::move(faces)), {}};
  const Complex along(1.0 / columns, 0), up = tau / static_cast<double>(rows);
  for (Index e = 0; e < grid.surface.edgeCount(); ++e) {
    const Index h = grid.surface.halfedge(e);
    const std::array<Complex, 3> first = {along, up, along + up};
    const std::array<Complex, 3> second = {along + up, along, up};
    grid.lengths.push_back(std::abs(h / 3 % 2 == 0 ? first[h % 3] : second[h % 3]));
  }
  return grid;
}

CoverSurface coverOf(const Grid& grid) {
  Context context;
  auto made = straightCover(context, grid.surface, grid.lengths);
  EXPECT_OK(made);
  return *std::move(made);
}

std::vector<SurfacePoint> sameVertices(const Connectivity& surface) {
  std::vector<SurfacePoint> points;
  for (Index v = 0; v < surface.vertexCount(); ++v) points.push_back(vertexPoint(surface, v));
  return points;
}

TEST(TorusMap, StretchesASquareTorusToARectangle) {  // CHECKS H1.
  Context context;
  const CoverSurface a = coverOf(gridTorus({0, 1}, 12, 12));
  for (const double t : {1.0, 1.5, 2.0, 5.0}) {
    const CoverSurface b = coverOf(gridTorus({0, t}, 12, 12));
    const auto map = affineTorusMap(context, a, b, sameVertices(a.surface));
    ASSERT_OK(map);
    EXPECT_NEAR(map->dilatation, t, 1e-10);
    EXPECT_NEAR(map->distance, std::log(t) / 2, 1e-10);
    // By the direction of the first period, whatever way the faces' coordinates are turned.
    const auto shape = torusShape(a);
    const Complex first(shape->steps[0][0], shape->steps[0][1]);
    const Complex mu = map->beltrami * std::conj(first) / first;
    EXPECT_NEAR(std::abs(mu - (1 - t) / (1 + t)), 0, 1e-10);
    expectConsistent(a.surface, b, map->map);
    EXPECT_LT(map->offset, 1e-10);
  }
}

TEST(TorusMap, HasTheTeichmullerDistanceInTheBestMarking) {
  // Ratios that are reduced, and not; near the border of the fundamental domain, and far inside.
  Context context;
  const std::vector<Complex> ratios = {{0, 1},     {0.5, 0.9},  {-0.48, 1.3}, {0.49, 1.2},
                                       {0.2, 2.5}, {1.3, 0.45}, {-0.3, 0.7},  {0.1, 6}};
  for (const Complex& first : ratios) {
    const CoverSurface a = coverOf(gridTorus(first, 9, 8));
    const auto shape = torusShape(a);
    ASSERT_OK(shape);
    EXPECT_NEAR(shape->periods.determinant(), 1, 1e-12);
    EXPECT_NEAR(teichmullerDistance(periodRatio(shape->periods), first), 0, 1e-8);
    for (const Complex& second : ratios) {
      const CoverSurface b = coverOf(gridTorus(second, 10, 7));
      const auto map = affineTorusMap(context, a, b, {}, {0});
      ASSERT_OK(map);
      EXPECT_NEAR(map->distance, teichmullerDistance(first, second), 1e-8) << first << second;
      EXPECT_EQ(map->marking.determinant(), 1);
      expectConsistent(a.surface, b, map->map);
    }
  }
}

TEST(TorusMap, IsTheIdentityOfARenumberedCopy) {
  Context context;
  const TriangleSoup soup = lumpyTorus(12, 2);
  const Renumbered other = renumbered(moved(soup), 4);
  const TriangleMesh a = meshOf(soup), b = meshOf(other.soup);
  const CoverSurface from = moduli::coverOf(a), to = moduli::coverOf(b);
  const std::vector<Eigen::Vector3d> truth = vertexPlaces(b, other.image);
  const auto told = affineTorusMap(context, from, to, vertexTargets(b, other.image));
  ASSERT_OK(told);
  EXPECT_NEAR(told->dilatation, 1, 1e-9);
  EXPECT_LT(errorsOf(b, told->map.images, truth).largest, 1e-9);
  // By shape alone: the marking, one of two at least, and the shift to what a search to 1e-9 in
  // the lattice's coordinates leaves, where the field's peak is flat to 1e-16 of its height: 1e-8.
  const auto found = affineTorusMap(context, from, to, {});
  ASSERT_OK(found);
  EXPECT_EQ(found->marking, told->marking);
  EXPECT_GT(found->correlation, 1 - 1e-9);
  EXPECT_LT(errorsOf(b, found->map.images, truth).largest, 1e-6);
}

TEST(TorusMap, FindsAMirrorImageThroughReversedFaces) {
  Context context;
  TriangleSoup soup = lumpyTorus(12, 2);
  const TriangleMesh b = meshOf(mirrored(soup));
  // Without the reversal the best map is far from a copy.
  const CoverSurface to = moduli::coverOf(b);
  const TriangleMesh straight = meshOf(soup);
  const auto wrong = affineTorusMap(context, moduli::coverOf(straight), to, {});
  ASSERT_OK(wrong);
  EXPECT_LT(wrong->correlation, 0.98);
  for (Triangle& face : soup.faces) std::swap(face[1], face[2]);
  const TriangleMesh a = meshOf(soup);
  const auto map = affineTorusMap(context, moduli::coverOf(a), to, {});
  ASSERT_OK(map);
  EXPECT_GT(map->correlation, 1 - 1e-9);
  EXPECT_LT(errorsOf(b, map->map.images, b.positions()).largest, 1e-6);
}

TEST(TorusMap, ReadsTheMarkingOffTheTargets) {
  // A twisted by one turn along its first period: its targets wind as M = [[1, 1], [0, 1]].
  Context context;
  const int n = 12;
  const CoverSurface a = coverOf(gridTorus({0, 1}, n, n)), b = a;
  std::vector<SurfacePoint> targets;
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      targets.push_back(vertexPoint(b.surface, y * n + (x + y) % n));
    }
  }
  const auto map = affineTorusMap(context, a, b, targets);
  ASSERT_OK(map);
  // The shear by 1: K + 1 / K = |M|^2 = 3.
  EXPECT_NEAR(map->dilatation, (3 + std::sqrt(5.0)) / 2, 1e-10);
  EXPECT_LT(map->offset, 1e-10);
  expectConsistent(a.surface, b, map->map);
}

TEST(TorusMap, IsNotLedAstrayByWrongTargets) {
  Context context;
  const TriangleMesh a = meshOf(lumpyTorus(16, 2));
  const CoverSurface cover = moduli::coverOf(a);
  std::vector<SurfacePoint> targets = vertexTargets(a, sameNumbers(a));
  SampleRandom random(3);
  for (SurfacePoint& target : targets) {
    if (random.uniform() < 0.05) {
      target = vertexPoint(a.connectivity(), static_cast<Index>(random.next() % targets.size()));
    }
  }
  const auto map = affineTorusMap(context, cover, cover, targets);
  ASSERT_OK(map);
  EXPECT_NEAR(map->dilatation, 1, 1e-9);
  EXPECT_LT(errorsOf(a, map->map.images, a.positions()).largest, 1e-6);
}

TEST(TorusMap, RefusesOtherSurfacesAndStopsWhenItIsTold) {
  Context context;
  const TriangleMesh plate = meshOf(lumpyPlate(2, 0)), torus = meshOf(lumpyTorus(8, 1));
  const CoverSurface a = moduli::coverOf(plate), b = moduli::coverOf(torus);
  EXPECT_THAT(affineTorusMap(context, a, b, {}), FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(affineTorusMap(context, b, b, {SurfacePoint()}), FailsWith(Reason::kInvalidOption));
  const TriangleMesh sphere = meshOf(*makeSample("sphere", {{"resolution", 3}}));
  EXPECT_THAT(straightCover(context, sphere.connectivity(), sphere.edgeLengths()),
              FailsWith(Reason::kUnsupportedTopology));
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(affineTorusMap(context, b, b, {}), FailsWith(Reason::kCancelled));
  EXPECT_THAT(affineTorusMap(context, b, b, vertexTargets(torus, sameNumbers(torus))),
              FailsWith(Reason::kCancelled));
}

TEST(TorusMap, MatchesRealTori) {
  Context context;
  MODULI_NEED_SHARED_MESH(coarse, "genus1/ceaedf__rocker-arm2500.off");
  MODULI_NEED_SHARED_MESH(fine, "genus1/alec__rocker-arm.obj");
  const TriangleMesh a = meshOf(*readMeshFile(context, coarse));
  const TriangleMesh b = meshOf(*readMeshFile(context, fine));
  const CoverSurface from = moduli::coverOf(a), to = moduli::coverOf(b);
  const auto map = affineTorusMap(context, from, to, {});
  ASSERT_OK(map);
  expectConsistent(a.connectivity(), to, map->map);
  // One of them is a remeshing of the other, at its place.
  const MapErrors errors = errorsOf(b, map->map.images, a.positions());
  std::cout << "rocker-arm: K " << map->dilatation << ", correlation " << map->correlation
            << ", mean error " << errors.mean << ", largest " << errors.largest << "\n";
  EXPECT_LT(map->dilatation, 1.01);
  EXPECT_LT(errors.mean, 0.01);
}

}  // namespace
}  // namespace moduli
