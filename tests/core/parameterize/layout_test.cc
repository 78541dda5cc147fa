#include "core/parameterize/layout.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <set>
#include <vector>

#include "core/intrinsic/angles.h"
#include "core/parameterize/seams.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/parameterize/layout_checks.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

FlatCharts chartsOf(const MetricSurface& metric) {
  std::vector<double> lengths;
  for (Index h = 0; h < metric.surface.halfedgeCount(); ++h) {
    lengths.push_back(metric.lengths[metric.surface.edge(h)]);
  }
  return chartsOfTriangles(lengths, cornerAngles(metric.surface, metric.lengths));
}

/// The vertices of a flat surface with angles other than 2 pi inside, or pi on the boundary.
std::vector<bool> conesOf(const MetricSurface& metric) {
  std::vector<bool> cones;
  for (const double curvature : vertexCurvatures(metric.surface, metric.lengths)) {
    cones.push_back(std::abs(curvature) > 1e-6);
  }
  return cones;
}

/// Disks, annuli, tori, spheres and surfaces of genus 2, flat but for some cones.
std::vector<MetricSurface> flatSurfaces() {
  return {plate(3, 2, {}),
          plate(4, 3, {{1, 1}}),
          plate(5, 3, {{1, 1}, {3, 1}}),
          flatTorus({0.3, 1.2}, 6, 5, 0.2, 1),
          disphenoidCover(3, 4, 4.5),
          insertVertices(doubled(plate(2, 1, {})), 10, 0.1, 2),
          insertVertices(octahedronCover(), 30, 0.05, 3),
          gluedPolygon(10),
          squareTiledL()};
}

/// Through its cones.
std::vector<bool> seamsOf(const MetricSurface& metric, const std::vector<bool>& cones) {
  return chooseSeams(metric.surface, metric.lengths, cones, {});
}
std::vector<bool> seamsOf(const MetricSurface& metric) {
  return seamsOf(metric, conesOf(metric));
}

/// Roundings pile up along the faces of the tree, at most all of them; corners of thin faces turn
/// more than that.
double rounding(const MetricSurface& metric) {
  const std::vector<double> angles = cornerAngles(metric.surface, metric.lengths);
  return 10 * kEpsilon * metric.surface.faceCount() /
         *std::min_element(angles.begin(), angles.end());
}

TEST(LayOut, PlacesEveryFaceAsItsChartUpToATurn) {
  for (const MetricSurface& metric : flatSurfaces()) {
    const FlatCharts charts = chartsOf(metric);
    const PlanarLayout layout = layOut(metric.surface, charts, seamsOf(metric));
    const PlanarFaces faces{metric.surface, layout.points, layout.corner};
    ASSERT_TRUE(faces.namesAllCorners());
    const double longest = *std::max_element(metric.lengths.begin(), metric.lengths.end());
    const double tolerance = rounding(metric);
    ASSERT_LT(tolerance, 1e-9);
    for (Index f = 0; f < metric.surface.faceCount(); ++f) {
      const Complex turn = faces.along(3 * f) / charts[3 * f];
      EXPECT_NEAR(std::abs(turn), 1, tolerance * longest / std::abs(charts[3 * f]));
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        EXPECT_LE(std::abs(faces.along(h) - turn * charts[h]), 4 * tolerance * longest);
      }
      EXPECT_GT(faces.doubledArea(f), 0);
    }
    EXPECT_LE(layout.closure, tolerance * longest /
                                  *std::min_element(metric.lengths.begin(), metric.lengths.end()));
  }
}

TEST(LayOut, CutsToADisk) {
  for (const MetricSurface& metric : flatSurfaces()) {
    const PlanarLayout layout = layOut(metric.surface, chartsOf(metric), seamsOf(metric));
    const PlanarFaces faces{metric.surface, layout.points, layout.corner};
    EXPECT_EQ(faces.eulerCharacteristic(), 1);
  }
}

TEST(LayOut, EndsSeamsAtConesAndOnTheBoundary) {
  for (const MetricSurface& metric : flatSurfaces()) {
    const std::vector<bool> cones = conesOf(metric);
    const PlanarLayout layout = layOut(metric.surface, chartsOf(metric), seamsOf(metric, cones));
    const PlanarFaces faces{metric.surface, layout.points, layout.corner};
    std::vector<int> ends(metric.surface.vertexCount(), 0);
    bool any = false;
    for (Index e = 0; e < metric.surface.edgeCount(); ++e) {
      const Index h = metric.surface.halfedge(e);
      if (!faces.isSeam(h)) continue;
      any = true;
      ++ends[metric.surface.tail(h)];
      ++ends[metric.surface.head(h)];
    }
    for (Index v = 0; v < metric.surface.vertexCount(); ++v) {
      if (metric.surface.isBoundaryVertex(v)) continue;
      EXPECT_TRUE(cones[v] || ends[v] != 1);
      // Around a cone the plane does not close; a seam has to reach it.
      EXPECT_TRUE(!cones[v] || ends[v] > 0);
    }
    // A disk without cones inside needs none.
    EXPECT_TRUE(metric.surface.eulerCharacteristic() != 1 || !any);
  }
}

TEST(LayOut, OfADiskIsTheDisk) {
  const MetricSurface metric = insertVertices(plate(4, 3, {}), 20, 0.1, 1);
  const PlanarLayout layout = layOut(metric.surface, chartsOf(metric), seamsOf(metric));
  EXPECT_EQ(layout.points.size(), static_cast<std::size_t>(metric.surface.vertexCount()));
  // The corners of the plate: a rectangle of 4 by 3.
  double largest = 0;
  for (const Complex& p : layout.points) {
    for (const Complex& q : layout.points) largest = std::max(largest, std::abs(p - q));
  }
  EXPECT_NEAR(largest, 5, 1e-12);
}

TEST(LayOut, OfATorusHasItsLatticeBetweenSides) {
  // Both sides of a seam are translates of one another, by vectors of Z + tau Z up to a turn: any
  // two span a whole number of areas of the torus.
  const Complex tau(0.3, 1.2);
  const MetricSurface metric = flatTorus(tau, 6, 5, 0.2, 1);
  const PlanarLayout layout = layOut(metric.surface, chartsOf(metric), seamsOf(metric, {}));
  const PlanarFaces faces{metric.surface, layout.points, layout.corner};
  std::vector<Complex> translations;
  for (Index h = 0; h < metric.surface.halfedgeCount(); ++h) {
    if (!faces.isSeam(h)) continue;
    const Index twin = metric.surface.twin(h);
    EXPECT_LE(std::abs(faces.along(h) + faces.along(twin)), 1e-12);
    translations.push_back(faces.at(Connectivity::next(twin)) - faces.at(h));
    EXPECT_GT(std::abs(translations.back()), 0.9);
  }
  std::set<int> multiples;
  for (const Complex& a : translations) {
    for (const Complex& b : translations) {
      const double areas = std::imag(std::conj(a) * b) / tau.imag();
      EXPECT_NEAR(areas, std::round(areas), 1e-11);
      multiples.insert(static_cast<int>(std::round(std::abs(areas))));
    }
  }
  EXPECT_TRUE(multiples.contains(1));
}

TEST(LayOut, SaysHowFarFacesMissOneAnother) {
  // Four faces around an inner vertex that is no cone by name, but has the angle 2 pi - 0.1.
  MetricSurface pyramid = fromPositions({{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 0}},
                                        {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  // The sides at the apex stay 1; the bases of an angle pi / 2 - 0.1 / 4.
  for (Index h = 0; h < 12; h += 3) {
    pyramid.lengths[pyramid.surface.edge(h)] = 2 * std::sin((kPi / 2 - 0.025) / 2);
  }
  const FlatCharts charts = chartsOf(pyramid);
  const PlanarLayout whole = layOut(pyramid.surface, charts, seamsOf(pyramid, {}));
  // One arm of length 1 opens by the angle 0.1.
  EXPECT_NEAR(whole.closure, 2 * std::sin(0.05), 1e-13);
  const PlanarLayout cut =
      layOut(pyramid.surface, charts, seamsOf(pyramid, {false, false, false, false, true}));
  EXPECT_LT(cut.closure, 1e-13);
  EXPECT_EQ(cut.points.size(), 6U);
}

}  // namespace
}  // namespace moduli
