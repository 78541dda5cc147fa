#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/status.h"

namespace moduli {

/// Two items and how far apart they are, such as an item and one of its nearest neighbours.
struct ItemPair {
  std::size_t a = 0, b = 0;
  double distance = 0;
};

/// Items that a chain of close pairs connects.
struct Cluster {
  std::vector<std::size_t> members;  ///< Two or more, ascending.
  /// The smallest threshold at which these pairs connect all members; 0: all are duplicates. It is
  /// the largest distance on a minimal spanning tree, not the largest distance of two members,
  /// which may be up to members - 1 times as much.
  double linkage = 0;
};

/// Duplicates and near-duplicates: the connected clusters (single linkage) of the pairs whose
/// distance is at most the threshold, those of one item left out, by their lowest member ascending.
///
/// count: of items. pairs: in any order, either or both ways round, repeated or not; a pair of an
/// item with itself says nothing. The answer depends on which pairs there are alone, not on their
/// order. With the k nearest neighbours of every item, clusters are those of all pairs: an item
/// with more than k others within the threshold has its k nearest ones among them, which may leave
/// out a link, so that clusters can come out finer, never coarser. With all pairs within the
/// threshold they are exact.
/// Fails with kInvalidOption (an item out of range, a distance or threshold that is NaN or
/// negative, more than 2^31 - 1 items). O(p log p).
Result<std::vector<Cluster>> clusterPairs(std::size_t count, std::span<const ItemPair> pairs,
                                          double threshold);

}  // namespace moduli
