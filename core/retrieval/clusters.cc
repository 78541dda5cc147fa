#include "core/retrieval/clusters.h"

#include <algorithm>
#include <limits>
#include <string>

#include "core/mesh/disjoint_sets.h"

namespace moduli {
namespace {

Status invalid(std::string message) {
  return {Reason::kInvalidOption, std::move(message)};
}

Status checkPairs(std::size_t count, std::span<const ItemPair> pairs, double threshold) {
  if (count > static_cast<std::size_t>(std::numeric_limits<Index>::max())) {
    return invalid(std::to_string(count) + " items are too many to cluster");
  }
  if (!(threshold >= 0)) return invalid("the threshold is negative or not a number");
  for (const ItemPair& pair : pairs) {
    const std::string name = std::to_string(pair.a) + " and " + std::to_string(pair.b);
    if (std::max(pair.a, pair.b) >= count) {
      return invalid("items " + name + " are not both among " + std::to_string(count));
    }
    if (!(pair.distance >= 0)) {
      return invalid("the distance of items " + name + " is negative or not a number");
    }
  }
  return {};
}

}  // namespace

Result<std::vector<Cluster>> clusterPairs(std::size_t count, std::span<const ItemPair> pairs,
                                          double threshold) {
  RETURN_IF_ERROR(checkPairs(count, pairs, threshold));
  std::vector<ItemPair> close;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(close),
               [&](const ItemPair& pair) { return pair.distance <= threshold; });
  // Kruskal: the last pair that joins two parts of a cluster is the longest that it needs.
  std::sort(close.begin(), close.end(),
            [](const ItemPair& a, const ItemPair& b) { return a.distance < b.distance; });
  DisjointSets sets(static_cast<Index>(count));
  std::vector<double> linkage(count, 0);
  for (const ItemPair& pair : close) {
    if (!sets.join(static_cast<Index>(pair.a), static_cast<Index>(pair.b))) continue;
    linkage[sets.root(static_cast<Index>(pair.a))] = pair.distance;
  }
  std::vector<Cluster> of_root(count);
  for (std::size_t i = 0; i < count; ++i) {
    of_root[sets.root(static_cast<Index>(i))].members.push_back(i);
  }
  std::vector<Cluster> clusters;
  for (std::size_t root = 0; root < count; ++root) {
    if (of_root[root].members.size() < 2) continue;
    of_root[root].linkage = linkage[root];
    clusters.push_back(std::move(of_root[root]));
  }
  return clusters;
}

}  // namespace moduli
