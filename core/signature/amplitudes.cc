#include "core/signature/amplitudes.h"

#include <algorithm>
#include <cmath>

namespace moduli {
namespace {

/// Rounding may leave the power of a difference of equal fields below 0.
double amplitude(double power) {
  return std::sqrt(std::max(0.0, power));
}

}  // namespace

std::vector<double> metricAmplitudes(const MetricBlock& metric) {
  std::vector<double> result;
  for (const double power : metric.conformal_factor_spectrum) result.push_back(amplitude(power));
  return result;
}

std::vector<double> shapeAmplitudes(const MetricBlock& metric, const ShapeBlock& shape) {
  const std::size_t count =
      std::min({metric.conformal_factor_spectrum.size(), shape.mean_curvature_spectrum.size(),
                shape.cross_spectrum.size()});
  std::vector<double> result(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const double l = static_cast<double>(i) + 1;
    const double weight = 2 / (l * (l + 1));
    const double factor = metric.conformal_factor_spectrum[i];
    const double bend = weight * weight * shape.mean_curvature_spectrum[i];
    const double cross = weight * shape.cross_spectrum[i];
    result[i] = amplitude(bend);
    result[count + i] = amplitude(factor + bend + 2 * cross) / 2;
    result[2 * count + i] = amplitude(factor + bend - 2 * cross) / 2;
  }
  return result;
}

std::optional<std::vector<double>> amplitudes(const Signature& signature, Space space) {
  if (space == Space::kMetric && signature.metric) return metricAmplitudes(*signature.metric);
  if (space != Space::kShape) return std::nullopt;
  if (signature.metric && signature.shape) {
    return shapeAmplitudes(*signature.metric, *signature.shape);
  }
  const std::vector<float>& stored = signature.vectors.shape;
  if (stored.empty()) return std::nullopt;
  return std::vector<double>(stored.begin(), stored.end());
}

}  // namespace moduli
