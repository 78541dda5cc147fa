// Exact search. FLANN's k-d trees over rows turned to their principal axes rule out most rows of
// most queries; where they do not, a scan of the first few coordinates has a bounded cost. Both
// only pick candidates: ExactNearest measures them by the caller's own rows.
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numeric>
#include <optional>
#include <thread>

#include "core/base/parallel.h"
#include "core/retrieval/checks.h"
#include "core/retrieval/exact_nearest.h"
#include "core/retrieval/flann_trees.h"
#include "core/retrieval/lead_rows.h"
#include "core/retrieval/lead_tiles.h"
#include "core/retrieval/principal_axes.h"
#include "core/retrieval/vector_index.h"

namespace moduli {
namespace {

using Accept = std::function<bool(std::int64_t)>;
using Neighbors = std::vector<Neighbor>;

// Queries that one pass over the rows answers together.
constexpr std::size_t kGroup = 64;
// At least that each core scans.
constexpr std::size_t kShareRows = 50000;
// What a tree may ask for one query before a scan is cheaper (measured at 1e5 and 1e6 rows): a
// third of a millisecond. Queries near known rows are answered by then.
constexpr std::size_t kQuestions = 1000;
// Enough for a good first bound.
constexpr std::size_t kFewTiles = 4;

// A tree over a part of the tiles.
struct Shard {
  const LeadTiles::Part* part = nullptr;
  std::optional<KdTree> tree;
};

// Between a tree and the candidates of one query. Ends the search when cancelled, or when the tree
// has asked more than `questions`.
class ShardVisitor final : public TreeVisitor {
 public:
  ShardVisitor(Context& context, std::span<const std::uint32_t> order, std::size_t questions,
               ExactNearest& nearest)
      : context_(context), order_(order), questions_(questions), nearest_(nearest) {}

  void enter(const Shard& shard) { first_ = shard.part->first; }
  bool gaveUp() const { return asked_ > questions_; }
  const Status& status() const { return status_; }

  double limit() override {
    if (++asked_ % 64 == 0 && status_.ok()) status_ = context_.check();
    return !status_.ok() || gaveUp() ? -1 : nearest_.limit();
  }
  void offer(std::size_t row) override { nearest_.offer(order_[first_ + row]); }

 private:
  Context& context_;
  const std::span<const std::uint32_t> order_;
  const std::size_t questions_;
  ExactNearest& nearest_;
  std::size_t first_ = 0;
  std::size_t asked_ = 0;
  Status status_;
};

std::vector<std::uint32_t> allRows(const VectorSet& set) {
  std::vector<std::uint32_t> rows(set.ids.size());
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

class FlannIndex final : public VectorIndex {
 public:
  FlannIndex(VectorSet set, std::size_t shard_rows)
      : set_(std::move(set)),
        axes_(set_, allRows(set_)),
        leads_(set_, axes_, allRows(set_), LeadRows::few(set_.dimension)),
        tiles_(leads_, shard_rows) {
    leads_.forgetRows();
  }

  Status build() {
    for (const LeadTiles::Part& part : tiles_.parts()) shards_.push_back({&part, {}});
    std::vector<Status> outcomes(shards_.size());
    parallelBlocks(shards_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) outcomes[i] = buildShard(shards_[i]);
    });
    for (const Status& outcome : outcomes) RETURN_IF_ERROR(outcome);
    return {};
  }

  Result<Neighbors> search(Context& context, std::span<const float> query, std::size_t k,
                           const Accept& accept) const override {
    RETURN_IF_ERROR(checkQuery(query, set_.dimension, k));
    RETURN_IF_ERROR(context.check());
    std::optional<std::vector<float>> values = axes_.turn(query);
    if (!values) return searchFar(context, query, k, accept);
    const Turned turned = this->turned(query, *std::move(values));
    ExactNearest nearest = candidates(turned, k, accept);
    ShardVisitor visitor(context, tiles_.order(), kQuestions, nearest);
    RETURN_IF_ERROR(searchTrees(turned, nearest, visitor));
    if (!visitor.gaveUp()) return nearest.take();
    return scanOne(context, turned, k, accept, nearest.worst());
  }

  Result<std::vector<Neighbors>> searchMany(Context& context,
                                            std::span<const std::vector<float>> queries,
                                            std::size_t k, const Accept& accept) const override {
    RETURN_IF_ERROR(checkQueries(queries, set_.dimension, k));
    RETURN_IF_ERROR(context.check());
    std::vector<Neighbors> found(queries.size());
    std::vector<Status> outcomes((queries.size() + kGroup - 1) / kGroup);
    parallelBlocks(queries.size(), kGroup, [&](std::size_t begin, std::size_t end) {
      outcomes[begin / kGroup] = scanGroup(context, queries.subspan(begin, end - begin), k, accept,
                                           std::span(found).subspan(begin, end - begin));
    });
    for (const Status& outcome : outcomes) RETURN_IF_ERROR(outcome);
    return found;
  }

  const VectorSet& rows() const override { return set_; }
  bool exact() const override { return true; }

 private:
  Status buildShard(Shard& shard) {
    const std::size_t first = shard.part->first, rows = shard.part->rows;
    std::vector<float> turned(rows * set_.dimension);
    axes_.turnRows(set_, std::span(tiles_.order()).subspan(first, rows), turned.data());
    ASSIGN_OR_RETURN(shard.tree, KdTree::build(turned.data(), rows, set_.dimension));
    return {};
  }

  /// A query as the trees and the scan want it.
  struct Turned {
    std::span<const float> query;
    std::vector<float> values;
    LeadTiles::Query lead;
    double norm = 0;
  };

  Turned turned(std::span<const float> query, std::vector<float> values) const {
    double squared = 0;
    for (const float value : values) squared += static_cast<double>(value) * value;
    LeadTiles::Query lead = LeadTiles::query(leads_.leadOf(values));
    return {query, std::move(values), std::move(lead), std::sqrt(squared)};
  }

  // cap: no row farther than that is wanted.
  ExactNearest candidates(const Turned& turned, std::size_t k, const Accept& accept,
                          double cap = std::numeric_limits<double>::infinity()) const {
    return ExactNearest(set_, turned.query, k, accept, axes_.scale(),
                        PrincipalAxes::slack(turned.norm), cap);
  }

  // The trees, nearest shard first.
  Status searchTrees(const Turned& turned, const ExactNearest& nearest,
                     ShardVisitor& visitor) const {
    std::vector<std::pair<double, const Shard*>> by_distance;
    for (const Shard& shard : shards_) {
      by_distance.emplace_back(shard.part->squaredDistance(turned.lead.lead), &shard);
    }
    std::sort(by_distance.begin(), by_distance.end());
    for (const auto& [squared, shard] : by_distance) {
      // The last digits of the box's distance are within the slack of the limit.
      if (squared > nearest.limit()) break;
      visitor.enter(*shard);
      shard->tree->search(turned.values.data(), visitor);
      RETURN_IF_ERROR(visitor.status());
      if (visitor.gaveUp()) break;
    }
    return {};
  }

  // All tiles, on all cores. cap: no row farther than that is wanted.
  Result<Neighbors> scanOne(Context& context, const Turned& turned, std::size_t k,
                            const Accept& accept, double cap) const {
    const std::size_t shares = std::clamp<std::size_t>(
        set_.ids.size() / kShareRows, 1, std::max(1U, std::thread::hardware_concurrency()));
    std::vector<Neighbors> found(shares);
    std::vector<Status> outcomes(shares);
    parallelBlocks(shares, 1, [&](std::size_t share, std::size_t) {
      ExactNearest nearest = candidates(turned, k, accept, cap);
      outcomes[share] =
          tiles_.scan(context, turned.lead, nearest, static_cast<std::size_t>(-1), share, shares);
      found[share] = nearest.take();
    });
    for (const Status& outcome : outcomes) RETURN_IF_ERROR(outcome);
    NearestSet merged(k, set_.ids.size());
    for (const Neighbors& part : found) {
      for (const Neighbor& neighbor : part) {
        if (merged.wants(neighbor)) merged.add(neighbor);
      }
    }
    return merged.take();
  }

  // From so far that float32 does not tell the rows apart any more.
  Result<Neighbors> searchFar(Context& context, std::span<const float> query, std::size_t k,
                              const Accept& accept) const {
    ExactNearest nearest(set_, query, k, accept, 0, 0);
    for (std::size_t row = 0; row < set_.ids.size(); ++row) {
      if (row % 4096 == 0) RETURN_IF_ERROR(context.check());
      nearest.offer(row);
    }
    return nearest.take();
  }

  Status scanGroup(Context& context, std::span<const std::vector<float>> queries, std::size_t k,
                   const Accept& accept, std::span<Neighbors> found) const {
    std::deque<Turned> group;
    std::deque<ExactNearest> nearest;
    std::vector<const LeadTiles::Query*> leads;
    std::vector<ExactNearest*> wanted;
    std::vector<std::size_t> numbers;
    for (std::size_t q = 0; q < queries.size(); ++q) {
      std::optional<std::vector<float>> values = axes_.turn(queries[q]);
      if (!values) {
        ASSIGN_OR_RETURN(found[q], searchFar(context, queries[q], k, accept));
        continue;
      }
      group.push_back(turned(queries[q], *std::move(values)));
      ExactNearest first = candidates(group.back(), k, accept);
      RETURN_IF_ERROR(tiles_.scan(context, group.back().lead, first, kFewTiles));
      nearest.push_back(candidates(group.back(), k, accept, first.worst()));
      leads.push_back(&group.back().lead);
      wanted.push_back(&nearest.back());
      numbers.push_back(q);
    }
    RETURN_IF_ERROR(tiles_.scanTogether(context, leads, wanted));
    for (std::size_t i = 0; i < numbers.size(); ++i) found[numbers[i]] = nearest[i].take();
    return {};
  }

  const VectorSet set_;
  const PrincipalAxes axes_;
  LeadRows leads_;  ///< Without rows once built.
  const LeadTiles tiles_;
  std::vector<Shard> shards_;
};

}  // namespace

Result<std::unique_ptr<VectorIndex>> makeFlannIndex(VectorSet set, std::size_t shard_rows) {
  RETURN_IF_ERROR(checkVectorSet(set));
  if (shard_rows == 0 || shard_rows > 1'000'000'000) {
    return Status(Reason::kInvalidOption, "a shard holds from 1 to 1e9 rows");
  }
  if (set.ids.size() > std::numeric_limits<std::uint32_t>::max()) {
    return Status(Reason::kInvalidOption, "an index holds at most 2^32 - 1 rows");
  }
  // Nothing to turn, and FLANN crashes on empty sets and on rows without columns.
  if (set.ids.empty() || set.dimension == 0) return makeBruteForceIndex(std::move(set));
  auto index = std::make_unique<FlannIndex>(std::move(set), shard_rows);
  RETURN_IF_ERROR(index->build());
  return std::unique_ptr<VectorIndex>(std::move(index));
}

}  // namespace moduli
