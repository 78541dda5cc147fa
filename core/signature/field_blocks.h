#pragma once

#include <vector>

#include "core/signature/surface_modes.h"

namespace moduli {

/// Soft windows of frequency, by log of the eigenvalue.
inline constexpr int kFieldWindows = 8;

/// Amplitudes of a field given at the vertices in the windows: sqrt(sum_k w(mu_k) <f, psi_k>^2),
/// where windows overlap and sum to the taper. Rotations among equal eigenvalues keep them, and
/// they are 1-Lipschitz in f in the mean square. O(V kModeCount).
std::vector<double> fieldAmplitudes(const SurfaceModes& modes, const std::vector<double>& field);

}  // namespace moduli
