#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"

namespace moduli {

/// Rows of float32 vectors of one dimension, each with the caller's identity.
struct VectorSet {
  std::size_t dimension = 0;
  std::vector<float> values;  ///< Row after row: ids.size() * dimension.
  std::vector<std::int64_t> ids;
};

struct Neighbor {
  std::int64_t id = 0;
  double distance = 0;  ///< Euclidean, not squared.
  bool operator==(const Neighbor&) const = default;
};

/// Nearest neighbours under the Euclidean distance. Immutable after building and safe to search
/// from several threads. Neighbours come nearest first; equal distances by ascending id.
class VectorIndex {
 public:
  virtual ~VectorIndex() = default;

  /// The k nearest rows that `accept` (may be empty: all) lets through; fewer if there are fewer.
  /// accept may be called from several threads at once.
  /// Fails with kInvalidOption if the query has another dimension or is not finite, k is 0, and
  /// with kCancelled / kDeadlineExceeded.
  virtual Result<std::vector<Neighbor>> search(
      Context& context, std::span<const float> query, std::size_t k,
      const std::function<bool(std::int64_t)>& accept = {}) const = 0;

  /// search() of each query, on all cores; in an exact index much faster than one by one. Fails as
  /// search, with the first query that does.
  virtual Result<std::vector<std::vector<Neighbor>>> searchMany(
      Context& context, std::span<const std::vector<float>> queries, std::size_t k,
      const std::function<bool(std::int64_t)>& accept = {}) const;

  /// The rows that it was built of, in the order given.
  virtual const VectorSet& rows() const = 0;
  std::size_t size() const { return rows().ids.size(); }
  std::size_t dimension() const { return rows().dimension; }
  /// Whether the answer is always the true nearest neighbours.
  virtual bool exact() const = 0;
};

/// Looks at every row. The twin that the other is tested against: the same rows give the same ids
/// and the same distances to the last bit. Fails as makeFlannIndex.
Result<std::unique_ptr<VectorIndex>> makeBruteForceIndex(VectorSet set);

/// Exact search over rows turned to their principal axes: FLANN's single k-d trees, one for each
/// shard of at most `shard_rows` neighbouring rows, nearest shard first; where a query asks them
/// too much, and for many queries at once, a scan of the leading coordinates, on all cores. Both
/// pick candidates with certified margins; their distances are computed of the rows as given, so
/// that the answer is brute force's to the last bit, whatever the order of the rows.
/// Fails with kInvalidOption on values that are not finite (or above 1e38, where sums overflow) and
/// on sizes that do not fit. An empty set is fine, and so is dimension 0, where all distances are
/// 0. Holds the rows twice, and at most 19 values and some 20 bytes a row. O(n log n) to build.
Result<std::unique_ptr<VectorIndex>> makeFlannIndex(VectorSet set, std::size_t shard_rows = 100000);

}  // namespace moduli
