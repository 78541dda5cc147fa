#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/store/search.h"

namespace moduli {

/// The first k hits of those shown, by distance and name, behind a position. Not thread-safe.
class BestHits {
 public:
  BestHits(std::size_t k, const std::optional<SearchPosition>& after) : k_(k), after_(&after) {}

  /// Whether a hit of a shape that is not among the hits would be kept.
  bool wants(double distance, const std::string& name) const {
    if (*after_ && std::tie(distance, name) <= std::tie((*after_)->distance, (*after_)->name)) {
      return false;
    }
    return !full() ||
           std::tie(distance, name) <= std::tie(hits_.back().distance, hits_.back().name);
  }

  /// Takes a hit in if it is wanted. A shape that was replaced during the search can turn up twice;
  /// the later row counts.
  void add(SearchHit hit) {
    const auto [known, is_new] = ids_.emplace(hit.name, hit.id);
    if (!is_new) {
      if (known->second >= hit.id) return;
      known->second = hit.id;
      std::erase_if(hits_, [&](const SearchHit& other) { return other.name == hit.name; });
    }
    if (!wants(hit.distance, hit.name)) {
      ids_.erase(known);
      return;
    }
    const auto place = std::upper_bound(hits_.begin(), hits_.end(), hit, comesBefore);
    hits_.insert(place, std::move(hit));
    if (hits_.size() <= k_) return;
    ids_.erase(hits_.back().name);
    hits_.pop_back();
  }

  bool has(const std::string& name) const { return ids_.contains(name); }
  bool full() const { return hits_.size() == k_; }
  double worst() const { return hits_.back().distance; }
  std::vector<SearchHit> take() { return std::move(hits_); }

 private:
  static bool comesBefore(const SearchHit& a, const SearchHit& b) {
    return std::tie(a.distance, a.name) < std::tie(b.distance, b.name);
  }

  std::size_t k_;
  const std::optional<SearchPosition>* after_;
  std::vector<SearchHit> hits_;
  std::unordered_map<std::string, std::int64_t> ids_;  ///< Of the hits.
};

}  // namespace moduli
