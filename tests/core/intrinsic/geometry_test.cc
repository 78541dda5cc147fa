#include "core/intrinsic/geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr std::array<Geometry, 3> kGeometries{Geometry::kEuclidean, Geometry::kHyperbolic,
                                              Geometry::kSpherical};

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

/// A point of the plane, the hyperboloid (first coordinate in time) or the sphere, in polar
/// coordinates, in long double.
using Point = std::array<long double, 3>;

Point polar(Geometry geometry, long double radius, long double angle) {
  switch (geometry) {
    case Geometry::kEuclidean:
      return {1, radius * std::cos(angle), radius * std::sin(angle)};
    case Geometry::kHyperbolic:
      return {std::cosh(radius), std::sinh(radius) * std::cos(angle),
              std::sinh(radius) * std::sin(angle)};
    case Geometry::kSpherical:
      return {std::cos(radius), std::sin(radius) * std::cos(angle),
              std::sin(radius) * std::sin(angle)};
  }
  return {};
}

/// Through the chord in the model's space, which does not cancel as the cosine would.
double distance(Geometry geometry, const Point& p, const Point& q) {
  const long double time = (p[0] - q[0]) * (p[0] - q[0]);
  const long double space = (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]);
  switch (geometry) {
    case Geometry::kEuclidean:
      return static_cast<double>(std::sqrt(space));
    case Geometry::kHyperbolic:
      return static_cast<double>(2 * std::asinh(std::sqrt(space - time) / 2));
    case Geometry::kSpherical:
      return static_cast<double>(2 * std::asin(std::sqrt(space + time) / 2));
  }
  return 0;
}

double cosineLaw(Geometry geometry, double x, double y, double z) {
  switch (geometry) {
    case Geometry::kEuclidean:
      return (y * y + z * z - x * x) / (2 * y * z);
    case Geometry::kHyperbolic:
      return (std::cosh(y) * std::cosh(z) - std::cosh(x)) / (std::sinh(y) * std::sinh(z));
    case Geometry::kSpherical:
      return (std::cos(x) - std::cos(y) * std::cos(z)) / (std::sin(y) * std::sin(z));
  }
  return 0;
}

/// Sides of a triangle that is not too thin, below 1.5 each.
TriangleValues fatTriangle(std::mt19937& random) {
  while (true) {
    TriangleValues sides{};
    for (double& side : sides) side = uniform(random, 0.3, 1.5);
    const double perimeter = sides[0] + sides[1] + sides[2];
    if (2 * *std::max_element(sides.begin(), sides.end()) < 0.95 * perimeter) return sides;
  }
}

TEST(TriangleAngles, ObeyTheCosineLaw) {
  // Numerator and divisor of the law are of order 1 with some units of rounding; the divisor is at
  // least 2 * 0.3^2.
  std::mt19937 random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const TriangleValues sides = fatTriangle(random);
    for (const Geometry geometry : kGeometries) {
      const TriangleValues angles = triangleAngles(geometry, sides);
      for (int c = 0; c < 3; ++c) {
        const double cosine = cosineLaw(geometry, sides[c], sides[(c + 1) % 3], sides[(c + 2) % 3]);
        EXPECT_NEAR(std::cos(angles[c]), cosine, 200 * kEpsilon);
      }
    }
  }
}

TEST(TriangleAngles, KeepTheirRelativePrecisionInNeedles) {
  // The sides are computed in long double and rounded; nearly isosceles needles whose sides differ
  // by less than the base. Rounding a side by half a unit moves s - x, of the size of the base, by
  // that much: the condition number is 1 / base.
  std::mt19937 random(2);
  for (const double base : {1e-2, 1e-4, 1e-6}) {
    for (const Geometry geometry : kGeometries) {
      const long double tip = base * uniform(random, 0.5, 1.0);
      const long double left = 0.75;
      const long double right = 0.75L + static_cast<long double>(base) / 8;
      const Point a = polar(geometry, left, 0);
      const Point b = polar(geometry, right, tip);
      const TriangleValues angles = triangleAngles(
          geometry,
          {distance(geometry, a, b), static_cast<double>(right), static_cast<double>(left)});
      EXPECT_NEAR(angles[0] / static_cast<double>(tip), 1, 4 * kEpsilon / base);
    }
  }
}

TEST(TriangleAngles, AreExactFunctionsOfNeedleSides) {
  // For sides that are doubles the formula itself must lose nothing: compared with the same formula
  // in long double.
  const TriangleValues sides{1, 1 - 0x1p-31, 0x1p-30};
  using Long = long double;
  const Long s = (Long{sides[0]} + sides[1] + sides[2]) / 2;
  for (const Geometry geometry : kGeometries) {
    const auto f = [geometry](Long t) {
      return geometry == Geometry::kEuclidean    ? t
             : geometry == Geometry::kHyperbolic ? std::sinh(t)
                                                 : std::sin(t);
    };
    const TriangleValues angles = triangleAngles(geometry, sides);
    for (int c = 0; c < 3; ++c) {
      const Long product = f(s - sides[(c + 1) % 3]) * f(s - sides[(c + 2) % 3]);
      const Long angle = 2 * std::atan2(std::sqrt(product), std::sqrt(f(s) * f(s - sides[c])));
      EXPECT_NEAR(angles[c] / static_cast<double>(angle), 1, 10 * kEpsilon);
    }
  }
}

TEST(TriangleAngles, OfTinyTrianglesAreEuclidean) {
  // Curvature changes angles by the area, some 1e-16.
  const TriangleValues sides{3e-8, 4e-8, 5e-8};
  for (const Geometry geometry : kGeometries) {
    const TriangleValues angles = triangleAngles(geometry, sides);
    EXPECT_NEAR(angles[0], std::atan2(3, 4), 4 * kEpsilon);
    EXPECT_NEAR(angles[1], std::atan2(4, 3), 4 * kEpsilon);
    EXPECT_NEAR(angles[2], std::numbers::pi / 2, 4 * kEpsilon);
    EXPECT_NEAR(triangleArea(geometry, sides) / 6e-16, 1, 10 * kEpsilon);
  }
}

TEST(TriangleAngles, OfLargeHyperbolicTrianglesNeitherOverflowNorVanish) {
  // Equilateral: sin(a / 2) = 1 / (2 cosh(l / 2)), which is e^{-l / 2} for long sides. An error of
  // half a unit in l / 2 is one of 300 units in the angle.
  for (const double side : {50.0, 600.0, 1200.0}) {
    const double angle = triangleAngles(Geometry::kHyperbolic, {side, side, side})[0];
    EXPECT_NEAR(angle / (2 * std::exp(-side / 2)), 1, side * kEpsilon);
  }
}

TEST(TriangleAngles, ArePiAndZeroWhereTheTriangleInequalityFails) {
  for (const Geometry geometry : kGeometries) {
    for (const TriangleValues& sides :
         {TriangleValues{0.5, 1.25, 0.25}, {0.5, 0.75, 0.25}, {0.75, 0.75, 0.0}}) {
      EXPECT_TRUE(isBrokenTriangle(sides));
      const TriangleValues angles = triangleAngles(geometry, sides);
      const auto longest = std::max_element(sides.begin(), sides.end()) - sides.begin();
      for (int c = 0; c < 3; ++c) EXPECT_EQ(angles[c], c == longest ? std::numbers::pi : 0);
      EXPECT_EQ(triangleArea(geometry, sides), 0);
      for (const TriangleValues& row : angleDerivatives(geometry, sides, angles)) {
        for (const double entry : row) EXPECT_EQ(entry, 0);
      }
    }
    // The extension is continuous: one unit less, and the angle is pi up to the square root of it.
    const double near = triangleAngles(geometry, {0.75 * (1 - kEpsilon), 0.5, 0.25})[0];
    EXPECT_NEAR(near, std::numbers::pi, 10 * std::sqrt(kEpsilon));
    EXPECT_LT(near, std::numbers::pi);
  }
}

TEST(TriangleAngles, OfASphericalTriangleAroundAGreatCircleArePi) {
  const double third = 2.1;  // More than 2 pi / 3.
  for (const double angle : triangleAngles(Geometry::kSpherical, {third, third, third})) {
    EXPECT_EQ(angle, std::numbers::pi);
  }
  const double octant = std::numbers::pi / 2;
  EXPECT_NEAR(triangleAngles(Geometry::kSpherical, {octant, octant, octant})[0], octant, 1e-15);
}

TEST(AngleDerivatives, AreThoseOfTheAngles) {
  // Central differences: h^2 times third derivatives of some 100, and rounding 1e-16 / h.
  const double h = 1e-5;
  std::mt19937 random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const TriangleValues sides = fatTriangle(random);
    for (const Geometry geometry : kGeometries) {
      const TriangleMatrix exact =
          angleDerivatives(geometry, sides, triangleAngles(geometry, sides));
      for (int j = 0; j < 3; ++j) {
        TriangleValues longer = sides;
        TriangleValues shorter = sides;
        longer[j] += h;
        shorter[j] -= h;
        const TriangleValues up = triangleAngles(geometry, longer);
        const TriangleValues down = triangleAngles(geometry, shorter);
        for (int i = 0; i < 3; ++i) {
          const double difference = (up[i] - down[i]) / (longer[j] - shorter[j]);
          EXPECT_NEAR(exact[i][j], difference, 1e-7);
        }
      }
    }
  }
}

TEST(TriangleArea, IsTheExcessOfTheAngleSum) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 100; ++trial) {
    const TriangleValues sides = fatTriangle(random);
    for (const Geometry geometry : kGeometries) {
      const TriangleValues angles = triangleAngles(geometry, sides);
      const double excess = angles[0] + angles[1] + angles[2] - std::numbers::pi;
      EXPECT_NEAR(planeCurvature(geometry) * triangleArea(geometry, sides), excess, 10 * kEpsilon);
    }
    const double cosine = cosineLaw(Geometry::kEuclidean, sides[0], sides[1], sides[2]);
    const double area = sides[1] * sides[2] * std::sqrt(1 - cosine * cosine) / 2;
    EXPECT_NEAR(triangleArea(Geometry::kEuclidean, sides), area, 100 * kEpsilon);
  }
}

TEST(HalfChord, IsUndoneByItsInverse) {
  for (const Geometry geometry : kGeometries) {
    for (const double length : {1e-12, 0.1, 1.0, 2.0}) {
      const double back = lengthOfHalfChord(geometry, halfChord(geometry, length));
      EXPECT_NEAR(back / length, 1, 4 * kEpsilon);
    }
  }
  EXPECT_EQ(halfChord(Geometry::kEuclidean, 3), 1.5);
  EXPECT_EQ(halfChord(Geometry::kHyperbolic, 2), std::sinh(1.0));
  EXPECT_EQ(halfChord(Geometry::kSpherical, 2), std::sin(1.0));
}

TEST(IsometricDiagonal, OfFourPointsInTheModelsIsTheirDistance) {
  // The four sides and the diagonal carry half a unit of rounding each; the quadrilateral's angles
  // are moderate, so the other diagonal moves by some units. Concave quadrilaterals are among them.
  std::mt19937 random(5);
  for (int trial = 0; trial < 300; ++trial) {
    for (const double size : {1.0, 1e-3, 1e-7}) {
      for (const Geometry geometry : kGeometries) {
        std::array<Point, 4> p;
        for (int k = 0; k < 4; ++k) {
          p[k] = polar(geometry, size * uniform(random, 0.2, 0.6),
                       (k + uniform(random, -0.25, 0.25)) * std::numbers::pi_v<long double> / 2);
        }
        const auto between = [&](int i, int j) { return distance(geometry, p[i], p[j]); };
        const double other = isometricDiagonal(geometry, between(0, 2), between(0, 1),
                                               between(1, 2), between(2, 3), between(3, 0));
        EXPECT_NEAR(other / between(1, 3), 1, 50 * kEpsilon);
      }
    }
  }
}

TEST(IsometricDiagonal, OfACircleQuadrilateralObeysPtolemyInHalfChords) {
  // CHECKS F4. On a circle of radius R the half chord over the angle t is F(R) sin(t / 2), F the
  // identity, sinh or sin.
  std::mt19937 random(6);
  for (const Geometry geometry : kGeometries) {
    const double radius = halfChord(geometry, 1.4);  // F(R) with R = 0.7.
    for (int trial = 0; trial < 100; ++trial) {
      std::array<double, 4> turn{};
      for (int k = 0; k < 4; ++k) turn[k] = (k + uniform(random, -0.4, 0.4)) * std::numbers::pi / 2;
      const auto chord = [&](int i, int j) {
        return radius * std::abs(std::sin((turn[j] - turn[i]) / 2));
      };
      const auto length = [&](int i, int j) { return lengthOfHalfChord(geometry, chord(i, j)); };
      const double flipped =
          halfChord(geometry, isometricDiagonal(geometry, length(0, 2), length(0, 1), length(1, 2),
                                                length(2, 3), length(3, 0)));
      EXPECT_NEAR(chord(0, 2) * flipped, chord(0, 1) * chord(2, 3) + chord(1, 2) * chord(3, 0),
                  4e-15);
    }
  }
}

TEST(IsometricDiagonal, TakenTwiceIsTheFirst) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 100; ++trial) {
    const double a = uniform(random, 0.8, 1.0);
    const double b = uniform(random, 0.8, 1.0);
    const double c = uniform(random, 0.8, 1.0);
    const double d = uniform(random, 0.8, 1.0);
    const double e = uniform(random, 0.9, 1.1);
    for (const Geometry geometry : kGeometries) {
      const double other = isometricDiagonal(geometry, e, a, b, c, d);
      EXPECT_NEAR(isometricDiagonal(geometry, other, b, c, d, a), e, 20 * kEpsilon);
    }
  }
}

}  // namespace
}  // namespace moduli
