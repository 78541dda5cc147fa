#include "core/ricci/vertex_scaling_energy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/ricci/lobachevsky.h"

namespace moduli {
namespace {

/// sinh(l / 2) = e^logarithm; from 20 on, asinh x is log 2 x to the last bit.
double hyperbolicLength(double logarithm) {
  return logarithm < 20 ? lengthOfHalfChord(Geometry::kHyperbolic, std::exp(logarithm))
                        : 2 * (logarithm + std::numbers::ln2);
}

/// Lengths from logarithms of half chords; Euclidean ones up to a common factor, so that they
/// neither over- nor underflow together.
TriangleValues lengthsOf(Geometry geometry, const TriangleValues& logarithms) {
  const double largest = *std::max_element(logarithms.begin(), logarithms.end());
  TriangleValues lengths{};
  for (int c = 0; c < 3; ++c) {
    lengths[c] = geometry == Geometry::kHyperbolic ? hyperbolicLength(logarithms[c])
                                                   : std::exp(logarithms[c] - largest);
  }
  return lengths;
}

}  // namespace

double vertexScalingEnergy(Geometry geometry, const TriangleValues& half_chords,
                           const TriangleValues& u) {
  if (geometry == Geometry::kSpherical) return std::numeric_limits<double>::quiet_NaN();
  TriangleValues logarithms{};
  for (int c = 0; c < 3; ++c) {
    logarithms[c] = std::log(half_chords[c]) + (u[(c + 1) % 3] + u[(c + 2) % 3]) / 2;
  }
  return vertexScalingEnergyOf(geometry, logarithms,
                               triangleAngles(geometry, lengthsOf(geometry, logarithms)));
}

double vertexScalingEnergyOf(Geometry geometry, const TriangleValues& logarithms,
                             const TriangleValues& angles) {
  if (geometry == Geometry::kSpherical) return std::numeric_limits<double>::quiet_NaN();
  // With lambda = 2 log x: in the hyperbolic energy the betas have no constant sum, and a constant
  // more in lambda would change the gradient.
  double energy = 0;
  for (int c = 0; c < 3; ++c) energy += 2 * lobachevsky(angles[c]);
  if (geometry == Geometry::kEuclidean) {
    for (int c = 0; c < 3; ++c) energy += 2 * angles[c] * logarithms[c];
    return energy;
  }
  energy /= 2;
  const double defect = std::numbers::pi - (angles[0] + angles[1] + angles[2]);
  for (int c = 0; c < 3; ++c) {
    const double beta = defect / 2 + angles[c];
    energy += 2 * beta * logarithms[c] + lobachevsky(beta);
  }
  return energy + lobachevsky(defect / 2);
}

}  // namespace moduli
