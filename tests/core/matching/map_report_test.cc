#include "core/matching/map_report.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

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

TEST(ShapeChange, IsAtItsFloorForSimilarities) {
  const MappedSurface map = surfaces::roundSphere(5, 2);
  std::vector<Eigen::Vector3d> images, normals;
  for (const Eigen::Vector3d& p : map.points) {
    normals.push_back(surfaces::rotation(1) * p);
    images.push_back(7 * normals.back() + Eigen::Vector3d(1, 2, 3));
  }
  const ShapeChange change = shapeChange(map.surface(), map.points, map.points, images, normals);
  EXPECT_NEAR(change.stretching, 1e-3, 1e-15);
  EXPECT_NEAR(change.bending, 1e-2, 1e-15);
}

// Singular values e^t and e^-t everywhere; nothing is bent.
TEST(ShapeChange, StretchHasItsLogarithm) {
  const TriangleMesh disk = surfaces::mesh(surfaces::sample("disk", {{"resolution", 3}}));
  std::vector<Eigen::Vector3d> images = disk.positions();
  for (Eigen::Vector3d& p : images) p = Eigen::Vector3d(p.x() * 1.2, p.y() / 1.2, 0);
  const std::vector<Eigen::Vector3d> up(images.size(), Eigen::Vector3d::UnitZ());
  const ShapeChange change = shapeChange(disk.connectivity(), disk.positions(), up, images, up);
  EXPECT_NEAR(change.stretching, std::log(1.2), 1e-13);
  EXPECT_NEAR(change.bending, 1e-2, 1e-15);
}

// The chords of a sphere of radius R have the curvature 1 / R exactly, and -1 / R seen from within.
TEST(ShapeChange, BendingIsTheChangeOfCurvatures) {
  const MappedSurface map = surfaces::roundSphere(5, 2);
  std::vector<Eigen::Vector3d> images, inwards;
  for (const Eigen::Vector3d& p : map.points) {
    images.push_back(3 * p);
    inwards.push_back(-p);
  }
  const ShapeChange change = shapeChange(map.surface(), map.points, map.points, images, inwards);
  EXPECT_NEAR(change.stretching, 1e-3, 1e-15);
  const TriangleMesh mesh = *TriangleMesh::fromSoup({map.points, map.surface().faces()});
  EXPECT_NEAR(change.bending, 2 * std::sqrt(mesh.area()), 1e-12);
}

// Its values are eigenvalues: a curvature k along one direction counts k / sqrt(2), one of k and -k
// counts k, whether the edges lie along these directions or between them, and wherever the images
// look. Here normals tell it, of a plane that stays flat.
TEST(ShapeChange, BendingDoesNotDependOnDirections) {
  const TriangleMesh disk = surfaces::mesh(surfaces::sample("disk", {{"resolution", 6}}));
  const std::vector<Eigen::Vector3d> up(disk.vertexCount(), Eigen::Vector3d::UnitZ());
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  constexpr double kCurvature = 0.3;
  const double unit = std::sqrt(disk.area());
  for (const double angle : {0.0, 0.4, 0.8}) {
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle)), across(-along[1], along[0]);
    const auto bending = [&](double first, double second) {
      const Eigen::Matrix2d form =
          first * along * along.transpose() + second * across * across.transpose();
      std::vector<Eigen::Vector3d> images, normals;
      for (const Eigen::Vector3d& p : disk.positions()) {
        Eigen::Vector3d normal(0, 0, 1);
        normal.head<2>() += form * p.head<2>();
        images.emplace_back(turn * p);
        normals.emplace_back(turn * normal);
      }
      return shapeChange(disk.connectivity(), disk.positions(), up, images, normals).bending;
    };
    EXPECT_NEAR(bending(kCurvature, 0), unit * kCurvature / std::sqrt(2.0), 1e-12) << angle;
    EXPECT_NEAR(bending(kCurvature, -kCurvature), unit * kCurvature, 1e-12) << angle;
  }
}

// A stretch turns the sides of faces, but not what they are bent by.
TEST(ShapeChange, StretchingAloneIsNoBending) {
  const TriangleMesh disk = surfaces::mesh(surfaces::sample("disk", {{"resolution", 6}}));
  const Eigen::Vector2d along(std::cos(0.4), std::sin(0.4));
  const Eigen::Matrix2d form = 0.3 * along * along.transpose(),
                        stretch = Eigen::Vector2d(1.2, 1 / 1.2).asDiagonal();
  std::vector<Eigen::Vector3d> images, before, after;
  for (const Eigen::Vector3d& p : disk.positions()) {
    const Eigen::Vector2d image = stretch * p.head<2>();
    const Eigen::Vector2d turned = form * p.head<2>(), image_turned = form * image;
    images.emplace_back(image[0], image[1], 0);
    before.emplace_back(turned[0], turned[1], 1);
    after.emplace_back(image_turned[0], image_turned[1], 1);
  }
  const ShapeChange change =
      shapeChange(disk.connectivity(), disk.positions(), before, images, after);
  EXPECT_NEAR(change.stretching, std::log(1.2), 1e-13);
  EXPECT_NEAR(change.bending, 1e-2, 1e-12);  // Its floor.
}

// A tenth of the surface, however torn, multiplies a geometric mean by little.
TEST(ShapeChange, IsHardlyThatOfAFewFaces) {
  const TriangleMesh disk = surfaces::mesh(surfaces::sample("disk", {{"resolution", 12}}));
  std::vector<Eigen::Vector3d> images = disk.positions(), torn;
  for (Eigen::Vector3d& p : images) p = Eigen::Vector3d(p.x() * 1.02, p.y() / 1.02, 0);
  torn = images;
  torn[disk.connectivity().face(0)[0]] += Eigen::Vector3d(1, 1, 0);
  const std::vector<Eigen::Vector3d> up(images.size(), Eigen::Vector3d::UnitZ());
  const auto stretching = [&](const std::vector<Eigen::Vector3d>& to) {
    return shapeChange(disk.connectivity(), disk.positions(), up, to, up).stretching;
  };
  // The share of its 6 faces times the logarithm of 350, the most by which one is worse.
  const double share = 6.0 / static_cast<double>(disk.connectivity().faceCount());
  EXPECT_LT(std::log(stretching(torn) / stretching(images)), 2 * share * std::log(350));
  EXPECT_GT(isometricDistortion(disk.connectivity(), disk.positions(), torn),
            2 * isometricDistortion(disk.connectivity(), disk.positions(), images));
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
