#include "core/matching/map_report.h"

#include <gtest/gtest.h>

#include "core/spherical/map_quality.h"
#include "tests/core/spherical/sphere_testing.h"

namespace moduli {
namespace {

using surfaces::MappedSurface;

TEST(MapReport, AgreesWithTheQualityOfASphereMap) {
  const TriangleMesh ellipsoid =
      surfaces::mesh(surfaces::sample("ellipsoid", {{"resolution", 8}, {"seed", 3}}));
  Points3 points = ellipsoid.positions();
  for (Eigen::Vector3d& p : points) p.normalize();
  const MapReport report = measureSpaceMap(ellipsoid.connectivity(), ellipsoid.positions(), points);
  const MapQuality twin =
      measureSphereMap(ellipsoid.connectivity(), ellipsoid.edgeLengths(), points);
  // One dilatation from a dot product, the other from lengths: near K = 1 each has the square root
  // of the rounding.
  EXPECT_NEAR(report.mean_dilatation, twin.mean_dilatation, 1e-7);
  EXPECT_NEAR(report.dilatation_95, twin.dilatation_95, 1e-7);
  EXPECT_NEAR(report.max_dilatation, twin.max_dilatation, 1e-7);
  EXPECT_NEAR(report.area_distortion, twin.area_distortion, 1e-10);
  EXPECT_GT(report.max_dilatation, 1.1);  // An ellipsoid is no sphere.
}

TEST(MapReport, IsFreeOfScaleAndOneForSimilarities) {
  const MappedSurface map = surfaces::roundSphere(5, 2);
  std::vector<Eigen::Vector3d> images;
  for (const Eigen::Vector3d& p : map.points) images.push_back(7 * (surfaces::rotation(1) * p));
  const MapReport report = measureSpaceMap(map.surface(), map.points, images);
  EXPECT_NEAR(report.max_dilatation, 1, 1e-6);
  EXPECT_NEAR(report.area_distortion, 0, 1e-7);
}

TEST(MapReport, StretchHasItsRatio) {
  const TriangleMesh disk = surfaces::mesh(surfaces::sample("disk", {{"resolution", 3}}));
  std::vector<Eigen::Vector3d> images = disk.positions();
  for (Eigen::Vector3d& p : images) p.x() *= 3;
  const MapReport report = measureSpaceMap(disk.connectivity(), disk.positions(), images);
  EXPECT_NEAR(report.mean_dilatation, 3, 1e-13);
  EXPECT_NEAR(report.max_dilatation, 3, 1e-13);
}

TEST(CycleError, IsZeroForTheIdentityAndTheDistanceForAShift) {
  const MappedSurface map = surfaces::roundSphere(5, 2);
  std::vector<SurfacePoint> same, other;
  for (Index v = 0; v < map.mesh.vertexCount(); ++v) {
    same.push_back(vertexPoint(map.surface(), v));
    other.push_back(vertexPoint(map.surface(), 0));
  }
  EXPECT_EQ(cycleError(map.surface(), map.points, same, map.surface(), same), 0);
  // All to one point: on a sphere the mean distance from a point is 4 / 3.
  EXPECT_NEAR(cycleError(map.surface(), map.points, other, map.surface(), other), 4.0 / 3, 0.02);
}

}  // namespace
}  // namespace moduli
