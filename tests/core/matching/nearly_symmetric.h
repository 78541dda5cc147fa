#pragma once

#include <cmath>
#include <string>

#include "tests/core/matching/cover_samples.h"

namespace moduli {

/// A body that half turns about the axes would carry to itself, were it not for a bump, low and
/// wide, beside all planes of symmetry.
struct NearlySymmetric {
  std::string sample;
  Eigen::Vector3d factors, bump;

  TriangleSoup base(double resolution, double seed) const {
    return *makeSample(sample, {{"resolution", resolution}, {"seed", seed}});
  }
  Eigen::Vector3d operator()(const Eigen::Vector3d& p, double height) const {
    const double out = 1 + height * std::exp(-(p - bump).squaredNorm() / (0.5 * bump.norm()));
    return out * factors.cwiseProduct(p);
  }
  TriangleMesh mesh(double resolution, double seed, double height) const {
    TriangleSoup soup = base(resolution, seed);
    for (Eigen::Vector3d& p : soup.vertices) p = (*this)(p, height);
    return meshOf(soup);
  }
};

inline const NearlySymmetric kEgg = {"ellipsoid", {1.4, 1, 0.7}, {0.5, 0.5, 0.5}};
inline const NearlySymmetric kRing = {"torus", {1.4, 1, 0.8}, {1.8, 1.2, 0.8}};

}  // namespace moduli
