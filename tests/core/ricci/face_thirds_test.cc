#include "core/ricci/face_thirds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "core/ricci/scaled_face.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr std::array<Geometry, 3> kGeometries{Geometry::kEuclidean, Geometry::kHyperbolic,
                                              Geometry::kSpherical};

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

TriangleValues someNumbers(std::mt19937& random, double low, double high) {
  TriangleValues result{};
  for (double& value : result) value = uniform(random, low, high);
  return result;
}

/// No side is longer than 0.4 of all three: no angle is small.
bool isFat(const TriangleValues& sides) {
  const double perimeter = sides[0] + sides[1] + sides[2];
  return *std::max_element(sides.begin(), sides.end()) < 0.4 * perimeter;
}

double largestEntry(const TriangleTensor& tensor) {
  double result = 0;
  for (const TriangleMatrix& matrix : tensor) {
    for (const TriangleValues& row : matrix) {
      for (const double value : row) result = std::max(result, std::abs(value));
    }
  }
  return result;
}

double largestDifference(TriangleTensor a, const TriangleTensor& b) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int m = 0; m < 3; ++m) a[i][j][m] -= b[i][j][m];
    }
  }
  return largestEntry(a);
}

/// The tensor with its first index moved to the end, or with the last two exchanged: these two make
/// all orders.
TriangleTensor rotated(const TriangleTensor& tensor) {
  TriangleTensor result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int m = 0; m < 3; ++m) result[j][m][i] = tensor[i][j][m];
    }
  }
  return result;
}

TriangleTensor exchanged(const TriangleTensor& tensor) {
  TriangleTensor result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int m = 0; m < 3; ++m) result[i][m][j] = tensor[i][j][m];
    }
  }
  return result;
}

double asymmetry(const TriangleTensor& tensor) {
  return std::max(largestDifference(rotated(tensor), tensor),
                  largestDifference(exchanged(tensor), tensor));
}

/// The second derivatives of angles(u) by differences of fourth order, whose error is h^4 / 30
/// times derivatives of sixth order, and rounding 1e-15 / h^2.
template <typename Angles>
TriangleTensor differences(const Angles& angles, const TriangleValues& u) {
  const double h = 4e-3;
  constexpr std::array<double, 4> kWeight{1, -8, 8, -1};
  constexpr std::array<int, 4> kStep{-2, -1, 1, 2};
  TriangleTensor result{};
  for (int j = 0; j < 3; ++j) {
    for (int m = 0; m < 3; ++m) {
      for (int p = 0; p < 4; ++p) {
        for (int q = 0; q < 4; ++q) {
          TriangleValues moved = u;
          moved[j] += kStep[p] * h;
          moved[m] += kStep[q] * h;
          const TriangleValues angle = angles(moved);
          for (int i = 0; i < 3; ++i) {
            result[i][j][m] += kWeight[p] * kWeight[q] * angle[i] / (144 * h * h);
          }
        }
      }
    }
  }
  return result;
}

struct Sample {
  TriangleValues u;
  TriangleTensor exact, numeric;
};

/// Triangles under vertex scaling; spherical ones fit into an octant.
Sample scaledSample(Geometry geometry, std::mt19937& random) {
  while (true) {
    const double size = geometry == Geometry::kSpherical ? 0.4 : 1;
    TriangleValues half_chords = someNumbers(random, 0.2, 1.2);
    for (double& value : half_chords) value *= size;
    const TriangleValues u = someNumbers(random, -0.5, 0.5);
    const auto scaled = [&](const TriangleValues& at) {
      TriangleValues x{};
      for (int c = 0; c < 3; ++c) {
        x[c] = half_chords[c] * std::exp((at[(c + 1) % 3] + at[(c + 2) % 3]) / 2);
      }
      return x;
    };
    TriangleValues sides{};
    for (int c = 0; c < 3; ++c) sides[c] = lengthOfHalfChord(geometry, scaled(u)[c]);
    if (!isFat(sides)) continue;
    const auto angles = [&](const TriangleValues& at) {
      TriangleValues result = scaledFace(geometry, scaled(at)).half_tangent;
      for (double& value : result) value = 2 * std::atan(value);
      return result;
    };
    const ScaledFace face = scaledFace(geometry, scaled(u));
    return {u, scaledFaceThirds(geometry, face.half_tangent, scaled(u)), differences(angles, u)};
  }
}

struct CircleSample : Sample {
  CircleFace face;
};

CircleFace circleFace(Geometry geometry, const TriangleValues& u, const TriangleValues& distance) {
  CircleFace face;
  face.distance = distance;
  TriangleValues radius{};
  for (int c = 0; c < 3; ++c) {
    const double flat = std::exp(u[c]);
    radius[c] = geometry == Geometry::kEuclidean    ? flat
                : geometry == Geometry::kHyperbolic ? 2 * std::atanh(flat)
                                                    : 2 * std::atan(flat);
    face.sine[c] = halfChord(geometry, 2 * radius[c]);
    face.cosine[c] = geometry == Geometry::kEuclidean    ? 1
                     : geometry == Geometry::kHyperbolic ? std::cosh(radius[c])
                                                         : std::cos(radius[c]);
  }
  for (int c = 0; c < 3; ++c) {
    const int i = (c + 1) % 3, j = (c + 2) % 3;
    const double chord = std::hypot(halfChord(geometry, radius[i] - radius[j]),
                                    std::sqrt((distance[c] + 1) / 2 * face.sine[i] * face.sine[j]));
    face.side[c] = lengthOfHalfChord(geometry, chord);
  }
  face.angle = triangleAngles(geometry, face.side);
  return face;
}

/// distance: the range of I.
CircleSample circleSample(Geometry geometry, double low, double high, std::mt19937& random) {
  while (true) {
    // Spherical circles of at most half a radian: three of them are far from filling the sphere.
    const double largest = geometry == Geometry::kSpherical ? -1.4 : -0.8;
    const TriangleValues u = someNumbers(random, largest - 1.2, largest);
    const TriangleValues distance = someNumbers(random, low, high);
    CircleSample sample;
    sample.face = circleFace(geometry, u, distance);
    if (!isFat(sample.face.side)) continue;
    sample.u = u;
    sample.exact = circleFaceThirds(geometry, sample.face);
    sample.numeric = differences(
        [&](const TriangleValues& at) { return circleFace(geometry, at, distance).angle; }, u);
    return sample;
  }
}

// In fat triangles no derivative of sixth order is above 1e3 times the tensor: the difference
// formula is good to 1e-8, and 16 rounded angles over 9 h^2 leave some 1e-10.
TEST(FaceThirds, OfVertexScalingAreSecondDerivativesOfTheAngles) {
  std::mt19937 random(1);
  for (const Geometry geometry : kGeometries) {
    for (int trial = 0; trial < 200; ++trial) {
      const Sample sample = scaledSample(geometry, random);
      EXPECT_LT(largestDifference(sample.exact, sample.numeric),
                1e-8 * (1 + largestEntry(sample.exact)));
    }
  }
}

TEST(FaceThirds, OfVertexScalingAreTotallySymmetric) {
  std::mt19937 random(2);
  for (const Geometry geometry : kGeometries) {
    for (int trial = 0; trial < 1000; ++trial) {
      const TriangleTensor tensor = scaledSample(geometry, random).exact;
      EXPECT_LT(asymmetry(tensor), 16 * kEpsilon * (1 + largestEntry(tensor)));
    }
  }
}

TEST(FaceThirds, OfCirclePackingsAreSecondDerivativesOfTheAngles) {
  std::mt19937 random(3);
  for (const Geometry geometry : kGeometries) {
    for (const auto& [low, high] : {std::pair{0.0, 1.0}, {1.0, 1.0}, {1.0, 2.0}}) {
      for (int trial = 0; trial < 100; ++trial) {
        const CircleSample sample = circleSample(geometry, low, high, random);
        EXPECT_LT(largestDifference(sample.exact, sample.numeric),
                  1e-8 * (1 + largestEntry(sample.exact)));
      }
    }
  }
}

TEST(FaceThirds, OfCirclePackingsAreTotallySymmetric) {
  // Terms of opposite signs, up to some ten times the sums.
  std::mt19937 random(4);
  for (const Geometry geometry : kGeometries) {
    for (const auto& [low, high] : {std::pair{0.0, 1.0}, {1.0, 1.0}, {1.0, 2.0}}) {
      for (int trial = 0; trial < 500; ++trial) {
        const TriangleTensor tensor = circleSample(geometry, low, high, random).exact;
        EXPECT_LT(asymmetry(tensor), 100 * kEpsilon * (1 + largestEntry(tensor)));
      }
    }
  }
}

TEST(FaceThirds, OfEuclideanFacesDoNotFeelTheScale) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 200; ++trial) {
    for (const TriangleTensor& tensor : {scaledSample(Geometry::kEuclidean, random).exact,
                                         circleSample(Geometry::kEuclidean, 0, 1, random).exact}) {
      for (const TriangleMatrix& matrix : tensor) {
        for (const TriangleValues& row : matrix) {
          EXPECT_NEAR(row[0] + row[1] + row[2], 0, 100 * kEpsilon * (1 + largestEntry(tensor)));
        }
      }
    }
  }
}

// Angles of a Euclidean triangle add up to pi.
TEST(FaceThirds, OfEuclideanAnglesCancel) {
  std::mt19937 random(6);
  const TriangleTensor tensor = scaledSample(Geometry::kEuclidean, random).exact;
  for (int j = 0; j < 3; ++j) {
    for (int m = 0; m < 3; ++m) {
      EXPECT_NEAR(tensor[0][j][m] + tensor[1][j][m] + tensor[2][j][m], 0, 1e-14);
    }
  }
}

// d cot a / 2 = -csc^2 a da / 2: in an equilateral triangle angles change by 1 / (2 sqrt 3) with
// the unknown of another corner and -1 / sqrt 3 with their own, and csc^2 is 4/3.
TEST(FaceThirds, OfTheEquilateralTriangleAreKnown) {
  const double t = 1 / std::sqrt(3.0);
  const TriangleTensor tensor = scaledFaceThirds(Geometry::kEuclidean, {t, t, t}, {0.5, 0.5, 0.5});
  EXPECT_NEAR(tensor[0][1][2], 2.0 / 3 * t, 1e-15);
  EXPECT_NEAR(tensor[0][1][0], -t / 3, 1e-15);
  EXPECT_NEAR(tensor[0][0][0], 2 * t / 3, 1e-15);
}

TEST(FaceThirds, OfSmallCurvedFacesAreThoseOfFlatOnes) {
  const TriangleValues x{0.3e-5, 0.4e-5, 0.45e-5};
  const TriangleValues t = scaledFace(Geometry::kEuclidean, x).half_tangent;
  const TriangleTensor flat = scaledFaceThirds(Geometry::kEuclidean, t, x);
  for (const Geometry geometry : {Geometry::kHyperbolic, Geometry::kSpherical}) {
    const TriangleValues curved = scaledFace(geometry, x).half_tangent;
    // The excess is of the order of the area, 1e-11.
    EXPECT_LT(largestDifference(scaledFaceThirds(geometry, curved, x), flat), 1e-10);
  }
}

TEST(FaceThirds, OfBrokenFacesVanish) {
  CircleFace face = circleFace(Geometry::kEuclidean, {-1, -1, -1}, {1, 1, 1});
  face.side[0] = face.side[1] + face.side[2];
  EXPECT_EQ(largestEntry(circleFaceThirds(Geometry::kEuclidean, face)), 0);
}

}  // namespace
}  // namespace moduli
