#pragma once

#include <cmath>

#include "core/mesh/samples.h"
#include "core/mesh/triangle_soup.h"

namespace moduli {

/// A hilly disk with an uneven boundary: no symmetry, one surface for every resolution and seed,
/// but for the boundary between its vertices.
inline TriangleSoup shield(int resolution, int seed) {
  TriangleSoup soup = *makeSample("disk", {{"resolution", static_cast<double>(resolution)},
                                           {"seed", static_cast<double>(seed)}});
  const auto hill = [](const Eigen::Vector3d& p, double x, double y, double width) {
    return std::exp(-(p - Eigen::Vector3d(x, y, 0)).squaredNorm() / (2 * width * width));
  };
  for (Eigen::Vector3d& p : soup.vertices) {
    const double angle = std::atan2(p.y(), p.x());
    const double out = 1 + 0.25 * std::cos(angle - 0.4) + 0.15 * std::cos(2 * angle + 1);
    const double height =
        0.9 * hill(p, 0.4, 0.2, 0.25) + 0.5 * hill(p, -0.5, 0.3, 0.2) - 0.6 * hill(p, 0, -0.6, 0.3);
    p = Eigen::Vector3d(out * p.x(), out * p.y(), height);
  }
  return soup;
}

/// A square of two faces, all of whose vertices are on the boundary.
inline TriangleSoup twoTriangles() {
  return {{{0, 0, 0}, {2, 0, 0}, {2, 1, 0.5}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

/// A row of n faces like that, with edges inside from one side to the other.
inline TriangleSoup strip(Index n) {
  TriangleSoup soup;
  for (Index i = 0; i < n + 2; ++i) {
    const double t = 0.35 * i;
    soup.vertices.emplace_back(t + 0.05 * t * t, i % 2, 0.2 * std::sin(t));
  }
  for (Index i = 0; i < n; ++i) {
    soup.faces.push_back(i % 2 == 0 ? Triangle{i, i + 2, i + 1} : Triangle{i, i + 1, i + 2});
  }
  return soup;
}

}  // namespace moduli
