#include "core/signature/soft_bins.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace moduli {
namespace {

/// order: indices by ascending value.
std::vector<double> sortedMeans(const std::vector<double>& values,
                                const std::vector<double>& weights,
                                const std::vector<std::size_t>& order, int count) {
  double total = 0;
  for (const std::size_t i : order) total += weights[i];
  std::vector<double> means(count, 0.0);
  double begin = 0;  // In units of the parts.
  for (const std::size_t i : order) {
    const double end = begin + weights[i] / total * count;
    for (int part = static_cast<int>(begin); part < count && part < end; ++part) {
      const double share = std::min<double>(end, part + 1) - std::max<double>(begin, part);
      if (share > 0) means[part] += share * values[i];
    }
    begin = end;
  }
  return means;
}

}  // namespace

std::vector<double> quantileMeans(const std::vector<double>& values,
                                  const std::vector<double>& weights, int count) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return values[a] != values[b] ? values[a] < values[b] : a < b;
  });
  return sortedMeans(values, weights, order, count);
}

std::vector<double> tailedQuantileMeans(const std::vector<double>& values,
                                        const std::vector<double>& weights) {
  const std::vector<double> fine = quantileMeans(values, weights, 8);
  return {fine[0], fine[1], (fine[2] + fine[3]) / 2, (fine[4] + fine[5]) / 2, fine[6], fine[7]};
}

SoftHistogram::SoftHistogram(double highest, int bins) : highest_(highest), weights_(bins, 0.0) {}

void SoftHistogram::add(double value, double weight) {
  const double last = static_cast<double>(weights_.size()) - 1;
  const double place = std::clamp(value / highest_, 0.0, 1.0) * last;
  const double floor = std::min(std::floor(place), last - 1);
  const auto node = static_cast<std::size_t>(floor);
  weights_[node] += weight * (1 - (place - floor));
  weights_[node + 1] += weight * (place - floor);
}

std::vector<double> SoftHistogram::shares() const {
  const double total = std::accumulate(weights_.begin(), weights_.end(), 0.0);
  std::vector<double> result = weights_;
  for (double& weight : result) weight /= total;
  return result;
}

std::vector<double> SoftHistogram::quantileMeans(int count) const {
  std::vector<double> nodes(weights_.size());
  std::vector<std::size_t> order(weights_.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes[i] = highest_ * static_cast<double>(i) / (static_cast<double>(nodes.size()) - 1);
    order[i] = i;
  }
  return sortedMeans(nodes, weights_, order, count);
}

}  // namespace moduli
