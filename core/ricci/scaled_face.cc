#include "core/ricci/scaled_face.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace moduli {
namespace {

/// Sides this much shorter than others lose digits that extended precision has.
constexpr double kNeedle = 1.0 / 1024;

template <typename Real>
Real sine(Geometry geometry, Real x) {
  switch (geometry) {
    case Geometry::kEuclidean:
      return x;
    case Geometry::kHyperbolic:
      return std::sinh(x);
    default:
      return std::sin(x);
  }
}

/// Half of a length.
template <typename Real>
Real halfLength(Geometry geometry, Real half_chord) {
  switch (geometry) {
    case Geometry::kEuclidean:
      return half_chord;
    case Geometry::kHyperbolic:
      return std::asinh(half_chord);
    default:
      return std::asin(half_chord);
  }
}

template <typename Real>
ScaledFace faceOf(Geometry geometry, const std::array<Real, 3>& x) {
  std::array<int, 3> order = {0, 1, 2};  // descending
  if (x[order[0]] < x[order[1]]) std::swap(order[0], order[1]);
  if (x[order[1]] < x[order[2]]) std::swap(order[1], order[2]);
  if (x[order[0]] < x[order[1]]) std::swap(order[0], order[1]);

  const Real longest = halfLength(geometry, x[order[0]]);
  const Real middle = halfLength(geometry, x[order[1]]);
  const Real shortest = halfLength(geometry, x[order[2]]);
  // s - x, with differences of sides of like size first: exact where they matter.
  const Real slack = (middle - longest) + shortest;
  ScaledFace face;
  if (!(slack > 0)) {
    face.proper = false;
    face.half_tangent = {0, 0, 0};
    face.half_tangent[order[0]] = std::numeric_limits<double>::infinity();
    return face;
  }
  const std::array<Real, 3> f = {sine(geometry, slack),
                                 sine(geometry, (longest - middle) + shortest),
                                 sine(geometry, (middle - shortest) + longest)};
  const Real whole = sine(geometry, longest + middle + shortest);
  // Two factors at a time: a product of three could leave the range of a double.
  const Real r = std::sqrt(f[0] * (f[1] / whole)) * std::sqrt(f[2]);
  for (int n = 0; n < 3; ++n) face.half_tangent[order[n]] = static_cast<double>(r / f[n]);
  return face;
}

}  // namespace

ScaledFace scaledFace(Geometry geometry, const TriangleValues& half_chords) {
  return faceOf<double>(geometry, half_chords);
}

bool isNeedle(const TriangleValues& half_chords) {
  const auto [shortest, longest] = std::minmax_element(half_chords.begin(), half_chords.end());
  return *shortest < kNeedle * *longest;
}

ScaledFace scaledNeedle(Geometry geometry, const TriangleValues& half_chords,
                        const std::array<FineFactor, 3>& factors) {
  std::array<long double, 3> scale, x;
  for (int c = 0; c < 3; ++c) {
    scale[c] = std::exp(static_cast<long double>(factors[c].base) / 2) *
               std::exp(static_cast<long double>(factors[c].change) / 2);
  }
  for (int c = 0; c < 3; ++c) x[c] = half_chords[c] * scale[c] * scale[(c + 1) % 3];
  return faceOf<long double>(geometry, x);
}

}  // namespace moduli
