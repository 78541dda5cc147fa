#include "core/intrinsic/geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace moduli {
namespace {

/// Half the perimeter s, and s less each side, in Kahan's order: the longest and the second side
/// are subtracted first, which is exact in a proper triangle.
struct Halves {
  double perimeter = 0;
  TriangleValues less{};
  int longest = 0;
};

Halves halvesOf(const TriangleValues& sides) {
  int a = 0;
  int b = 1;
  int c = 2;
  if (sides[a] < sides[b]) std::swap(a, b);
  if (sides[b] < sides[c]) std::swap(b, c);
  if (sides[a] < sides[b]) std::swap(a, b);
  const double step = sides[a] - sides[b];
  Halves halves;
  halves.longest = a;
  halves.perimeter = (sides[a] + (sides[b] + sides[c])) / 2;
  halves.less[a] = (sides[c] - step) / 2;
  halves.less[b] = (sides[c] + step) / 2;
  halves.less[c] = (sides[a] + (sides[b] - sides[c])) / 2;
  return halves;
}

bool isBroken(const Halves& halves) {
  return halves.less[halves.longest] <= 0;
}

/// F of MATH 6.1: what takes the place of a length in the sine law.
double sineOf(Geometry geometry, double length) {
  switch (geometry) {
    case Geometry::kEuclidean:
      return length;
    case Geometry::kHyperbolic:
      return std::sinh(length);
    case Geometry::kSpherical:
      return std::sin(length);
  }
  return 0;
}

/// tan of half the angle opposite side c, of a proper triangle. Quotients first, so that nothing
/// over- or underflows before the result does.
double halfAngleTangent(Geometry geometry, const Halves& halves, int c) {
  const double x = halves.less[c];
  const double y = halves.less[(c + 1) % 3];
  const double z = halves.less[(c + 2) % 3];
  if (geometry == Geometry::kHyperbolic) {
    // sinh t = e^t (1 - e^{-2t}) / 2, and the exponents add up to -2 x.
    const auto tamed = [](double t) { return -std::expm1(-2 * t); };
    return std::exp(-x) * std::sqrt((tamed(y) / tamed(halves.perimeter)) * (tamed(z) / tamed(x)));
  }
  return std::sqrt((sineOf(geometry, y) / sineOf(geometry, halves.perimeter)) *
                   (sineOf(geometry, z) / sineOf(geometry, x)));
}

}  // namespace

double halfChord(Geometry geometry, double length) {
  return sineOf(geometry, length / 2);
}

double lengthOfHalfChord(Geometry geometry, double half_chord) {
  switch (geometry) {
    case Geometry::kEuclidean:
      return 2 * half_chord;
    case Geometry::kHyperbolic:
      return 2 * std::asinh(half_chord);
    case Geometry::kSpherical:
      return 2 * std::asin(half_chord);
  }
  return 0;
}

TriangleValues triangleAngles(Geometry geometry, const TriangleValues& sides) {
  const Halves halves = halvesOf(sides);
  TriangleValues angles{};
  if (isBroken(halves)) {
    angles[halves.longest] = std::numbers::pi;
    return angles;
  }
  if (geometry == Geometry::kSpherical && halves.perimeter >= std::numbers::pi) {
    angles.fill(std::numbers::pi);
    return angles;
  }
  for (int c = 0; c < 3; ++c) angles[c] = 2 * std::atan(halfAngleTangent(geometry, halves, c));
  return angles;
}

bool isBrokenTriangle(const TriangleValues& sides) {
  return isBroken(halvesOf(sides));
}

TriangleMatrix angleDerivatives(Geometry geometry, const TriangleValues& sides,
                                const TriangleValues& angles) {
  const Halves halves = halvesOf(sides);
  TriangleMatrix result{};
  if (isBroken(halves)) return result;
  const auto& less = halves.less;
  const double divisor = 2 *
                         std::sqrt(sineOf(geometry, halves.perimeter) * sineOf(geometry, less[0])) *
                         std::sqrt(sineOf(geometry, less[1]) * sineOf(geometry, less[2]));
  for (int i = 0; i < 3; ++i) {
    const double own = sineOf(geometry, sides[i]) / divisor;
    for (int j = 0; j < 3; ++j) {
      result[i][j] = i == j ? own : -std::cos(angles[3 - i - j]) * own;
    }
  }
  return result;
}

double triangleArea(Geometry geometry, const TriangleValues& sides) {
  const Halves halves = halvesOf(sides);
  if (isBroken(halves)) return 0;
  const auto& less = halves.less;
  if (geometry == Geometry::kEuclidean) {
    return std::sqrt(halves.perimeter * less[0]) * std::sqrt(less[1] * less[2]);
  }
  const auto tangent = [geometry](double t) {
    return geometry == Geometry::kHyperbolic ? std::tanh(t / 2) : std::tan(t / 2);
  };
  return 4 * std::atan(std::sqrt(tangent(halves.perimeter) * tangent(less[0])) *
                       std::sqrt(tangent(less[1]) * tangent(less[2])));
}

double isometricDiagonal(Geometry geometry, double diagonal, double a, double b, double c,
                         double d) {
  const TriangleValues left = triangleAngles(geometry, {diagonal, a, b});
  const TriangleValues right = triangleAngles(geometry, {diagonal, c, d});
  // The end of the diagonal with the smaller angle: its sine keeps its relative precision.
  double half_angle = (left[2] + right[1]) / 2;
  const double other = (left[1] + right[2]) / 2;
  if (other < half_angle) {
    half_angle = other;
    a = b;
    d = c;
  }
  const double across = std::sqrt(sineOf(geometry, a)) * std::sqrt(sineOf(geometry, d));
  const double chord = std::hypot(halfChord(geometry, a - d), across * std::sin(half_angle));
  return lengthOfHalfChord(geometry,
                           geometry == Geometry::kSpherical ? std::min(1.0, chord) : chord);
}

}  // namespace moduli
