#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "core/retrieval/nearest_set.h"
#include "core/retrieval/squared_distance.h"
#include "core/retrieval/vector_index.h"

namespace moduli {

/// The k nearest of the rows that it is offered, by distances of the caller's own vectors: whoever
/// picks the candidates, the answer is that of looking at every row, to the last bit, as long as no
/// row within limit() is left out. Not thread-safe. What it refers to must outlive it.
class ExactNearest {
 public:
  using Accept = std::function<bool(std::int64_t)>;

  /// scale, slack: a bound in turned coordinates (PrincipalAxes) lies within slack of scale times
  /// the true distance. cap: rows farther than that are known not to be wanted.
  ExactNearest(const VectorSet& set, std::span<const float> query, std::size_t k,
               const Accept& accept, double scale, double slack,
               double cap = std::numeric_limits<double>::infinity())
      : set_(set),
        query_(query),
        accept_(accept),
        scale_(scale),
        slack_(slack),
        cap_(cap),
        nearest_(k, set.ids.size()) {
    updateLimit();
  }

  /// From now on row i means rows[i].
  void renumber(std::span<const std::uint32_t> rows) { renumbered_ = rows; }

  /// Of the worst that is still wanted, squared, in turned coordinates; rounded up.
  double limit() const { return limit_; }
  bool full() const { return nearest_.full(); }
  /// Of the worst that is still wanted.
  double worst() const {
    return nearest_.full() ? std::min(cap_, nearest_.worst().distance) : cap_;
  }

  void offer(std::size_t row) {
    if (!renumbered_.empty()) row = renumbered_[row];
    const double squared = squaredDistance(query_.data(), set_.values.data() + row * set_.dimension,
                                           set_.dimension, give_up_);
    add({set_.ids[row], std::sqrt(squared)});
  }

  void add(const Neighbor& neighbor) {
    if (!(neighbor.distance <= cap_) || !nearest_.wants(neighbor)) return;
    if (accept_ && !accept_(neighbor.id)) return;
    nearest_.add(neighbor);
    if (nearest_.full()) updateLimit();
  }

  /// Nearest first; leaves it empty.
  std::vector<Neighbor> take() { return nearest_.take(); }

 private:
  void updateLimit() {
    const double bound = scale_ * worst() + slack_;
    limit_ = bound * bound * (1 + 1e-12);
    // A sum given up there has a root above the worst distance, whatever the roundings.
    give_up_ = worst() * worst() * (1 + 1e-12) + std::numeric_limits<double>::min();
  }

  const VectorSet& set_;
  const std::span<const float> query_;
  const Accept& accept_;
  const double scale_;
  const double slack_;
  const double cap_;
  std::span<const std::uint32_t> renumbered_;
  NearestSet nearest_;
  double limit_ = 0;
  double give_up_ = 0;
};

}  // namespace moduli
