#include "core/intrinsic/unfold.h"

#include <algorithm>
#include <queue>
#include <utility>

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// Shorter edges are judged by the mean length.
constexpr double kTinyEdge = 1e-6;

/// Places a face so that its halfedge h starts at `start` and runs along `direction`.
void place(const FlatCharts& charts, Index h, Complex start, Complex direction,
           std::vector<Complex>& placed) {
  Complex turn = direction / charts[h];
  turn /= std::abs(turn);
  placed[h] = start;
  placed[Connectivity::next(h)] = start + turn * charts[h];
  placed[Connectivity::previous(h)] = start - turn * charts[Connectivity::previous(h)];
}

}  // namespace

Unfolding unfold(const FlatCharts& charts, const std::vector<Index>& twin,
                 const std::vector<bool>& skip) {
  const auto count = static_cast<Index>(charts.size());
  Unfolding result{std::vector<Complex>(count), std::vector<bool>(count, false)};
  std::vector<bool> seen = skip;
  seen.resize(charts.size() / 3, false);
  Index root = kNone;
  for (Index h = 0; h < count; ++h) {
    if (seen[h / 3]) continue;
    if (root == kNone || std::abs(charts[h]) > std::abs(charts[root])) root = h;
  }
  if (root == kNone) return result;
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry> queue;
  const auto leave = [&](Index h) {
    seen[Connectivity::faceOf(h)] = true;
    for (const Index g : {h, Connectivity::next(h), Connectivity::previous(h)}) {
      if (twin[g] != kNone) queue.push({std::abs(charts[g]), g});
    }
  };
  place(charts, root, 0, 1, result.placed);
  leave(root);
  while (!queue.empty()) {
    const Index h = queue.top().second;
    queue.pop();
    if (seen[Connectivity::faceOf(twin[h])]) continue;
    const Complex from = result.placed[Connectivity::next(h)], to = result.placed[h];
    place(charts, twin[h], from, to - from, result.placed);
    result.crossed[h] = result.crossed[twin[h]] = true;
    leave(twin[h]);
  }
  return result;
}

double unfoldingGap(const Unfolding& unfolding, const FlatCharts& charts,
                    const std::vector<Index>& twin, const std::vector<bool>& fits) {
  const std::vector<Complex>& placed = unfolding.placed;
  double mean = 0, counted = 0;
  const auto count = static_cast<Index>(charts.size());
  for (Index h = 0; h < count; ++h) {
    if (!fits[h]) continue;
    mean += std::abs(charts[h]);
    ++counted;
  }
  if (counted == 0) return 0;
  mean /= counted;
  double largest = 0;
  for (Index h = 0; h < count; ++h) {
    if (!fits[h] || twin[h] == kNone || h > twin[h]) continue;
    const double gap = std::max(std::abs(placed[h] - placed[Connectivity::next(twin[h])]),
                                std::abs(placed[Connectivity::next(h)] - placed[twin[h]]));
    const double length = std::abs(charts[h]);
    largest = std::max(largest, gap / (length > kTinyEdge * mean ? length : mean));
  }
  return largest;
}

}  // namespace moduli
