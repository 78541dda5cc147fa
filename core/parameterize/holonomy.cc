#include "core/parameterize/holonomy.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/topology/tree_cotree.h"

namespace moduli {

std::vector<double> handleTurns(const Connectivity& surface,
                                const std::vector<std::complex<double>>& points,
                                const std::vector<Index>& corner) {
  const Result<TreeCotree> trees = computeTreeCotree(surface);
  if (!trees.ok()) return {};
  const auto along = [&](Index h) {
    return points[corner[Connectivity::next(h)]] - points[corner[h]];
  };
  std::vector<double> turns;
  for (const Cochain& loop : cohomologyBasis(surface, *trees)) {
    double turn = 0;
    for (const CochainTerm& term : loop) {
      const Index h = surface.halfedge(term.edge);
      turn += static_cast<double>(term.value) * std::arg(-along(surface.twin(h)) / along(h));
    }
    turn = std::remainder(turn, 2 * std::numbers::pi);
    turns.push_back(turn <= -std::numbers::pi ? turn + 2 * std::numbers::pi : turn);
  }
  return turns;
}

double distanceFromMultiples(const std::vector<double>& angles, double unit) {
  double largest = 0;
  for (const double angle : angles)
    largest = std::max(largest, std::abs(std::remainder(angle, unit)));
  return largest;
}

}  // namespace moduli
