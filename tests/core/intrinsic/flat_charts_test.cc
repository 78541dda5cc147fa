#include "core/intrinsic/flat_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <random>
#include <vector>

#include "core/intrinsic/delaunay.h"
#include "core/intrinsic/geometry.h"
#include "core/intrinsic/undo_flips.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// The angle at the tail of each side.
TriangleValues anglesAtTails(const TriangleValues& sides) {
  const TriangleValues opposite = triangleAngles(Geometry::kEuclidean, sides);
  return {opposite[1], opposite[2], opposite[0]};
}

FlatCharts chartOf(const TriangleValues& sides) {
  const TriangleValues angles = anglesAtTails(sides);
  return chartsOfTriangles({sides.begin(), sides.end()}, {angles.begin(), angles.end()});
}

/// Charts of a triangulation whose half chords are half its lengths.
FlatCharts chartsOf(const IntrinsicTriangulation& t) {
  std::vector<double> lengths = t.halfChords(), angles(lengths.size());
  for (double& x : lengths) x *= 2;
  for (Index f = 0; f < t.faceCount(); ++f) {
    const TriangleValues own =
        anglesAtTails({lengths[3 * f], lengths[3 * f + 1], lengths[3 * f + 2]});
    std::copy(own.begin(), own.end(), angles.begin() + 3 * f);
  }
  return chartsOfTriangles(lengths, angles);
}

/// Charts carried back through the flips of a triangulation.
FlatCharts undone(const IntrinsicTriangulation& t, const FlatCharts& charts) {
  SignedTriangles triangles;
  for (std::size_t h = 0; h < charts.size(); ++h) {
    const std::size_t before = h % 3 == 0 ? h + 2 : h - 1;
    triangles.lengths.push_back(std::abs(charts[h]));
    triangles.angles.push_back(std::arg(-charts[before] / charts[h]));
  }
  triangles = undoFlips(Geometry::kEuclidean, t, triangles);
  return chartsOfTriangles(triangles.lengths, triangles.angles);
}

IntrinsicTriangulation triangulate(const MetricSurface& metric) {
  std::vector<double> half_chords = metric.lengths;
  for (double& x : half_chords) x /= 2;
  return {metric.surface, half_chords};
}

TEST(ChartsOfTriangles, HaveTheLengthsAndAnglesOfTheTriangle) {
  // All angles above a tenth: they and the third side carry some ten units, and the sine of the
  // smallest divides those.
  std::mt19937 random(1);
  int tried = 0;
  while (tried < 300) {
    const TriangleValues sides{uniform(random), uniform(random), uniform(random)};
    const TriangleValues angles = anglesAtTails(sides);
    if (*std::min_element(angles.begin(), angles.end()) < 0.1) continue;
    ++tried;
    const FlatCharts chart = chartOf(sides);
    const double longest = *std::max_element(sides.begin(), sides.end());
    EXPECT_LE(std::abs(chart[0] + chart[1] + chart[2]), 2 * kEpsilon * longest);
    EXPECT_GT(doubledArea(chart, 0), 0);
    EXPECT_NEAR(doubledArea(chart, 0) / (2 * triangleArea(Geometry::kEuclidean, sides)), 1,
                200 * kEpsilon);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(std::abs(chart[c]) / sides[c], 1, 100 * kEpsilon);
      // Counter-clockwise from a side to the one before it, reversed.
      EXPECT_NEAR(std::arg(-chart[(c + 2) % 3] / chart[c]), angles[c], 100 * kEpsilon);
    }
  }
}

TEST(ChartsOfTriangles, KeepTheDigitsOfTheShortSideOfANeedle) {
  // It is written down as given; at the wide end of a polar angle, up to its sine and cosine.
  for (const double base : {1e-3, 1e-8, 1e-13, 1e-100}) {
    for (int turn = 0; turn < 3; ++turn) {
      for (const double longer : {1.0, 1 + base / 2}) {
        if (longer != 1 && longer - 1 >= base) continue;
        TriangleValues sides{};
        sides[turn] = base;
        sides[(turn + 1) % 3] = 1;
        sides[(turn + 2) % 3] = longer;
        const FlatCharts chart = chartOf(sides);
        EXPECT_NEAR(std::abs(chart[turn]) / base, 1, 4 * kEpsilon);
        EXPECT_NEAR(std::abs(chart[(turn + 1) % 3]), 1, 4 * kEpsilon);
        EXPECT_NEAR(std::abs(chart[(turn + 2) % 3]), longer, 4 * kEpsilon);
      }
    }
  }
}

/// Bad triangulations of flat surfaces with cones.
std::vector<MetricSurface> someSurfaces() {
  const MetricSurface torus = flatTorus({0.3, 1.2}, 6, 5, 0.2, 1);
  return {flipEdges(torus, 400, 2),
          insertNearEdges(torus, 1e-2, 3),
          insertNearCorners(torus, 1e-2, 4),
          flipEdges(insertVertices(gluedPolygon(8), 40, 0.05, 5), 300, 6),
          flipEdges(subdivide(octahedronCover(), 3), 300, 7),
          flipEdges(insertVertices(plate(4, 3, {{1, 1}}), 40, 0.05, 9), 200, 10)};
}

double smallestAngle(const FlatCharts& charts) {
  double smallest = 4;
  for (std::size_t h = 0; h < charts.size(); ++h) {
    const std::size_t before = h % 3 == 0 ? h + 2 : h - 1;
    smallest = std::min(smallest, std::abs(std::arg(-charts[before] / charts[h])));
  }
  return smallest;
}

TEST(UndoFlips, GivesBackTheTrianglesBeforeIsometricFlips) {
  // The metric is the same: so are the straight edges between its vertices. Lengths have gone
  // through at most the number of flips there, and charts back, a few roundings each; the smallest
  // angle divides them.
  for (const MetricSurface& metric : someSurfaces()) {
    const IntrinsicTriangulation start = triangulate(metric);
    const FlatCharts before = chartsOf(start);
    IntrinsicTriangulation t = start;
    Context context;
    const auto flips = flipToDelaunayIsometric(context, t);
    ASSERT_OK(flips);
    ASSERT_GT(*flips, 20U);
    const double longest = *std::max_element(metric.lengths.begin(), metric.lengths.end());
    const double tolerance =
        10 * kEpsilon * static_cast<double>(*flips) * longest / smallestAngle(before);
    ASSERT_LT(tolerance, 1e-9);
    const FlatCharts after = undone(t, chartsOf(t));
    for (Index h = 0; h < start.halfedgeCount(); ++h) {
      EXPECT_NEAR(std::abs(after[h]), 2 * start.halfChord(h), tolerance);
    }
    for (Index f = 0; f < start.faceCount(); ++f) {
      EXPECT_GT(doubledArea(after, f), 0);
      EXPECT_NEAR(doubledArea(after, f), doubledArea(before, f), 2 * tolerance * longest);
    }
  }
}

TEST(UndoFlips, LeavesCompatibleChartsWhateverTheFlips) {
  // After Ptolemy flips under random scales: sides of a face add up to 0 and twins agree in length.
  std::mt19937 random(2);
  for (const MetricSurface& metric : someSurfaces()) {
    IntrinsicTriangulation t = triangulate(metric);
    bool closed = true;
    for (Index h = 0; h < t.halfedgeCount(); ++h) closed = closed && t.twin(h) != kNone;
    if (!closed) continue;  // Faces at the boundary may stay broken.
    std::vector<double> scale(t.vertexCount());
    for (double& s : scale) s = std::exp(0.4 * (uniform(random) - 0.5));
    Context context;
    const auto flips = flipToDelaunayPtolemy(context, t, scale);
    ASSERT_OK(flips);
    ASSERT_GT(*flips, 20U);
    std::vector<double> scaled = t.halfChords();
    for (Index h = 0; h < t.halfedgeCount(); ++h) scaled[h] *= scale[t.tail(h)] * scale[t.head(h)];
    IntrinsicTriangulation metric_there = t;
    metric_there.setHalfChords(scaled);
    const FlatCharts there = chartsOf(metric_there);
    const FlatCharts charts = undone(t, there);
    const double longest = *std::max_element(metric.lengths.begin(), metric.lengths.end());
    const double tolerance =
        10 * kEpsilon * static_cast<double>(*flips) * longest / smallestAngle(there);
    ASSERT_LT(tolerance, 1e-9);
    t.undoTo(0);
    for (Index h = 0; h < t.halfedgeCount(); ++h) {
      EXPECT_NEAR(std::abs(charts[h]), std::abs(charts[t.twin(h)]), tolerance);
    }
    for (Index f = 0; f < t.faceCount(); ++f) {
      EXPECT_LE(std::abs(charts[3 * f] + charts[3 * f + 1] + charts[3 * f + 2]), tolerance);
    }
  }
}

TEST(UndoFlips, TurnsOverWhatIsConcave) {
  // The edge from the tip to the notch of an arrowhead, and the edge that it replaces: outside.
  const std::array<Complex, 4> place{Complex(0, 0), {1, 1}, {0, 0.25}, {-1, 1}};
  const std::vector<Eigen::Vector3d> positions{{0, 0, 0}, {1, 1, 0}, {0, 0.25, 0}, {-1, 1, 0}};
  const MetricSurface arrow = fromPositions(positions, {{0, 1, 2}, {2, 3, 0}});
  IntrinsicTriangulation t = triangulate(arrow);
  // Stated the other way round: a history that leads from the edge 1 3 to the edge 0 2.
  const MetricSurface outside{*Connectivity::fromFaces(4, {{1, 3, 0}, {3, 1, 2}}),
                              std::vector<double>(5, 1.0)};
  IntrinsicTriangulation other = triangulate(outside);
  other.flip(0, std::abs(place[2] - place[0]) / 2);
  std::vector<double> half_chords(6);
  for (Index h = 0; h < 6; ++h) {
    half_chords[h] = std::abs(place[other.head(h)] - place[other.tail(h)]) / 2;
  }
  other.setHalfChords(half_chords);
  const FlatCharts charts = undone(other, chartsOf(other));
  // Twice the signed areas of 1 3 0 and of 3 1 2 in the plane.
  const auto doubled = [&](int a, int b, int c) {
    return std::imag(std::conj(place[b] - place[a]) * (place[c] - place[a]));
  };
  EXPECT_NEAR(doubledArea(charts, 0), doubled(1, 3, 0), 10 * kEpsilon);
  EXPECT_NEAR(doubledArea(charts, 1), doubled(3, 1, 2), 10 * kEpsilon);
  EXPECT_LT(doubledArea(charts, 1), 0);
  EXPECT_GT(doubledArea(chartsOf(t), 0), 0);
}

}  // namespace
}  // namespace moduli
