#include "core/signature/shape_distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using surfaces::mesh;
using surfaces::sample;

constexpr double kPi = std::numbers::pi;

/// A cube of side 2 about (1, 1, 1), two faces a side.
TriangleSoup cube() {
  return {{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}},
          {{0, 2, 1},
           {0, 3, 2},
           {4, 5, 6},
           {4, 6, 7},
           {0, 1, 5},
           {0, 5, 4},
           {1, 2, 6},
           {1, 6, 5},
           {2, 3, 7},
           {2, 7, 6},
           {3, 0, 4},
           {3, 4, 7}}};
}

TEST(SurfacePoints, OfFewFacesAreAsEvenAsOfMany) {
  const SurfacePoints points = surfacePoints(mesh(cube()));
  // Cut in ceil(2 sqrt(2) / (0.06 sqrt(24))) = 10.
  EXPECT_EQ(points.points.cols(), 12 * 100);
  double total = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < points.points.cols(); ++i) {
    total += points.areas[i];
    normal += points.areas[i] * points.normals.col(i);
    EXPECT_NEAR(points.normals.col(i).norm(), 1, 1e-14);
    EXPECT_NEAR(points.points.col(i).lpNorm<Eigen::Infinity>(), 1 / std::sqrt(24.0), 1e-13);
  }
  EXPECT_NEAR(total, 1, 1e-12);
  EXPECT_LT(normal.norm(), 1e-12);
  EXPECT_NEAR(points.unit, std::sqrt(24.0), 1e-13);
  // On a side: 1 + 1/3 + 1/3, in units of the area; centroids miss 1 / 18 of what varies in 10
  // cuts.
  EXPECT_NEAR(points.radius, std::sqrt(5.0 / 3 / 24), 1e-3);
}

TEST(ShapeDistributions, OfASphereAreThoseOfArchimedes) {
  // D1 is the radius; the share of pairs nearer than d is d^2 / 4 r^2, so that the mean of the i-th
  // of n parts is 2 r times the mean of sqrt(p), and r the radius of gyration. 512 cells of
  // diameter 0.2 r smear lengths by some percent of that.
  Context context;
  const auto result =
      shapeDistributions(context, surfacePoints(mesh(sample("sphere", {{"resolution", 20}}))));
  ASSERT_OK(result);
  const double n = kDistributionParts;
  for (int i = 0; i < kDistributionParts; ++i) {
    EXPECT_NEAR(result->d1[i], std::log(1.01), 0.002);
    const double mean = 2 * n * (std::pow((i + 1) / n, 1.5) - std::pow(i / n, 1.5)) * 2 / 3;
    EXPECT_NEAR(std::exp(result->d2[i]) - 0.01, mean, 0.02) << i;
  }
  // Angles of triangles sum to pi.
  double sum = 0;
  for (const double angle : result->a3) sum += angle / n;
  EXPECT_NEAR(sum, kPi / 3, 1e-3);
}

TEST(ShapeDistributions, DoNotDependOnOrderPlaceScaleOrHandedness) {
  Context context;
  for (const TriangleSoup& soup :
       {cube(), sample("torus", {{"R", 2}, {"resolution", 12}}),
        sample("ellipsoid", {{"c", 0.4}, {"resolution", 10}, {"seed", 4}})}) {
    TriangleSoup mirrored = soup;
    for (Eigen::Vector3d& p : mirrored.vertices) p.x() = -p.x();
    const auto one = shapeDistributions(context, surfacePoints(mesh(soup)));
    ASSERT_OK(one);
    for (const TriangleSoup& other :
         {surfaces::moved(surfaces::renumbered(soup, 3), 1e5), mirrored}) {
      const auto two = shapeDistributions(context, surfacePoints(mesh(other)));
      ASSERT_OK(two);
      for (int i = 0; i < kDistributionParts; ++i) {
        EXPECT_NEAR(one->d1[i], two->d1[i], 1e-9);
        EXPECT_NEAR(one->d2[i], two->d2[i], 1e-9);
        EXPECT_NEAR(one->d3[i], two->d3[i], 1e-9);
        EXPECT_NEAR(one->a3[i], two->a3[i], 1e-9);
      }
    }
  }
}

TEST(ShapeDistributions, OfAnotherTriangulationAreNearlyTheSame) {
  Context context;
  const auto coarse = shapeDistributions(
      context, surfacePoints(mesh(sample("ellipsoid", {{"c", 0.4}, {"resolution", 10}}))));
  const auto fine = shapeDistributions(
      context,
      surfacePoints(mesh(sample("ellipsoid", {{"c", 0.4}, {"resolution", 24}, {"seed", 5}}))));
  ASSERT_OK(coarse);
  ASSERT_OK(fine);
  for (int i = 1; i < kDistributionParts; ++i) {
    EXPECT_NEAR(coarse->d2[i], fine->d2[i], 0.03) << i;
    EXPECT_NEAR(coarse->a3[i], fine->a3[i], 0.03) << i;
  }
}

}  // namespace
}  // namespace moduli
