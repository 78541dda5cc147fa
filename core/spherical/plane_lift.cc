#include "core/spherical/plane_lift.h"

#include <algorithm>
#include <utility>

namespace moduli {
double weightedMedian(std::vector<std::pair<double, double>> values_and_weights) {
  std::sort(values_and_weights.begin(), values_and_weights.end());
  double total = 0;
  for (const auto& [value, weight] : values_and_weights) total += weight;
  double sum = 0;
  for (const auto& [value, weight] : values_and_weights) {
    sum += weight;
    if (sum >= total / 2) return value;
  }
  return values_and_weights.back().first;
}

Points3 balancedLift(const std::vector<std::complex<double>>& z,
                     const std::vector<double>& weights) {
  std::vector<std::pair<double, double>> values(z.size());
  const auto median = [&](const auto& value) {
    for (std::size_t i = 0; i < z.size(); ++i) values[i] = {value(z[i]), weights[i]};
    return weightedMedian(values);
  };
  const std::complex<double> center(median([](const auto& w) { return w.real(); }),
                                    median([](const auto& w) { return w.imag(); }));
  const double radius = median([&](const auto& w) { return std::abs(w - center); });
  Points3 points(z.size());
  for (std::size_t i = 0; i < z.size(); ++i) {
    const std::complex<double> w = (z[i] - center) / radius;
    const double r2 = std::norm(w);
    points[i] = Eigen::Vector3d(2 * w.real(), 2 * w.imag(), r2 - 1) / (1 + r2);
  }
  return points;
}

}  // namespace moduli
