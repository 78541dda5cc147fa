#pragma once

#include <cmath>

#include "core/mesh/samples.h"
#include "core/mesh/triangle_mesh.h"

namespace moduli {

/// A triaxial body with three unlike bumps: no symmetry, one surface for every resolution and seed.
inline TriangleSoup lump(int resolution, int seed) {
  TriangleSoup soup = *makeSample("sphere", {{"resolution", static_cast<double>(resolution)},
                                             {"seed", static_cast<double>(seed)}});
  const auto bump = [](const Eigen::Vector3d& p, const Eigen::Vector3d& where, double width) {
    return std::exp(-(p - where.normalized()).squaredNorm() / (2 * width * width));
  };
  for (Eigen::Vector3d& p : soup.vertices) {
    const double out = 1 + 0.9 * bump(p, {1, 0, 0}, 0.3) + 0.7 * bump(p, {-0.3, 0.9, 0.3}, 0.35) +
                       0.5 * bump(p, {-0.5, -0.4, 0.8}, 0.25);
    p = out * Eigen::Vector3d(1.4 * p[0], p[1], 0.8 * p[2]);
  }
  return soup;
}

}  // namespace moduli
