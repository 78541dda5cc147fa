#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/retrieval/vector_index.h"
#include "server/store/live_base.h"

namespace moduli {

/// A vector index that changes: a few immutable indexes, each several times as large as the next, a
/// short tail of later rows that is searched one by one, and marks on removed rows. A search works
/// on the state it found when it began: it never waits for a writer (but for copying a pointer),
/// frees nothing large, and sees each write whole or not at all. Exact unless a recall is wanted.
/// Thread-safe.
class LiveIndex {
 public:
  struct Options {
    /// rebuildDue() when the tail exceeds rebuild_minimum rows, or the removed rows that number and
    /// this share of all.
    double rebuild_fraction = 0.125;
    std::size_t rebuild_minimum = 1024;
    /// Of makeApproximateIndex for the immutable indexes; empty: these are exact.
    std::optional<double> wanted_recall = {};
  };

  /// Over the rows of `set` (distinct ids). Fails as LiveBase::build.
  static Result<std::shared_ptr<LiveIndex>> build(VectorSet set, const Options& options);

  /// One write: first the ids of `removed` go (unknown ones are ignored), then the rows of `added`
  /// come, all at once for every search. Ids must be new for ever. Fails with kInvalidOption, doing
  /// nothing, on another dimension or values that are not finite.
  Status apply(const VectorSet& added, std::span<const std::int64_t> removed);

  /// As VectorIndex::search. With an `accept` always exact.
  Result<NearestRows> search(Context& context, std::span<const float> query, std::size_t k,
                             const std::function<bool(std::int64_t)>& accept = {}) const;

  /// search() of each query, all in one state, on all cores; in an exact index much faster than one
  /// by one. Fails as search, with the first query that does.
  Result<std::vector<NearestRows>> searchMany(
      Context& context, std::span<const std::vector<float>> queries, std::size_t k,
      const std::function<bool(std::int64_t)>& accept = {}) const;

  /// What the next rebuild, which is due if that changes anything, makes its indexes for.
  void setWantedRecall(const std::optional<double>& wanted_recall);
  /// Measured, of the least sure of the indexes there are; empty if all are exact.
  std::optional<double> recall() const;

  bool rebuildDue() const;
  /// Makes a new index of the tail and the indexes that are not much larger, of all where many rows
  /// are removed or another recall is wanted, and swaps it in; writes and searches go on meanwhile.
  /// It builds on a thread of the lowest priority, so that searches keep their processors. A second
  /// call while one runs returns at once. O(log(n)^2) a row over time.
  Status rebuild();

  std::size_t size() const;
  std::size_t dimension() const { return dimension_; }

 private:
  struct Chunk;
  struct State;
  struct Merge;
  class Merging;

  LiveIndex(std::size_t dimension, const Options& options);
  std::shared_ptr<const State> state() const;
  void publish(std::shared_ptr<const State> state);
  void appendRow(State& state, std::int64_t id, std::span<const float> values);
  bool removedDue(const State& state) const;
  static bool recallDue(const State& state, const std::optional<double>& wanted_recall);
  std::optional<double> wantedRecall() const;
  Merge takeForMerge(const State& before, const std::optional<double>& wanted_recall) const;
  bool markRemoved(const State& state, std::int64_t id, std::uint64_t version);

  const std::size_t dimension_;
  const Options options_;
  mutable std::mutex state_mutex_;  ///< Held for a copy only.
  std::shared_ptr<const State> state_;
  std::optional<double> wanted_recall_;  ///< Under state_mutex_, too.
  std::mutex write_mutex_;
  std::unordered_map<std::int64_t, std::size_t> tail_position_;  ///< Under write_mutex_.
  std::mutex rebuild_mutex_;
};

}  // namespace moduli
