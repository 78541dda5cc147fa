#include "server/store/live_index.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "core/retrieval/checks.h"
#include "core/retrieval/nearest_set.h"
#include "core/retrieval/squared_distance.h"

namespace moduli {

// Versions count writes. A row carries the version that removed it (0: none), so that a search on
// an older state still sees it: removal needs no copy of anything.
using RemovedAt = std::atomic<std::uint64_t>;

namespace {

constexpr std::size_t kChunkRows = 1024;

}  // namespace

/// The immutable part: FLANN over positions 0, 1, ... of rows sorted by id.
struct LiveIndex::Base {
  std::vector<std::int64_t> ids;  ///< Ascending.
  std::unique_ptr<VectorIndex> index;
  std::unique_ptr<RemovedAt[]> removed_at;
  std::atomic<bool> any_removed{false};

  std::optional<std::size_t> positionOf(std::int64_t id) const {
    const auto found = std::lower_bound(ids.begin(), ids.end(), id);
    if (found == ids.end() || *found != id) return std::nullopt;
    return static_cast<std::size_t>(found - ids.begin());
  }

  static Result<std::shared_ptr<Base>> build(const VectorSet& set) {
    std::vector<std::size_t> order(set.ids.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return set.ids[a] < set.ids[b]; });
    auto base = std::make_shared<Base>();
    VectorSet sorted{set.dimension, {}, {}};
    sorted.values.reserve(set.values.size());
    for (const std::size_t row : order) {
      base->ids.push_back(set.ids[row]);
      sorted.ids.push_back(static_cast<std::int64_t>(sorted.ids.size()));
      const auto begin = set.values.begin() + static_cast<std::ptrdiff_t>(row * set.dimension);
      sorted.values.insert(sorted.values.end(), begin,
                           begin + static_cast<std::ptrdiff_t>(set.dimension));
    }
    ASSIGN_OR_RETURN(base->index, makeFlannIndex(std::move(sorted)));
    base->removed_at = std::make_unique<RemovedAt[]>(base->ids.size());
    return base;
  }
};

/// Rows of the tail. Slots behind a state's tail_count are written while searches read those
/// before it.
struct LiveIndex::Chunk {
  explicit Chunk(std::size_t dimension) : values(kChunkRows * dimension), ids(kChunkRows) {}
  std::vector<float> values;
  std::vector<std::int64_t> ids;
  std::unique_ptr<RemovedAt[]> removed_at = std::make_unique<RemovedAt[]>(kChunkRows);
};

/// What one search works on.
struct LiveIndex::State {
  std::shared_ptr<Base> base;
  std::vector<std::shared_ptr<Chunk>> chunks;
  std::size_t tail_count = 0;
  std::size_t removed_count = 0;  ///< Rows in base and tail that are marked.
  std::uint64_t version = 0;

  bool shows(const RemovedAt& removed_at) const {
    const std::uint64_t at = removed_at.load(std::memory_order_acquire);
    return at == 0 || at > version;
  }
  /// visit(id, values, removed_at) for every row of the tail from `first` on.
  template <typename Visit>
  void forTail(std::size_t first, std::size_t dimension, const Visit& visit) const {
    for (std::size_t row = first; row < tail_count; ++row) {
      Chunk& chunk = *chunks[row / kChunkRows];
      const std::size_t slot = row % kChunkRows;
      visit(chunk.ids[slot], std::span<const float>(&chunk.values[slot * dimension], dimension),
            chunk.removed_at[slot]);
    }
  }
};

LiveIndex::LiveIndex(std::size_t dimension, const Options& options)
    : dimension_(dimension), options_(options) {}

Result<std::shared_ptr<LiveIndex>> LiveIndex::build(VectorSet set, const Options& options) {
  std::shared_ptr<LiveIndex> index(new LiveIndex(set.dimension, options));
  auto state = std::make_shared<State>();
  ASSIGN_OR_RETURN(state->base, Base::build(set));
  index->publish(std::move(state));
  return index;
}

std::shared_ptr<const LiveIndex::State> LiveIndex::state() const {
  const std::lock_guard lock(state_mutex_);
  return state_;
}

void LiveIndex::publish(std::shared_ptr<const State> state) {
  const std::lock_guard lock(state_mutex_);
  state_.swap(state);
}

void LiveIndex::appendRow(State& state, std::int64_t id, std::span<const float> values) {
  const std::size_t slot = state.tail_count % kChunkRows;
  if (slot == 0) state.chunks.push_back(std::make_shared<Chunk>(dimension_));
  Chunk& chunk = *state.chunks.back();
  std::copy(values.begin(), values.end(),
            chunk.values.begin() + static_cast<std::ptrdiff_t>(slot * dimension_));
  chunk.ids[slot] = id;
  tail_position_[id] = state.tail_count++;
}

bool LiveIndex::markRemoved(const State& state, std::int64_t id, std::uint64_t version) {
  RemovedAt* removed_at = nullptr;
  if (const auto found = tail_position_.find(id); found != tail_position_.end()) {
    removed_at = &state.chunks[found->second / kChunkRows]->removed_at[found->second % kChunkRows];
  } else if (const auto position = state.base->positionOf(id)) {
    removed_at = &state.base->removed_at[*position];
    state.base->any_removed.store(true, std::memory_order_release);
  }
  std::uint64_t none = 0;
  return removed_at != nullptr && removed_at->compare_exchange_strong(none, version);
}

Status LiveIndex::apply(const VectorSet& added, std::span<const std::int64_t> removed) {
  RETURN_IF_ERROR(checkVectorSet(added));
  if (!added.ids.empty() && added.dimension != dimension_) {
    return {Reason::kInvalidOption, "rows of dimension " + std::to_string(added.dimension) +
                                        " do not go into an index of dimension " +
                                        std::to_string(dimension_)};
  }
  const std::lock_guard lock(write_mutex_);
  auto next = std::make_shared<State>(*state());
  ++next->version;
  for (const std::int64_t id : removed) {
    if (markRemoved(*next, id, next->version)) ++next->removed_count;
  }
  for (std::size_t row = 0; row < added.ids.size(); ++row) {
    appendRow(*next, added.ids[row], std::span(added.values).subspan(row * dimension_, dimension_));
  }
  publish(std::move(next));
  return {};
}

Result<std::vector<Neighbor>> LiveIndex::search(
    Context& context, std::span<const float> query, std::size_t k,
    const std::function<bool(std::int64_t)>& accept) const {
  RETURN_IF_ERROR(checkQuery(query, dimension_, k));
  const std::shared_ptr<const State> now = state();
  const Base& base = *now->base;
  std::function<bool(std::int64_t)> shown;
  if (accept || base.any_removed.load(std::memory_order_acquire)) {
    shown = [&](std::int64_t position) {
      return now->shows(base.removed_at[position]) && (!accept || accept(base.ids[position]));
    };
  }
  ASSIGN_OR_RETURN(const std::vector<Neighbor> found, base.index->search(context, query, k, shown));
  NearestSet nearest(k, found.size() + now->tail_count);
  for (const Neighbor& neighbor : found) {
    nearest.add({base.ids[neighbor.id], neighbor.distance});
  }
  RETURN_IF_ERROR(context.check());
  now->forTail(0, dimension_,
               [&](std::int64_t id, std::span<const float> values, const RemovedAt& removed_at) {
                 const Neighbor neighbor{
                     id, std::sqrt(squaredDistance(query.data(), values.data(), dimension_))};
                 if (nearest.wants(neighbor) && now->shows(removed_at) && (!accept || accept(id))) {
                   nearest.add(neighbor);
                 }
               });
  return nearest.take();
}

bool LiveIndex::rebuildDue() const {
  const std::shared_ptr<const State> now = state();
  const double share = options_.rebuild_fraction * static_cast<double>(now->base->ids.size());
  const std::size_t loose = now->tail_count + now->removed_count;
  return loose > options_.rebuild_minimum && static_cast<double>(loose) > share;
}

Status LiveIndex::rebuild() {
  const std::unique_lock only_one(rebuild_mutex_, std::try_to_lock);
  if (!only_one.owns_lock()) return {};
  const std::shared_ptr<const State> before = state();
  VectorSet present{dimension_, {}, {}};
  // Marks of the rows that go into the new base, to carry over what is removed meanwhile.
  std::vector<std::pair<std::int64_t, const RemovedAt*>> marks;
  const auto take = [&](std::int64_t id, std::span<const float> values,
                        const RemovedAt& removed_at) {
    if (!before->shows(removed_at)) return;
    present.ids.push_back(id);
    present.values.insert(present.values.end(), values.begin(), values.end());
    marks.emplace_back(id, &removed_at);
  };
  const Base& old = *before->base;
  const std::span<const float> rows(old.index->rows().values);
  for (std::size_t i = 0; i < old.ids.size(); ++i) {
    take(old.ids[i], rows.subspan(i * dimension_, dimension_), old.removed_at[i]);
  }
  before->forTail(0, dimension_, take);
  ASSIGN_OR_RETURN(const std::shared_ptr<Base> base, Base::build(present));

  const std::lock_guard lock(write_mutex_);
  const std::shared_ptr<const State> now = state();
  auto next = std::make_shared<State>();
  next->base = base;
  next->version = now->version;
  tail_position_.clear();
  now->forTail(before->tail_count, dimension_,
               [&](std::int64_t id, std::span<const float> values, const RemovedAt& removed_at) {
                 appendRow(*next, id, values);
                 marks.emplace_back(id, &removed_at);
               });
  for (const auto& [id, removed_at] : marks) {
    const std::uint64_t at = removed_at->load(std::memory_order_acquire);
    if (at != 0 && markRemoved(*next, id, at)) ++next->removed_count;
  }
  publish(std::move(next));
  return {};
}

std::size_t LiveIndex::size() const {
  const std::shared_ptr<const State> now = state();
  return now->base->ids.size() + now->tail_count - now->removed_count;
}

}  // namespace moduli
