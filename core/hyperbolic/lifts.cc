#include "core/hyperbolic/lifts.h"

#include <algorithm>
#include <cmath>

namespace moduli {
namespace {

/// What doubles make of it is told from this on; elements shorter than kShort are not looked at in
/// doubles.
constexpr double kRough = 2;
constexpr double kShort = 0.1;

}  // namespace

std::vector<std::int32_t> pairingsOf(const OrbitPolygon& polygon, const Su11& element) {
  std::vector<std::int32_t> result;
  WideSu11 wide = widened(element);
  Su11 rest = element;
  while (std::abs(rest.b) > std::sinh(polygon.separation / 4)) {
    double least = std::abs(rest.b) * (1 - 1e-12);
    std::int32_t best = -1;
    for (std::size_t k = 0; k < polygon.pairings.size(); ++k) {
      const double b = std::abs((inverse(polygon.pairings[k].map) * rest).b);
      if (b >= least) continue;
      least = b;
      best = static_cast<std::int32_t>(k);
    }
    if (best < 0) return {};
    wide = renormalized(inverse(polygon.wide[best]) * wide);
    rest = rounded(wide);
    result.push_back(best);
  }
  return result;
}

WideSu11 productOf(const OrbitPolygon& polygon, const std::vector<std::int32_t>& pairings) {
  WideSu11 product;
  for (const std::int32_t k : pairings) product = renormalized(product * polygon.wide[k]);
  return product;
}

std::vector<Lift> liftsAcross(const OrbitPolygon& polygon, const WideSu11& element, double slack) {
  std::vector<Lift> found{{element, rounded(element)}};
  const bool is_short = translationLength(found[0].shape) < kShort;
  const auto known = [&found](const Su11& g) {
    return std::any_of(found.begin(), found.end(),
                       [&g](const Lift& h) { return sameElement(g, h.shape); });
  };
  for (std::size_t i = 0; i < found.size(); ++i)
    for (std::size_t k = 0; k < polygon.pairings.size(); ++k) {
      const Su11& s = polygon.pairings[k].map;
      if (!is_short) {
        const Su11 rough = renormalized(inverse(s) * found[i].shape * s);
        if (!meetsPolygon(polygon, axisOf(rough), kRough + slack) || known(rough)) continue;
      }
      const WideSu11& w = polygon.wide[k];
      const WideSu11 exact = renormalized(inverse(w) * found[i].map * w);
      const Su11 g = rounded(exact);
      if (!meetsPolygon(polygon, axisOf(g), slack) || known(g)) continue;
      found.push_back({exact, g, static_cast<int>(i), static_cast<int>(k)});
    }
  return found;
}

}  // namespace moduli
