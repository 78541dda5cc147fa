#include "core/spherical/sphere_locator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/spherical/point_tree.h"
#include "tests/core/mesh/shapes.h"
#include "tests/core/spherical/sphere_testing.h"

namespace moduli {
namespace {

using surfaces::MappedSurface;
using surfaces::RandomSphere;

SphereLocator locatorOf(const MappedSurface& map) {
  auto locator = SphereLocator::make(map.surface(), map.points);
  EXPECT_OK(locator);
  return *std::move(locator);
}

/// The place holds the direction, and the brute-force twin finds the same one.
/// width: of the thinnest faces, by their length.
void expectFound(const SphereLocator& locator, const Eigen::Vector3d& direction,
                 double width = 0.1) {
  const SurfacePoint place = locator.locate(direction);
  double sum = 0;
  for (const double weight : place.barycentric) {
    EXPECT_GE(weight, 0);
    sum += weight;
  }
  EXPECT_NEAR(sum, 1, 1e-15 * 4);
  const Eigen::Vector3d back = spherePoint(locator.surface(), locator.points(), place);
  EXPECT_LT((back - direction.normalized()).norm(), 1e-15 / width);
  const SurfacePoint slow = locator.locateSlowly(direction);
  const Eigen::Vector3d twin = spherePoint(locator.surface(), locator.points(), slow);
  EXPECT_LT((back - twin).norm(), 1e-15 / width);
}

TEST(PointTree, FindsWhatLookingAtAllFinds) {
  RandomSphere random(2);
  for (const int count : {1, 2, 3, 10, 1000}) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < count; ++i) points.push_back(random.direction() * random.uniform());
    points.push_back(points.front());  // Twice the same.
    const spherical::PointTree tree(points);
    for (int i = 0; i < 300; ++i) {
      const Eigen::Vector3d query = 2 * random.uniform() * random.direction();
      const Index twin = surfaces::nearestVertex(points, query);
      EXPECT_EQ((points[tree.nearest(query)] - query).norm(), (points[twin] - query).norm());
    }
  }
  EXPECT_EQ(spherical::PointTree({}).nearest({1, 0, 0}), kNone);
}

TEST(SphereLocator, FindsRandomDirectionsAsItsTwinDoes) {
  const MappedSurface map = surfaces::roundSphere(12, 3);
  const SphereLocator locator = locatorOf(map);
  RandomSphere random(4);
  for (int i = 0; i < 500; ++i) expectFound(locator, random.direction());
  expectFound(locator, {0, 0, 1e-3});
  expectFound(locator, {0, -7, 0});
}

TEST(SphereLocator, FindsPointsOfFacesEdgesAndVertices) {
  const MappedSurface map = surfaces::roundSphere(6, 3);
  const SphereLocator locator = locatorOf(map);
  RandomSphere random(5);
  for (Index f = 0; f < map.surface().faceCount(); ++f) {
    const double s = random.uniform(), t = random.uniform();
    const SurfacePoint inside{f, {(1 - s), s * t, s * (1 - t)}};
    const SurfacePoint place = locator.locate(spherePoint(map.surface(), map.points, inside));
    if (std::min({1 - s, s * t, s * (1 - t)}) > 1e-12) {
      EXPECT_EQ(place.face, f);
      // Rounding of the point over edges of 0.15.
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(place.barycentric[c], inside.barycentric[c], 1e-14);
    }
    expectFound(locator, spherePoint(map.surface(), map.points, edgePoint(3 * f + 1, t)));
  }
  for (Index v = 0; v < map.surface().vertexCount(); ++v) {
    const SurfacePoint place = locator.locate(map.points[v]);
    int corners = 0;
    for (int c = 0; c < 3; ++c) {
      if (map.surface().face(place.face)[c] != v) continue;
      EXPECT_EQ(place.barycentric[c], 1);
      ++corners;
    }
    EXPECT_EQ(corners, 1);
  }
}

TEST(SphereLocator, NeverFailsInCrowdedAndThinTriangles) {
  // A linear map of space carries cones to cones: it folds no face, however it crowds them.
  const MappedSurface map = surfaces::roundSphere(10, 3);
  RandomSphere random(6);
  for (const Eigen::Vector3d& stretch :
       {Eigen::Vector3d(1, 1, 1e-3), {1e-2, 1, 1e-2}, {1, 0.1, 1e-3}, {1, 1e-3, 1e-6}}) {
    const Eigen::Matrix3d linear = surfaces::rotation(2) * stretch.asDiagonal();
    MappedSurface crowded = map;
    for (Eigen::Vector3d& p : crowded.points) p = (linear * p).normalized();
    const SphereLocator locator = locatorOf(crowded);
    for (int i = 0; i < 200; ++i) {
      for (const Eigen::Vector3d& p :
           {random.direction(), Eigen::Vector3d(linear * random.direction())}) {
        // The face is right in any case. Where it reaches half around the sphere, as under the last
        // map, weights lose their meaning.
        EXPECT_EQ(locator.locate(p).face, locator.locateSlowly(p).face);
        if (stretch.minCoeff() > 1e-5) expectFound(locator, p, stretch.minCoeff());
      }
    }
  }
}

TEST(SphereLocator, WorksOnAnOctahedronAndABrain) {
  const TriangleMesh octahedron = surfaces::mesh(shapes::octahedron());
  MappedSurface map{octahedron, octahedron.positions()};
  for (Eigen::Vector3d& p : map.points) p.normalize();
  RandomSphere random(7);
  const SphereLocator locator = locatorOf(map);
  for (int i = 0; i < 200; ++i) expectFound(locator, random.direction());

  MODULI_NEED_SHARED_MESH(path, "brain/nilearn__pial_left.ply");
  const MappedSurface brain = surfaces::mappedMesh(path);
  const SphereLocator on_brain = locatorOf(brain);
  for (int i = 0; i < 200; ++i) expectFound(on_brain, random.direction());
}

TEST(SphereLocator, RefusesFoldsAndWrongSizes) {
  MappedSurface map = surfaces::roundSphere(3, 0);
  EXPECT_OK(SphereLocator::make(map.surface(), map.points));
  for (Eigen::Vector3d& p : map.points) p = -p;
  EXPECT_THAT(SphereLocator::make(map.surface(), map.points), FailsWith(Reason::kFoldedMap));
  map.points.pop_back();
  EXPECT_THAT(SphereLocator::make(map.surface(), map.points), FailsWith(Reason::kInvalidOption));
  const TriangleMesh disk = surfaces::mesh(shapes::disk());
  EXPECT_THAT(SphereLocator::make(disk.connectivity(), disk.positions()),
              FailsWith(Reason::kUnsupportedTopology));
}

}  // namespace
}  // namespace moduli
