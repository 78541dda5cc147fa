#pragma once

#include <numeric>
#include <utility>
#include <vector>

#include "core/mesh/triangle_soup.h"

namespace moduli {

/// A partition of [0, count) that only gets coarser. The root of a set is its lowest element.
class DisjointSets {
 public:
  explicit DisjointSets(Index count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  /// False if they were together already. O(log n) amortized.
  bool join(Index a, Index b) {
    a = root(a);
    b = root(b);
    if (a == b) return false;
    if (a > b) std::swap(a, b);
    parent_[b] = a;
    return true;
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace moduli
