#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/signature/surface_modes.h"

namespace moduli {

inline constexpr int kDiffusionParts = 16;

/// Logarithms of quantile means of the biharmonic distance |a - b|, a_k = psi_k / mu_k, between two
/// points of a surface of area 1, over kDiffusionParts parts; then of the commute-time-like
/// distance with a_k = psi_k / sqrt(mu_k). From all pairs of 256 vertices that stand for those
/// nearest to them in the biharmonic embedding (farthestSample). Bending keeps them. Fails as
/// farthestSample. About 3 F. Source: Lipman, Rustamov, Funkhouser 2010.
Result<std::vector<double>> diffusionDistances(Context& context, const SurfaceModes& modes);

}  // namespace moduli
