#include "core/picture/level_sets.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

namespace moduli {
namespace {

/// A side of a square, by its lower or left end: 2 (point) + (0 along x, 1 along y).
using Side = std::int64_t;

class MarchingSquares {
 public:
  MarchingSquares(const GridValues& grid, double level) : grid_(grid), level_(level) {
    for (int j = 0; j + 1 < grid.rows; ++j) {
      for (int i = 0; i + 1 < grid.columns; ++i) cross(i, j);
    }
  }

  std::vector<Outline> lines() {
    std::vector<Outline> result;
    // Lines that begin at the border first, then what is closed.
    for (const Side first : firsts_) {
      if (!arrivals_.contains(first)) result.push_back(follow(first));
    }
    for (const Side first : firsts_) {
      if (next_.contains(first)) result.push_back(follow(first));
    }
    return result;
  }

 private:
  Side along(int i, int j, bool up) const {
    return 2 * (static_cast<Side>(j) * grid_.columns + i) + (up ? 1 : 0);
  }

  bool above(int i, int j) const { return grid_.at(i, j) > level_; }

  void add(Side from, Side to) {
    next_.emplace(from, to);
    arrivals_.emplace(to, from);
    firsts_.push_back(from);
  }

  /// The lines through one square, what is above on their left.
  void cross(int i, int j) {
    const std::array<std::array<int, 2>, 4> corner{
        {{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
    const std::array<Side, 4> side{along(i, j, false), along(i + 1, j, true),
                                   along(i, j + 1, false), along(i, j, true)};
    double mean = 0;
    std::array<bool, 4> high{};
    for (std::size_t c = 0; c < 4; ++c) {
      const double value = grid_.at(corner[c][0], corner[c][1]);
      if (!std::isfinite(value)) return;
      mean += value / 4;
      high[c] = above(corner[c][0], corner[c][1]);
    }
    // Going around counter-clockwise, the lines enter where the values rise and leave where they
    // fall: of two, each one leaves at the next fall, or at the one before.
    std::vector<std::size_t> rises, falls;
    for (std::size_t c = 0; c < 4; ++c) {
      const bool begin = high[c], end = high[(c + 1) % 4];
      if (!begin && end) rises.push_back(c);
      if (begin && !end) falls.push_back(c);
    }
    if (rises.size() == 1) add(side[falls[0]], side[rises[0]]);
    if (rises.size() < 2) return;
    for (const std::size_t rise : rises) {
      const std::size_t fall = mean > level_ ? (rise + 3) % 4 : (rise + 1) % 4;
      add(side[fall], side[rise]);
    }
  }

  std::array<double, 2> point(Side at) const {
    const auto number = at / 2;
    const int i = static_cast<int>(number % grid_.columns);
    const int j = static_cast<int>(number / grid_.columns);
    const bool up = at % 2 == 1;
    const double low = grid_.at(i, j), high = up ? grid_.at(i, j + 1) : grid_.at(i + 1, j);
    const double share = (level_ - low) / (high - low);
    return {i + (up ? 0 : share), j + (up ? share : 0)};
  }

  Outline follow(Side first) {
    Outline line{point(first)};
    Side at = first;
    for (auto step = next_.find(at); step != next_.end(); step = next_.find(at)) {
      at = step->second;
      next_.erase(step);
      line.push_back(point(at));
    }
    return line;
  }

  const GridValues& grid_;
  double level_;
  std::unordered_map<Side, Side> next_, arrivals_;
  std::vector<Side> firsts_;
};

}  // namespace

std::vector<Outline> levelSet(const GridValues& grid, double level) {
  return MarchingSquares(grid, level).lines();
}

}  // namespace moduli
