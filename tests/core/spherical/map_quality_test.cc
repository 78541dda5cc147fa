#include "core/spherical/map_quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "core/spherical/exact_sign.h"
#include "tests/core/mesh/shapes.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using Plane = std::vector<std::complex<double>>;

/// Grid of 6 x 6 points at 0..5, each of its 25 squares cut in two.
TriangleMesh flatGrid() {
  return surfaces::mesh(shapes::plate(5, 5, [](Index, Index) { return true; }));
}

template <typename Map>
Plane image(const TriangleMesh& mesh, const Map& map) {
  Plane points;
  for (const Eigen::Vector3d& p : mesh.positions()) points.push_back(map(p.x(), p.y()));
  return points;
}

MapQuality measured(const TriangleMesh& mesh, const Plane& points) {
  return measurePlaneMap(mesh.connectivity(), mesh.edgeLengths(), points);
}

TEST(MeasurePlaneMap, OfASimilarityIsPerfect) {
  const TriangleMesh mesh = flatGrid();
  const MapQuality quality =
      measured(mesh, image(mesh, [](double x, double y) {
                 return std::complex<double>(0.3, -2) * std::complex<double>(x, y) + 5.0;
               }));
  EXPECT_EQ(quality.flipped_faces, 0);
  // Rounding of unit triangles whose images lie up to 15 from 0: some 10 eps each.
  EXPECT_NEAR(quality.max_dilatation, 1, 1e-13);
  EXPECT_NEAR(quality.mean_dilatation, 1, 1e-13);
  EXPECT_NEAR(quality.dilatation_95, 1, 1e-13);
  EXPECT_NEAR(quality.area_distortion, 0, 1e-13);
  EXPECT_EQ(quality.dilatation_histogram, (std::vector<double>{1, 0, 0, 0, 0, 0, 0}));
}

TEST(MeasurePlaneMap, OfAStretchedHalfHasSharesByHand) {
  // Of five columns of squares the last is stretched to three times its width (K = 3, area times
  // 3), the one before it to 1.2.
  const TriangleMesh mesh = flatGrid();
  const MapQuality quality = measured(mesh, image(mesh, [](double x, double y) {
                                        const double widths[] = {0, 1, 2, 3, 4.2, 7.2};
                                        return std::complex<double>(widths[static_cast<int>(x)], y);
                                      }));
  EXPECT_NEAR(quality.max_dilatation, 3, 1e-13);
  EXPECT_NEAR(quality.mean_dilatation, (3 * 1 + 1.2 + 3) / 5, 1e-13);
  EXPECT_NEAR(quality.dilatation_95, 3, 1e-13);
  const std::vector<double> shares = {0.6, 0, 0.2, 0, 0, 0.2, 0};
  for (std::size_t i = 0; i < shares.size(); ++i) {
    EXPECT_NEAR(quality.dilatation_histogram[i], shares[i], 1e-14) << i;
  }
  const double mean = (std::log(1.2) + std::log(3.0)) / 5;
  const double square = (std::pow(std::log(1.2), 2) + std::pow(std::log(3.0), 2)) / 5;
  EXPECT_NEAR(quality.area_distortion, std::sqrt(square - mean * mean), 1e-13);
}

TEST(MeasurePlaneMap, LeavesFivePercentAboveThePercentile) {
  // Two faces meet in each of these corners: 2 of 50 (4 %) the percentile does not see, 4 it does.
  const TriangleMesh mesh = flatGrid();
  Plane points = image(mesh, [](double x, double y) { return std::complex<double>(x, y); });
  for (std::complex<double>& z : points) {
    if (z == 0.0) z = {-0.05, -0.02};
  }
  const MapQuality one_corner = measured(mesh, points);
  EXPECT_GT(one_corner.max_dilatation, 1.01);
  EXPECT_NEAR(one_corner.dilatation_95, 1, 1e-13);
  for (std::complex<double>& z : points) {
    if (z == std::complex<double>(5, 5)) z += std::complex<double>(0.3, 0.2);
  }
  EXPECT_GT(measured(mesh, points).dilatation_95, 1.01);
}

TEST(MeasurePlaneMap, CountsFacesThatTurnOverOrVanish) {
  const TriangleMesh mesh = flatGrid();
  const auto mirror = [](double x, double y) { return std::complex<double>(-x, y); };
  const MapQuality mirrored = measured(mesh, image(mesh, mirror));
  EXPECT_EQ(mirrored.flipped_faces, 50);
  EXPECT_NEAR(mirrored.max_dilatation, 1, 1e-13);  // a mirror keeps shapes

  const auto flatten = [](double x, double) { return std::complex<double>(x, 0); };
  const MapQuality flat = measured(mesh, image(mesh, flatten));
  EXPECT_EQ(flat.flipped_faces, 50);
  EXPECT_TRUE(std::isinf(flat.mean_dilatation));
  EXPECT_TRUE(std::isinf(flat.area_distortion));
  EXPECT_EQ(flat.dilatation_histogram.back(), 1);
  EXPECT_EQ(measured(mesh, Plane(36, 1.0)).flipped_faces, 50);
}

TEST(MeasureSphereMap, HistogramSumsToOneAndScaleIsIndifferent) {
  const TriangleSoup soup =
      surfaces::sample("ellipsoid", {{"a", 1}, {"b", 0.8}, {"c", 0.5}, {"resolution", 6}});
  const TriangleMesh mesh = surfaces::mesh(soup);
  Points3 points = mesh.positions();
  for (Eigen::Vector3d& p : points) p.normalize();
  const MapQuality quality = measureSphereMap(mesh.connectivity(), mesh.edgeLengths(), points);
  EXPECT_EQ(quality.flipped_faces, 0);
  EXPECT_NEAR(quality.covering_degree, 1, 1e-13);
  const auto& shares = quality.dilatation_histogram;
  EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1, 1e-13);
  EXPECT_LT(quality.mean_dilatation, quality.dilatation_95);
  EXPECT_LT(quality.dilatation_95, quality.max_dilatation);

  std::vector<double> tiny = mesh.edgeLengths();
  for (double& length : tiny) length = std::ldexp(length, -700);
  const MapQuality scaled = measureSphereMap(mesh.connectivity(), tiny, points);
  EXPECT_EQ(scaled.mean_dilatation, quality.mean_dilatation);
  EXPECT_EQ(scaled.area_distortion, quality.area_distortion);
}

TEST(OrientationSign, IsExactNextToALine) {
  // c is as close to the line through a and b as a double can be: the rounded determinant is 0 or
  // of either sign, the true one is that of the offset.
  const std::complex<double> a(12, 12), b(24, 24);
  const double ulp = std::ldexp(1, -53);
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      const std::complex<double> c(0.5 + i * ulp, 0.5 + j * ulp);
      // On a line y = x the point lies to the left where y > x.
      const int expected = (j > i) - (j < i);
      EXPECT_EQ(spherical::orientationSign(a, b, c), expected) << i << " " << j;
      EXPECT_EQ(spherical::orientationSign(c, a, b), expected) << i << " " << j;
    }
  }
}

TEST(OrientationSign, IsExactNextToAGreatCircleAndAlternates) {
  std::mt19937 random(2);
  std::uniform_int_distribution<int> integer(-(1 << 20), 1 << 20);
  const auto draw = [&] { return Eigen::Vector3d(integer(random), integer(random), 1); };
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d a = draw(), b = draw();
    // Integers below 2^53 add without an error: c lies in the plane of a, b and 0.
    const Eigen::Vector3d c = 123457 * a + 54321 * b;
    EXPECT_EQ(spherical::orientationSign(a, b, c), 0);
    // Moved off it by one unit along z, the determinant is (a x b).z, an integer.
    const Eigen::Vector3d d = c + Eigen::Vector3d::UnitZ();
    const double side = a.x() * b.y() - a.y() * b.x();
    const int expected = (side > 0) - (side < 0);
    EXPECT_EQ(spherical::orientationSign(a, b, d), expected);
    EXPECT_EQ(spherical::orientationSign(b, d, a), expected);
    EXPECT_EQ(spherical::orientationSign(b, a, d), -expected);
  }
}

TEST(OrientationSign, OfWhatIsNoNumberIsZero) {
  const Eigen::Vector3d x(1, 0, 0), y(0, 1, 0);
  EXPECT_EQ(spherical::orientationSign(x, y, Eigen::Vector3d(0, std::nan(""), 1)), 0);
  EXPECT_EQ(spherical::orientationSign(0.0, 1.0, std::complex<double>(INFINITY, 1)), 0);
}

}  // namespace
}  // namespace moduli
