#include "core/signature/curvature_fields.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "tests/core/signature/modes.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using surfaces::mesh;
using surfaces::sample;

std::vector<SmoothedCurvatures> curvaturesOf(const TriangleMesh& surface, double radius) {
  Context context;
  auto result = smoothedCurvatures(context, surface, surfaces::properLengths(surface), radius);
  EXPECT_OK(result);
  return *std::move(result);
}

TEST(SmoothedCurvatures, OfASphereAreThoseOfASmallerSphere) {
  // An implicit step takes the positions, eigenfunctions of 8 pi (area 1), to 1 / (1 + 8 pi t) of
  // the radius. The tensor is k (1 - n n^T), whose parts of degree 0 and 2 the second step takes to
  // 1 and 1 / (1 + 24 pi t): across the normal k (1 - (1 - 1 / (1 + 24 pi t)) / 3) is left. The
  // polyhedron adds O(h^2).
  const TriangleMesh sphere = mesh(sample("sphere", {{"radius", 3}, {"resolution", 24}}));
  const auto result = curvaturesOf(sphere, 3);
  ASSERT_EQ(result.size(), kSmoothingTimes.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double t = kSmoothingTimes[i];
    const double grown = 1 + 8 * std::numbers::pi * t;
    const double lost = (1 - 1 / (1 + 24 * std::numbers::pi * t)) / 3;
    for (std::size_t v = 0; v < result[i].first.size(); ++v) {
      ASSERT_NEAR(result[i].first[v], grown * (1 - lost), 0.01);
      ASSERT_NEAR(result[i].second[v], grown * (1 - lost), 0.01);
    }
    EXPECT_NEAR(std::accumulate(result[i].areas.begin(), result[i].areas.end(), 0.0), 1, 1e-12);
  }
}

TEST(SmoothedCurvatures, OfACylinderAreOneAndNothing) {
  const TriangleMesh cylinder =
      mesh(sample("capped-cylinder", {{"half_length", 4}, {"resolution", 24}}));
  const auto result = curvaturesOf(cylinder, 1);
  int seen = 0;
  for (Index v = 0; v < cylinder.vertexCount(); ++v) {
    if (std::abs(cylinder.positions()[v].z()) > 1) continue;
    ++seen;
    // A circle of length 2 pi in an area of 20 pi: mu = 20 pi, and the radius shrinks by 1 + 20 pi
    // t. Edges along the axis bend, so that the tensor is the same all around and keeps its size.
    EXPECT_NEAR(result[0].first[v], 1 + kSmoothingTimes[0] * 20 * std::numbers::pi, 0.005);
    EXPECT_NEAR(result[0].second[v], 0, 0.02);
  }
  EXPECT_GT(seen, 100);
}

TEST(ShapeIndexHistogram, PutsKnownPointsInTheirBins) {
  const double e = std::exp(1.0) - 1;  // Curvedness with log(1 + e) = 1: ring 2.
  SmoothedCurvatures points;
  points.areas = {0.1, 0.2, 0.3, 0.4};
  points.first = {e, e * std::numbers::sqrt2, 0, 1e9};
  points.second = {e, 0, 0, -1e9};
  const std::vector<double> bins = shapeIndexHistogram(points);
  ASSERT_EQ(bins.size(), std::size_t{kShapeIndexBins});
  EXPECT_NEAR(bins[1 + 5 + 4], 0.1, 1e-12);                           // cap
  EXPECT_NEAR(bins[1 + 5 + 3], 0.2, 1e-12);                           // ridge
  EXPECT_NEAR(bins[0], 0.3, 1e-12);                                   // flat
  EXPECT_NEAR(bins[1 + 5 * (kCurvednessRings - 1) + 2], 0.4, 1e-12);  // saddle, as sharp as counts
  EXPECT_NEAR(std::accumulate(bins.begin(), bins.end(), 0.0), 1, 1e-12);
}

TEST(ShapeIndexHistogram, OfANoisySurfaceIsNearlyTheSame) {
  // Gaussian errors of 0.5 % of the diagonal at 5762 vertices make faces steep (by half a radian);
  // what is left is less than a tenth of what lies between a sphere and a torus.
  TriangleSoup soup = sample("ellipsoid", {{"b", 0.8}, {"c", 0.5}, {"resolution", 24}});
  const auto histogramOf = [](const TriangleSoup& of) {
    return shapeIndexHistogram(curvaturesOf(mesh(of), 0.75)[1]);
  };
  const std::vector<double> before = histogramOf(soup);
  const std::vector<double> torus = histogramOf(sample("torus", {{"R", 0.6}, {"r", 0.3}}));
  std::mt19937 random(3);
  std::normal_distribution<double> error(0, 0.005 * std::hypot(2, 1.6, 1) / std::sqrt(3.0));
  for (Eigen::Vector3d& p : soup.vertices)
    p += Eigen::Vector3d(error(random), error(random), error(random));
  const std::vector<double> after = histogramOf(soup);
  double change = 0, between = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    change += std::abs(after[i] - before[i]);
    between += std::abs(torus[i] - before[i]);
  }
  EXPECT_LT(change, 0.1 * between);
  EXPECT_GT(change, 0);
}

TEST(ShapeIndexHistogram, DoesNotDependOnOrderPlaceOrScale) {
  const TriangleSoup soup = sample("ellipsoid", {{"c", 0.4}, {"resolution", 12}, {"seed", 2}});
  const auto one = curvaturesOf(mesh(soup), 1);
  const auto two = curvaturesOf(mesh(surfaces::moved(surfaces::renumbered(soup, 1), 1e4)), 1e4);
  for (int time = 0; time < 2; ++time) {
    const auto a = shapeIndexHistogram(one[time]), b = shapeIndexHistogram(two[time]);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-10);
  }
}

}  // namespace
}  // namespace moduli
