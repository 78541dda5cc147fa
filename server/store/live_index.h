#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/retrieval/vector_index.h"

namespace moduli {

/// A vector index that changes: a few immutable FLANN indexes, each several times as large as the
/// next, a short tail of later rows that is searched one by one, and marks on removed rows. A
/// search works on the state it found when it began: it never waits for a writer (but for copying a
/// pointer), frees nothing large, and sees each write whole or not at all. Exact. Thread-safe.
class LiveIndex {
 public:
  struct Options {
    /// rebuildDue() when the tail exceeds rebuild_minimum rows, or the removed rows that number and
    /// this share of all.
    double rebuild_fraction = 0.125;
    std::size_t rebuild_minimum = 1024;
  };

  /// Over the rows of `set` (distinct ids). Fails as makeFlannIndex.
  static Result<std::shared_ptr<LiveIndex>> build(VectorSet set, const Options& options);

  /// One write: first the ids of `removed` go (unknown ones are ignored), then the rows of `added`
  /// come, all at once for every search. Ids must be new for ever. Fails with kInvalidOption, doing
  /// nothing, on another dimension or values that are not finite.
  Status apply(const VectorSet& added, std::span<const std::int64_t> removed);

  /// As VectorIndex::search.
  Result<std::vector<Neighbor>> search(Context& context, std::span<const float> query,
                                       std::size_t k,
                                       const std::function<bool(std::int64_t)>& accept = {}) const;

  bool rebuildDue() const;
  /// Makes a new FLANN index of the tail and the indexes that are not much larger, of all where
  /// many rows are removed, and swaps it in; writes and searches go on meanwhile. It builds on
  /// a thread of the lowest priority, so that searches keep their processors. A second call while
  /// one runs returns at once. O(log(n)^2) a row over time.
  Status rebuild();

  std::size_t size() const;
  std::size_t dimension() const { return dimension_; }

 private:
  struct Base;
  struct Chunk;
  struct State;
  struct Merge;

  LiveIndex(std::size_t dimension, const Options& options);
  std::shared_ptr<const State> state() const;
  void publish(std::shared_ptr<const State> state);
  void appendRow(State& state, std::int64_t id, std::span<const float> values);
  bool removedDue(const State& state) const;
  Merge takeForMerge(const State& before) const;
  bool markRemoved(const State& state, std::int64_t id, std::uint64_t version);

  const std::size_t dimension_;
  const Options options_;
  mutable std::mutex state_mutex_;  ///< Held for a pointer copy only.
  std::shared_ptr<const State> state_;
  std::mutex write_mutex_;
  std::unordered_map<std::int64_t, std::size_t> tail_position_;  ///< Under write_mutex_.
  std::mutex rebuild_mutex_;
};

}  // namespace moduli
