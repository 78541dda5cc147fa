#include "core/signature/field_blocks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace moduli {
namespace {

/// Hats in log2(mu / 4 pi) with nodes -2, -1, .. 5; what is lower counts with the first.
double window(int index, double value) {
  const double place = std::log2(value / (4 * std::numbers::pi)) + 2;
  return std::max(0.0, 1 - std::abs(std::max(place, 0.0) - index));
}

}  // namespace

std::vector<double> fieldAmplitudes(const SurfaceModes& modes, const std::vector<double>& field) {
  Eigen::VectorXd weighted(static_cast<Eigen::Index>(field.size()));
  for (std::size_t v = 0; v < field.size(); ++v) {
    weighted[static_cast<Eigen::Index>(v)] = modes.areas[v] * field[v];
  }
  const Eigen::VectorXd coefficients = modes.functions.transpose() * weighted;
  std::vector<double> result(kFieldWindows, 0.0);
  for (Eigen::Index k = 0; k < kModeCount; ++k) {
    const double taper = modeTaper(modes.values[k], modes.values[kModeCount - 1]);
    for (int index = 0; index < kFieldWindows; ++index) {
      result[index] += taper * window(index, modes.values[k]) * coefficients[k] * coefficients[k];
    }
  }
  for (double& energy : result) energy = std::sqrt(energy);
  return result;
}

}  // namespace moduli
