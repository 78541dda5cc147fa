#include "core/matching/rim_targets.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <queue>

namespace moduli {
namespace {

constexpr std::size_t kMostTried = 500;

/// From -1/2 to 1/2.
double wrapped(double turns) {
  return turns - std::round(turns);
}

/// The turn that is nearest to most.
double bestTurn(const std::vector<double>& from, const std::vector<double>& to) {
  const std::size_t count = from.size(), step = std::max<std::size_t>(count / kMostTried, 1);
  double best = 0, least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; i += step) {
    const double turn = to[i] - from[i];
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) sum += std::abs(wrapped(to[k] - from[k] - turn));
    if (!(sum < least)) continue;
    least = sum;
    best = turn;
  }
  return best;
}

/// Ascending values with the least sum of distances.
std::vector<double> ascending(const std::vector<double>& values) {
  std::priority_queue<double> heap;
  std::vector<double> fit;
  for (const double value : values) {
    heap.push(value);
    if (heap.top() > value) {
      heap.pop();
      heap.push(value);
    }
    fit.push_back(heap.top());
  }
  for (std::size_t i = fit.size() - 1; i > 0; --i) fit[i - 1] = std::min(fit[i - 1], fit[i]);
  return fit;
}

}  // namespace

std::vector<double> orderedAroundCircle(const std::vector<double>& from,
                                        const std::vector<double>& to) {
  const std::size_t count = from.size();
  if (count == 0) return {};
  const double turn = bestTurn(from, to);
  // Three times around: the middle one knows what comes before and after it.
  std::vector<double> values;
  for (const double round : {-1.0, 0.0, 1.0}) {
    for (std::size_t i = 0; i < count; ++i) {
      values.push_back(round + from[i] + turn + wrapped(to[i] - from[i] - turn));
    }
  }
  const std::vector<double> fit = ascending(values);
  std::vector<double> result;
  for (std::size_t i = count; i < 2 * count; ++i) {
    const double value = std::min(fit[i], fit[count] + 1);
    const double share = value - std::floor(value);
    result.push_back(share < 1 ? share : 0);
  }
  return result;
}

}  // namespace moduli
