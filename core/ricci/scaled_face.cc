#include "core/ricci/scaled_face.h"

#include <array>
#include <limits>
#include <utility>

namespace moduli {
namespace {

double sine(Geometry geometry, double x) {
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
double halfLength(Geometry geometry, double half_chord) {
  switch (geometry) {
    case Geometry::kEuclidean:
      return half_chord;
    case Geometry::kHyperbolic:
      return std::asinh(half_chord);
    default:
      return std::asin(half_chord);
  }
}

}  // namespace

ScaledFace scaledFace(Geometry geometry, const TriangleValues& half_chords) {
  std::array<int, 3> order = {0, 1, 2};  // descending
  const TriangleValues& x = half_chords;
  if (x[order[0]] < x[order[1]]) std::swap(order[0], order[1]);
  if (x[order[1]] < x[order[2]]) std::swap(order[1], order[2]);
  if (x[order[0]] < x[order[1]]) std::swap(order[0], order[1]);

  const double longest = halfLength(geometry, x[order[0]]);
  const double middle = halfLength(geometry, x[order[1]]);
  const double shortest = halfLength(geometry, x[order[2]]);
  // s - x, with differences of sides of like size first: exact where they matter.
  const double slack = (middle - longest) + shortest;
  ScaledFace face;
  if (!(slack > 0)) {
    face.proper = false;
    face.half_tangent = {0, 0, 0};
    face.half_tangent[order[0]] = std::numeric_limits<double>::infinity();
    return face;
  }
  const TriangleValues f = {sine(geometry, slack), sine(geometry, (longest - middle) + shortest),
                            sine(geometry, (middle - shortest) + longest)};
  const double whole = sine(geometry, longest + middle + shortest);
  // Two factors at a time: a product of three could leave the range of a double.
  const double r = std::sqrt(f[0] * (f[1] / whole)) * std::sqrt(f[2]);
  for (int n = 0; n < 3; ++n) face.half_tangent[order[n]] = r / f[n];
  return face;
}

}  // namespace moduli
