#pragma once

#include <cstddef>
#include <memory>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/retrieval/vector_index.h"

namespace moduli {

struct ApproximateOptions {
  double wanted_recall = 0.99;  ///< Of the ten nearest; in (0, 1], where 1 makes an exact index.
};

/// Share of the true ten nearest that were found, over queries that the index had not seen.
struct MeasuredRecall {
  double recall = 1;
  double standard_error = 0;
  std::size_t queries = 0;  ///< 0: the index is exact.
  std::size_t tiles = 0;    ///< That a search looks at: of up to 256 rows each.
};

/// A vector index that may leave out neighbours, and knows how many. Those it gives have their
/// exact distances.
class ApproximateIndex : public VectorIndex {
 public:
  /// For ten neighbours and no filter; for more, a search looks at more tiles in proportion.
  virtual const MeasuredRecall& recall() const = 0;
};

/// Looks at the few tiles of neighbouring rows that lie nearest in the leading principal
/// coordinates. Every so many rows are held out while it is built, and searched for in more and
/// more tiles until the recall against exact answers exceeds the wanted one by two standard errors;
/// they are searched one by one afterwards. Fewer than 4000 rows are searched exactly. The same
/// rows (distinct ids) give the same index in whatever order they come. Fails as makeFlannIndex,
/// with kInvalidOption on a recall outside (0, 1], and with kCancelled / kDeadlineExceeded. Holds
/// the rows, and at most 19 values and two numbers a row. O(n log n) to build.
///
/// FLANN's tree of k-means clusters is not used: measured at 1e6 signatures, recall 0.995, it takes
/// 2.9 times as long in dimension 32, 1.9 in 64 (1.4 where families overlap widely), two to four
/// times as long to build, and draws random numbers that nobody can repeat.
Result<std::unique_ptr<ApproximateIndex>> makeApproximateIndex(
    Context& context, VectorSet set, const ApproximateOptions& options = {});

}  // namespace moduli
