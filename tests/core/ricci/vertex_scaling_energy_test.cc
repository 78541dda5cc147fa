#include "core/ricci/vertex_scaling_energy.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

TriangleValues someNumbers(std::mt19937& random, double low, double high) {
  TriangleValues result{};
  for (double& value : result) value = uniform(random, low, high);
  return result;
}

TriangleValues scaledSides(Geometry geometry, const TriangleValues& half_chords,
                           const TriangleValues& u) {
  TriangleValues sides{};
  for (int c = 0; c < 3; ++c) {
    sides[c] = lengthOfHalfChord(geometry,
                                 half_chords[c] * std::exp((u[(c + 1) % 3] + u[(c + 2) % 3]) / 2));
  }
  return sides;
}

/// By a difference formula whose error is h^4 times a fifth derivative.
double derivative(Geometry geometry, const TriangleValues& half_chords, const TriangleValues& u,
                  int corner) {
  const double h = 1e-3;
  const auto at = [&](double step) {
    TriangleValues moved = u;
    moved[corner] += step;
    return vertexScalingEnergy(geometry, half_chords, moved);
  };
  return (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
}

TEST(VertexScalingEnergy, HasTheAnglesAsGradient) {
  // CHECKS F3. For triangles that are not near breaking (s - l at least a tenth of the perimeter),
  // where fifth derivatives are below 1e4; rounding of the energy is 1e-15 / h.
  std::mt19937 random(1);
  for (const Geometry geometry : {Geometry::kEuclidean, Geometry::kHyperbolic}) {
    int tried = 0;
    while (tried < 200) {
      const TriangleValues half_chords = someNumbers(random, 0.2, 2.0);
      const TriangleValues u = someNumbers(random, -0.5, 0.5);
      const TriangleValues sides = scaledSides(geometry, half_chords, u);
      const double perimeter = sides[0] + sides[1] + sides[2];
      if (*std::max_element(sides.begin(), sides.end()) > 0.4 * perimeter) continue;
      const TriangleValues angles = triangleAngles(geometry, sides);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(derivative(geometry, half_chords, u, c), kPi - angles[c], 1e-8);
      }
      ++tried;
    }
  }
}

TEST(VertexScalingEnergy, GoesOnLinearlyWhereTheTriangleBreaks) {
  for (const Geometry geometry : {Geometry::kEuclidean, Geometry::kHyperbolic}) {
    const TriangleValues half_chords{0.5, 0.5, 3.0};
    const TriangleValues u{0.1, -0.2, 0.3};
    EXPECT_NEAR(derivative(geometry, half_chords, u, 0), kPi, 1e-11);
    EXPECT_NEAR(derivative(geometry, half_chords, u, 1), kPi, 1e-11);
    EXPECT_NEAR(derivative(geometry, half_chords, u, 2), 0, 1e-11);
  }
}

TEST(VertexScalingEnergy, IsContinuousWithItsGradientWhereTheTriangleBreaks) {
  // The angles run like the square root of the distance from breaking, the energy like its power
  // 3/2: a step of 1e-9 to either side changes the energy by its gradient, up to 1e-13.
  for (const Geometry geometry : {Geometry::kEuclidean, Geometry::kHyperbolic}) {
    const double longest = 0.4 + 0.7;
    const TriangleValues half_chords{halfChord(geometry, 0.4), halfChord(geometry, 0.7),
                                     halfChord(geometry, longest)};
    const double h = 1e-9;
    const double there = vertexScalingEnergy(geometry, half_chords, {0, 0, 0});
    for (const double step : {-h, h}) {
      const double moved = vertexScalingEnergy(geometry, half_chords, {step, step, 0});
      EXPECT_NEAR(moved - there, 2 * kPi * step, 1e-13);
      EXPECT_NEAR(vertexScalingEnergy(geometry, half_chords, {0, 0, step}), there, 1e-13);
    }
  }
}

TEST(VertexScalingEnergy, IsConvexAlongLinesThroughBrokenTriangles) {
  // Midpoints of chords; the energies are below some 100, with 1e-14 of rounding each.
  std::mt19937 random(2);
  for (const Geometry geometry : {Geometry::kEuclidean, Geometry::kHyperbolic}) {
    int broken = 0;
    int strict = 0;
    for (int trial = 0; trial < 500; ++trial) {
      const TriangleValues half_chords = someNumbers(random, 0.3, 1.5);
      const TriangleValues from = someNumbers(random, -4, 4);
      const TriangleValues to = someNumbers(random, -4, 4);
      const auto along = [&](double t) {
        TriangleValues u{};
        for (int c = 0; c < 3; ++c) u[c] = from[c] + t * (to[c] - from[c]);
        if (isBrokenTriangle(scaledSides(geometry, half_chords, u))) ++broken;
        return vertexScalingEnergy(geometry, half_chords, u);
      };
      const double h = 0.02;
      for (int k = 0; k < 48; ++k) {
        const double t = h * k;
        const double bend = along(t) - 2 * along(t + h) + along(t + 2 * h);
        EXPECT_GE(bend, -1e-13);
        if (bend > 1e-10) ++strict;
      }
    }
    EXPECT_GT(broken, 10000);
    EXPECT_GT(strict, 5000);
  }
}

TEST(VertexScalingEnergy, StaysFiniteForHugeFactors) {
  // Under uniform scaling the slopes, pi less an angle each, add up to 2 pi.
  const TriangleValues half_chords{1, 1, 1};
  const double there = vertexScalingEnergy(Geometry::kEuclidean, half_chords, {0, 0, 0});
  for (const double u : {-2000.0, 2000.0}) {
    EXPECT_NEAR(vertexScalingEnergy(Geometry::kEuclidean, half_chords, {u, u, u}),
                there + 2 * kPi * u, 1e-11);
  }
  // A huge hyperbolic triangle is ideal: slope pi at each corner.
  const double huge = vertexScalingEnergy(Geometry::kHyperbolic, half_chords, {2000, 2000, 2000});
  const double large = vertexScalingEnergy(Geometry::kHyperbolic, half_chords, {200, 200, 200});
  EXPECT_NEAR(huge - large, 3 * kPi * 1800, 1e-10);
}

TEST(VertexScalingEnergy, IsNoneOnTheSphere) {
  EXPECT_TRUE(std::isnan(vertexScalingEnergy(Geometry::kSpherical, {0.1, 0.1, 0.1}, {0, 0, 0})));
}

}  // namespace
}  // namespace moduli
