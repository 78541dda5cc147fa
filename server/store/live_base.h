#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/retrieval/vector_index.h"

namespace moduli {

/// The nearest rows, and how sure that is.
struct NearestRows {
  std::vector<Neighbor> neighbors;  ///< Nearest first; equal distances by ascending id.
  /// Where an approximate index was asked: the share of the true ten nearest that it found when it
  /// was built, of the least sure part. Empty: these are the true nearest ones.
  std::optional<double> recall;
};

/// When a row was removed: the version of the write that did it, 0 for none. A search on an older
/// version still sees the row: removal needs no copy of anything.
using RemovedAt = std::atomic<std::uint64_t>;

/// Whether who looks at `version` sees the row.
inline bool showsAt(std::uint64_t version, const RemovedAt& removed_at) {
  const std::uint64_t at = removed_at.load(std::memory_order_acquire);
  return at == 0 || at > version;
}

/// Part of a LiveIndex: an immutable index over rows by ascending id, and marks on removed ones.
/// Thread-safe.
class LiveBase {
 public:
  using Accept = std::function<bool(std::int64_t)>;

  /// With a wanted recall an approximate index (few rows make an exact one all the same). Fails as
  /// makeFlannIndex and makeApproximateIndex do.
  static Result<std::shared_ptr<LiveBase>> build(VectorSet set,
                                                 const std::optional<double>& wanted_recall);

  const VectorSet& rows() const { return index_->rows(); }
  std::size_t size() const { return rows().ids.size(); }
  const RemovedAt& removedAt(std::size_t row) const { return removed_at_[row]; }
  const std::optional<double>& wantedRecall() const { return wanted_recall_; }
  /// Measured; empty if it is exact.
  const std::optional<double>& recall() const { return recall_; }

  /// The mark of a row, which the caller is going to set; null if there is no such row.
  RemovedAt* markOf(std::int64_t id);
  bool anyRemoved() const { return any_removed_.load(std::memory_order_acquire); }
  std::size_t removedBy(std::uint64_t version) const;

  /// As VectorIndex::search, over the rows that are there at `version`. Where rows are left out
  /// (`accept`), or an approximate index finds less than there is, all rows are looked at: exact.
  Result<NearestRows> search(Context& context, std::span<const float> query, std::size_t k,
                             const Accept& accept, std::uint64_t version) const;
  /// search() of each query, on all cores.
  Result<std::vector<NearestRows>> searchMany(Context& context,
                                              std::span<const std::vector<float>> queries,
                                              std::size_t k, const Accept& accept,
                                              std::uint64_t version) const;

 private:
  std::optional<std::size_t> positionOf(std::int64_t id) const;
  Accept shown(const Accept& accept, std::uint64_t version) const;
  bool asksAll(const Accept& accept) const { return recall_ && accept; }
  Result<NearestRows> trusted(Context& context, std::span<const float> query, std::size_t k,
                              std::uint64_t version, std::vector<Neighbor> found) const;
  Result<std::vector<Neighbor>> scan(Context& context, std::span<const float> query, std::size_t k,
                                     const Accept& accept, std::uint64_t version) const;

  std::unique_ptr<VectorIndex> index_;
  std::optional<double> wanted_recall_, recall_;
  std::unique_ptr<RemovedAt[]> removed_at_;
  std::atomic<bool> any_removed_{false};
};

}  // namespace moduli
