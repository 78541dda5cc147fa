#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/retrieval/vector_index.h"

namespace moduli {

/// Nearer first, equal distances by ascending id.
inline bool nearer(const Neighbor& a, const Neighbor& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.id < b.id;
}

/// Keeps the k nearest of the neighbours that it is shown. Not thread-safe.
class NearestSet {
 public:
  /// k at least 1; rows: how many there are to come at most.
  NearestSet(std::size_t k, std::size_t rows) : k_(k) { heap_.reserve(std::min(k, rows)); }

  bool full() const { return heap_.size() == k_; }
  /// Of the farthest kept; the set must not be empty.
  const Neighbor& worst() const { return heap_.front(); }

  /// Whether `neighbor` would be kept.
  bool wants(const Neighbor& neighbor) const { return !full() || nearer(neighbor, worst()); }

  /// Precondition: wants(neighbor).
  void add(const Neighbor& neighbor) {
    if (full()) {
      std::pop_heap(heap_.begin(), heap_.end(), nearer);
      heap_.back() = neighbor;
    } else {
      heap_.push_back(neighbor);
    }
    std::push_heap(heap_.begin(), heap_.end(), nearer);
  }

  /// Nearest first; leaves the set empty.
  std::vector<Neighbor> take() {
    std::sort_heap(heap_.begin(), heap_.end(), nearer);
    return std::move(heap_);
  }

 private:
  std::size_t k_;
  std::vector<Neighbor> heap_;  ///< Farthest on top.
};

}  // namespace moduli
