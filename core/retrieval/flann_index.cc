// The one place that knows FLANN. Its traps are fenced here: empty sets and k > n never reach it,
// values are checked to be finite, its pointers into our rows live as long as it does, and it runs
// in double precision on float32 rows because in float its own pruning can lose a neighbour.
#include <flann/algorithms/kdtree_single_index.h>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <string>

#include "core/base/parallel.h"
#include "core/retrieval/checks.h"
#include "core/retrieval/nearest_set.h"
#include "core/retrieval/squared_distance.h"
#include "core/retrieval/vector_index.h"

namespace moduli {
namespace {

// FLANN's distance policy: float32 rows, double arithmetic.
struct DoubleL2 {
  using is_kdtree_distance = bool;
  using ElementType = float;
  using ResultType = double;

  double operator()(const float* a, const float* b, std::size_t size, double limit) const {
    return squaredDistance(a, b, size, limit);
  }
  double accum_dist(double a, double b, int) const { return (a - b) * (a - b); }
};

using Tree = flann::KDTreeSingleIndex<DoubleL2>;

// What FLANN fills: the k nearest accepted rows of one shard. FLANN prunes by adding and
// subtracting squares along a path of at most n <= 2^31 nodes; over 1e5 of them the lower bound is
// off by less than 1e5 * 4 * 2^-53 = 4e-11 relative, so a slack of 1e-9 on the worst distance keeps
// every row that may belong to the answer, ties included; `nearest` then decides exactly.
class AcceptedNearest final : public flann::ResultSet<double> {
 public:
  AcceptedNearest(Context& context, const std::vector<std::int64_t>& ids, std::size_t first_row,
                  std::size_t k, std::size_t rows, const std::function<bool(std::int64_t)>& accept)
      : context_(context), ids_(ids), first_row_(first_row), accept_(accept), nearest_(k, rows) {}

  bool full() const override { return nearest_.full(); }

  void addPoint(double squared, std::size_t index) override {
    const Neighbor neighbor{ids_[first_row_ + index], std::sqrt(squared)};
    if (nearest_.wants(neighbor) && (!accept_ || accept_(neighbor.id))) nearest_.add(neighbor);
  }

  // Asked once per leaf, which makes it the place to look whether to go on.
  double worstDist() const override {
    if (++asked_ % 256 == 0 && status_.ok()) status_ = context_.check();
    if (!status_.ok()) return -1;
    if (!nearest_.full()) return std::numeric_limits<double>::max();
    const double worst = nearest_.worst().distance;
    return std::nextafter(worst * worst * (1 + 1e-9), std::numeric_limits<double>::max());
  }

  const Status& status() const { return status_; }
  std::vector<Neighbor> take() { return nearest_.take(); }

 private:
  Context& context_;
  const std::vector<std::int64_t>& ids_;
  const std::size_t first_row_;
  const std::function<bool(std::int64_t)>& accept_;
  NearestSet nearest_;
  mutable std::size_t asked_ = 0;
  mutable Status status_;
};

struct Shard {
  std::size_t first_row = 0;
  std::size_t rows = 0;
  std::unique_ptr<Tree> tree;
};

class FlannIndex final : public VectorIndex {
 public:
  FlannIndex(VectorSet set, std::size_t shard_rows) : set_(std::move(set)) {
    const std::size_t count = set_.ids.size();
    for (std::size_t first = 0; first < count; first += shard_rows) {
      shards_.push_back({first, std::min(shard_rows, count - first), nullptr});
    }
  }

  Status build() {
    std::vector<Status> outcomes(shards_.size());
    parallelBlocks(shards_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) outcomes[i] = buildShard(shards_[i]);
    });
    for (const Status& outcome : outcomes) RETURN_IF_ERROR(outcome);
    return {};
  }

  Result<std::vector<Neighbor>> search(
      Context& context, std::span<const float> query, std::size_t k,
      const std::function<bool(std::int64_t)>& accept) const override {
    RETURN_IF_ERROR(checkQuery(query, set_.dimension, k));
    RETURN_IF_ERROR(context.check());
    std::vector<std::vector<Neighbor>> found(shards_.size());
    std::vector<Status> outcomes(shards_.size());
    parallelBlocks(shards_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        AcceptedNearest nearest(context, set_.ids, shards_[i].first_row, k, shards_[i].rows,
                                accept);
        outcomes[i] = searchShard(shards_[i], query, nearest);
        found[i] = nearest.take();
      }
    });
    for (const Status& outcome : outcomes) RETURN_IF_ERROR(outcome);
    if (found.size() == 1) return std::move(found.front());
    return merge(found, k);
  }

  const VectorSet& rows() const override { return set_; }
  bool exact() const override { return true; }

 private:
  Status buildShard(Shard& shard) {
    try {
      // FLANN takes a mutable pointer but writes only to its own copy.
      float* values = set_.values.data() + shard.first_row * set_.dimension;
      const flann::Matrix<float> matrix(values, shard.rows, set_.dimension);
      shard.tree = std::make_unique<Tree>(matrix, flann::KDTreeSingleIndexParams(16, true));
      shard.tree->buildIndex();
      return {};
    } catch (const std::exception& error) {
      return {Reason::kInternal, std::string("the index cannot be built: ") + error.what()};
    }
  }

  Status searchShard(const Shard& shard, std::span<const float> query,
                     AcceptedNearest& nearest) const {
    try {
      shard.tree->findNeighbors(nearest, query.data(), flann::SearchParams());
      return nearest.status();
    } catch (const std::exception& error) {
      return {Reason::kInternal, std::string("the index cannot be searched: ") + error.what()};
    }
  }

  static std::vector<Neighbor> merge(const std::vector<std::vector<Neighbor>>& found,
                                     std::size_t k) {
    std::vector<Neighbor> all;
    for (const std::vector<Neighbor>& part : found) all.insert(all.end(), part.begin(), part.end());
    const std::size_t kept = std::min(k, all.size());
    std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(kept), all.end(),
                      nearer);
    all.resize(kept);
    return all;
  }

  VectorSet set_;
  std::vector<Shard> shards_;
};

}  // namespace

Result<std::unique_ptr<VectorIndex>> makeFlannIndex(VectorSet set, std::size_t shard_rows) {
  RETURN_IF_ERROR(checkVectorSet(set));
  if (shard_rows == 0 || shard_rows > 1'000'000'000) {
    return Status(Reason::kInvalidOption, "a shard holds from 1 to 1e9 rows");
  }
  // FLANN crashes on empty sets and on rows without columns.
  if (set.ids.empty() || set.dimension == 0) return makeBruteForceIndex(std::move(set));
  auto index = std::make_unique<FlannIndex>(std::move(set), shard_rows);
  RETURN_IF_ERROR(index->build());
  return std::unique_ptr<VectorIndex>(std::move(index));
}

}  // namespace moduli
