#include "core/ricci/scaled_face.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

/// How much longer the two short sides are together than the longest, over that.
double slackOf(const TriangleValues& lengths) {
  const double longest = *std::max_element(lengths.begin(), lengths.end());
  return (lengths[0] + lengths[1] + lengths[2] - 2 * longest) / longest;
}

TriangleValues lengthsOf(Geometry geometry, const TriangleValues& half_chords) {
  TriangleValues lengths{};
  for (int c = 0; c < 3; ++c) lengths[c] = lengthOfHalfChord(geometry, half_chords[c]);
  return lengths;
}

/// Half chords of triangles fat and thin; spherical ones fit into an octant.
TriangleValues someTriangle(Geometry geometry, double size, double thinness, std::mt19937& random) {
  while (true) {
    TriangleValues x{};
    for (double& value : x) value = size * uniform(random, 0.1, 0.6);
    if (thinness < 1) {
      x[0] = thinness * size * uniform(random, 0.5, 1);
      x[2] = x[1] + x[0] * uniform(random, -0.8, 0.8);
    }
    // Half chords of proper triangles need not obey the triangle inequality, but lengths do.
    if (slackOf(lengthsOf(geometry, x)) > 0.1 * thinness) return x;
  }
}

TEST(ScaledFace, HasTheAnglesOfItsLengths) {
  // Lengths carry two units of rounding, and what the triangle inequality leaves of them as many
  // more as it is shorter.
  std::mt19937 random(1);
  for (const Geometry geometry : kGeometries) {
    for (const double size : {1.0, 1e-5, 1e-100}) {
      for (const double thinness : {1.0, 1e-3, 1e-6}) {
        for (int trial = 0; trial < 50; ++trial) {
          const TriangleValues x = someTriangle(geometry, size, thinness, random);
          const TriangleValues lengths = lengthsOf(geometry, x);
          const TriangleValues angles = triangleAngles(geometry, lengths);
          const ScaledFace face = scaledFace(geometry, x);
          EXPECT_TRUE(face.proper);
          for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(face.half_tangent[c] / std::tan(angles[c] / 2), 1,
                        20 * kEpsilon / slackOf(lengths));
          }
        }
      }
    }
  }
}

/// By the cosine law in half chords X, Y, Z, with k = -1, 0, 1 the curvature:
/// cos a = (Y^2 + Z^2 - X^2 - 2 k Y^2 Z^2) / (2 Y Z sqrt((1 - k Y^2)(1 - k Z^2))).
long double halfTangent(Geometry geometry, long double x, long double y, long double z) {
  const auto k = static_cast<long double>(planeCurvature(geometry));
  const long double divisor = 2 * y * z * std::sqrt((1 - k * y * y) * (1 - k * z * z));
  const long double numerator = (y - x) * (y + x) + z * z - 2 * k * y * y * z * z;
  return std::sqrt((divisor - numerator) / (divisor + numerator));
}

TEST(ScaledFace, ObeysTheCosineLaw) {
  // As above; the law in long double loses the square of what is small: 1e-19 over thinness^2.
  std::mt19937 random(2);
  for (const Geometry geometry : kGeometries) {
    for (const double size : {1.0, 1e-4, 1e-8}) {
      for (const double thinness : {1.0, 1e-2, 1e-4}) {
        for (int trial = 0; trial < 50; ++trial) {
          const TriangleValues x = someTriangle(geometry, size, thinness, random);
          const ScaledFace face = scaledFace(geometry, x);
          const double slack = slackOf(lengthsOf(geometry, x));
          for (int c = 0; c < 3; ++c) {
            const long double exact = halfTangent(geometry, x[c], x[(c + 1) % 3], x[(c + 2) % 3]);
            EXPECT_NEAR(static_cast<double>(face.half_tangent[c] / exact), 1,
                        20 * kEpsilon / slack + 1e-17 / (slack * slack));
          }
        }
      }
    }
  }
}

TEST(ScaledFace, TakesTheSidesOfCapsAndNeedlesAsExact) {
  // A side shorter than the other two together by d, all of them exact: differences that are exact
  // in turn leave some units of rounding, whatever d is.
  for (int bits = 4; bits <= 50; bits += 2) {
    const double d = std::ldexp(1.0, -bits);
    // Sides 1, 1 and 2 - d: halves of the perimeter less them, 1 - d / 2 twice and d / 2.
    const ScaledFace face = scaledFace(Geometry::kEuclidean, {1, 2 - d, 1});
    const double wide = std::sqrt((1 - d / 2) * (1 - d / 2) / ((2 - d / 2) * (d / 2)));
    const double narrow = std::sqrt((d / 2) / (2 - d / 2));
    EXPECT_NEAR(face.half_tangent[1] / wide, 1, 8 * kEpsilon);
    EXPECT_NEAR(face.half_tangent[0] / narrow, 1, 8 * kEpsilon);
    EXPECT_NEAR(face.half_tangent[2] / narrow, 1, 8 * kEpsilon);
    // A needle whose short side has digits below those of the long ones.
    const double base = 1.3 * d;
    const ScaledFace needle = scaledFace(Geometry::kEuclidean, {1, 1 + d / 4, base});
    const double less = (base - d / 4) / 2, more = (base + d / 4) / 2;
    EXPECT_NEAR(needle.half_tangent[2] / std::sqrt(more * less / ((1 + more) * (1 - less))), 1,
                8 * kEpsilon);
    EXPECT_NEAR(needle.half_tangent[0] / std::sqrt(less * (1 - less) / ((1 + more) * more)), 1,
                8 * kEpsilon);
  }
}

TEST(ScaledFace, OfLargeHyperbolicTrianglesFollowsTheIdealOnes) {
  // Equilateral: sin(a / 2) = 1 / (2 cosh(l / 2)).
  for (const double x : {1e2, 1e8, 1e15}) {
    const ScaledFace face = scaledFace(Geometry::kHyperbolic, {x, x, x});
    const double sine = 0.5 / std::sqrt(1 + x * x);
    for (const double t : face.half_tangent) {
      // A length of up to 70 with its rounding, in the exponent.
      EXPECT_NEAR(t / (sine / std::sqrt(1 - sine * sine)), 1, 200 * kEpsilon);
    }
  }
}

TEST(ScaledFace, OpensTheAngleOfASideThatIsTooLong) {
  for (const Geometry geometry : kGeometries) {
    for (int c = 0; c < 3; ++c) {
      for (const double longest : {0.5, 0.7}) {
        TriangleValues x{halfChord(geometry, 0.3), halfChord(geometry, 0.2), 0};
        x[2] = halfChord(geometry, longest + 1e-15);
        std::rotate(x.begin(), x.begin() + c, x.end());
        const ScaledFace face = scaledFace(geometry, x);
        EXPECT_FALSE(face.proper);
        EXPECT_EQ(face.half_tangent[(5 - c) % 3], std::numeric_limits<double>::infinity());
        EXPECT_EQ(face.half_tangent[(3 - c) % 3], 0);
        EXPECT_EQ(face.half_tangent[(4 - c) % 3], 0);
      }
    }
  }
}

/// Half chords times e^{(u_i + u_j) / 2}; side c is opposite corner c.
TriangleValues scaled(const TriangleValues& half_chords, const Eigen::Vector3d& u) {
  TriangleValues result{};
  for (int c = 0; c < 3; ++c) {
    result[c] = half_chords[c] * std::exp((u[(c + 1) % 3] + u[(c + 2) % 3]) / 2);
  }
  return result;
}

TEST(EdgeWeight, AssemblesToTheDerivativeOfTheAngles) {
  // CHECKS F1. Differences have an error of h^4 / 30 times a fifth derivative, below 1e4 for
  // triangles that are not thin, and the rounding of an angle over h.
  std::mt19937 random(3);
  for (const Geometry geometry : kGeometries) {
    for (int trial = 0; trial < 200; ++trial) {
      TriangleValues x{};
      do {
        x = someTriangle(geometry, 1, 1, random);
      } while (slackOf(lengthsOf(geometry, x)) < 0.3);
      const ScaledFace face = scaledFace(geometry, x);
      const TriangleValues& t = face.half_tangent;
      Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
      for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const EdgeWeight weight = edgeWeight(geometry, t[i], t[j], t[k], x[k]);
        hessian(i, i) += weight.diagonal;
        hessian(j, j) += weight.diagonal;
        hessian(i, j) += weight.mixed;
        hessian(j, i) += weight.mixed;
      }
      const auto angles = [&](const Eigen::Vector3d& u) {
        const TriangleValues a = triangleAngles(geometry, lengthsOf(geometry, scaled(x, u)));
        return Eigen::Vector3d(a[0], a[1], a[2]);
      };
      const double h = 1e-3;
      for (int j = 0; j < 3; ++j) {
        const auto at = [&](double step) { return angles(step * Eigen::Vector3d::Unit(j)); };
        const Eigen::Vector3d numeric =
            (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
        EXPECT_LT((hessian.col(j) + numeric).cwiseAbs().maxCoeff(), 1e-8);
      }
    }
  }
}

TEST(EdgeWeight, OfSmallTrianglesIsHalfACotangent) {
  // q of MATH 6.4 is the square of half the length.
  std::mt19937 random(4);
  for (int trial = 0; trial < 100; ++trial) {
    const TriangleValues x = someTriangle(Geometry::kEuclidean, 1e-6, 1, random);
    for (const Geometry geometry : kGeometries) {
      const ScaledFace face = scaledFace(geometry, x);
      const TriangleValues& t = face.half_tangent;
      const double cotangent = 1 / std::tan(2 * std::atan(t[0]));
      const EdgeWeight weight = edgeWeight(geometry, t[1], t[2], t[0], x[0]);
      // The angle sum differs from pi by the area, 1e-12, and rounding counts with cot^2.
      const double tolerance = (1e-11 + 100 * kEpsilon) * (1 + cotangent * cotangent);
      EXPECT_NEAR(weight.diagonal, cotangent / 2, tolerance);
      EXPECT_NEAR(weight.mixed, -cotangent / 2, tolerance);
    }
  }
}

}  // namespace
}  // namespace moduli
