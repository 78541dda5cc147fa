#include "core/hyperbolic/orbit_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace moduli {

OrbitIndex::OrbitIndex(double separation) : size_(std::sinh(separation / 2) / 2) {}

std::size_t OrbitIndex::CellHash::operator()(const Cell& cell) const {
  std::uint64_t h = static_cast<std::uint64_t>(cell.x) * 0x9e3779b97f4a7c15ULL;
  h = (h ^ (h >> 29)) + static_cast<std::uint64_t>(cell.y) * 0xbf58476d1ce4e5b9ULL;
  return static_cast<std::size_t>(h ^ (h >> 32));
}

std::int32_t OrbitIndex::find(const Su11& g) const {
  const Complex place = 2.0 * g.a * g.b / size_;
  const auto near = [](double x, int k) {
    return static_cast<std::int64_t>(std::floor(x + 0.125 * k));
  };
  const std::int64_t xs[] = {near(place.real(), -1), near(place.real(), 1)};
  const std::int64_t ys[] = {near(place.imag(), -1), near(place.imag(), 1)};
  for (int i = 0; i < (xs[0] == xs[1] ? 1 : 2); ++i)
    for (int j = 0; j < (ys[0] == ys[1] ? 1 : 2); ++j) {
      const auto found = cells_.find({xs[i], ys[j]});
      if (found != cells_.end() && std::abs(found->second.place - place) < 1)
        return found->second.value;
    }
  return -1;
}

void OrbitIndex::enter(const Su11& g, std::int32_t value) {
  const Complex place = 2.0 * g.a * g.b / size_;
  cells_.insert_or_assign(Cell{static_cast<std::int64_t>(std::floor(place.real())),
                               static_cast<std::int64_t>(std::floor(place.imag()))},
                          Entry{place, value});
}

Word OrbitBall::wordOf(const OrbitPolygon& polygon, std::size_t i) const {
  std::vector<std::int32_t> steps;
  for (auto k = static_cast<std::int32_t>(i); k != 0; k = parent[k]) steps.push_back(pairing[k]);
  Word word;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    const Word& letters = polygon.pairings[*step].word;
    word.insert(word.end(), letters.begin(), letters.end());
  }
  return reduceWord(word);
}

namespace {

struct Found {
  double b = 0;
  std::int32_t index = 0;
  bool operator>(const Found& other) const { return b > other.b; }
};

/// The elements with |b| at most `last` in ascending order, with parents renumbered.
OrbitBall ascending(const OrbitBall& found, const std::vector<std::int32_t>& order) {
  OrbitBall ball;
  std::vector<std::int32_t> place(found.elements.size(), -1);
  for (const std::int32_t i : order) {
    place[i] = static_cast<std::int32_t>(ball.elements.size());
    ball.elements.push_back(found.elements[i]);
    ball.parent.push_back(i == 0 ? 0 : place[found.parent[i]]);
    ball.pairing.push_back(found.pairing[i]);
  }
  return ball;
}

}  // namespace

Result<OrbitBall> searchOrbit(Context& context, const OrbitPolygon& polygon, double reach,
                              std::size_t most) {
  const Context::Stage stage(context, "orbit");
  most = std::clamp<std::size_t>(most, 1, std::numeric_limits<std::int32_t>::max() / 2);
  const double affordable = std::acosh(1 + 2.0 * (polygon.genus - 1) * static_cast<double>(most));
  const double aim = std::min(reach, affordable);
  const double largest = std::sinh(aim / 2);
  OrbitIndex index(polygon.separation);
  OrbitBall found{{Su11{}}, {0}, {0}, aim};
  index.enter(Su11{}, 0);
  std::priority_queue<Found, std::vector<Found>, std::greater<>> frontier;
  frontier.push({0, 0});
  std::vector<std::int32_t> order;
  double complete_to = aim;
  while (!frontier.empty()) {
    if (order.size() % 4096 == 0) RETURN_IF_ERROR(context.check());
    const Found next = frontier.top();
    if (found.elements.size() > 2 * most) {
      complete_to = 2 * std::asinh(next.b);
      break;
    }
    frontier.pop();
    order.push_back(next.index);
    for (std::size_t k = 0; k < polygon.pairings.size(); ++k) {
      const Su11& from = found.elements[next.index];
      const Su11& step = polygon.pairings[k].map;
      const double b = std::sqrt(std::norm(from.a * step.b + from.b * std::conj(step.a)));
      // Strictly outwards, up to rounding: the way back inwards is found from the other end.
      if (b > largest || b < next.b * (1 - 1e-9)) continue;
      const Su11 g = from * step;
      if (index.find(g) >= 0) continue;
      const auto i = static_cast<std::int32_t>(found.elements.size());
      found.elements.push_back(renormalized(g));
      found.parent.push_back(next.index);
      found.pairing.push_back(static_cast<std::int32_t>(k));
      index.enter(g, i);
      frontier.push({b, i});
    }
  }
  OrbitBall ball = ascending(found, order);
  ball.complete_to = complete_to;
  return ball;
}

}  // namespace moduli
