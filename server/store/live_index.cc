#include "server/store/live_index.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>
#include <thread>
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
// An index this many times as large as what is to be folded in stays as it is.
constexpr std::size_t kMuchLarger = 4;
constexpr int kLowestPriority = 19;
constexpr int kLongestWait = 10000;  // Milliseconds.

// On a thread of its own; the threads that it starts inherit the priority. Where that cannot be
// had, searches are slower meanwhile.
void atLowestPriority(const std::function<void()>& work) {
  std::thread([&] {
    (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kLowestPriority);
    work();
  }).join();
}

}  // namespace

/// An immutable part: FLANN over rows by ascending id.
struct LiveIndex::Base {
  std::unique_ptr<VectorIndex> index;
  std::unique_ptr<RemovedAt[]> removed_at;
  std::atomic<bool> any_removed{false};

  const std::vector<std::int64_t>& ids() const { return index->rows().ids; }
  std::size_t size() const { return ids().size(); }

  std::optional<std::size_t> positionOf(std::int64_t id) const {
    const auto found = std::lower_bound(ids().begin(), ids().end(), id);
    if (found == ids().end() || *found != id) return std::nullopt;
    return static_cast<std::size_t>(found - ids().begin());
  }

  std::size_t removedBy(std::uint64_t version) const {
    return static_cast<std::size_t>(
        std::count_if(removed_at.get(), removed_at.get() + size(), [&](const RemovedAt& mark) {
          const std::uint64_t at = mark.load(std::memory_order_acquire);
          return at != 0 && at <= version;
        }));
  }

  static Result<std::shared_ptr<Base>> build(VectorSet set) {
    RETURN_IF_ERROR(checkVectorSet(set));
    if (!std::is_sorted(set.ids.begin(), set.ids.end())) set = sorted(set);
    set.values.shrink_to_fit();
    set.ids.shrink_to_fit();
    auto base = std::make_shared<Base>();
    ASSIGN_OR_RETURN(base->index, makeFlannIndex(std::move(set)));
    base->removed_at = std::make_unique<RemovedAt[]>(base->size());
    return base;
  }

 private:
  static VectorSet sorted(const VectorSet& set) {
    std::vector<std::size_t> order(set.ids.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return set.ids[a] < set.ids[b]; });
    VectorSet result{set.dimension, {}, {}};
    result.values.reserve(set.values.size());
    result.ids.reserve(set.ids.size());
    for (const std::size_t row : order) {
      result.ids.push_back(set.ids[row]);
      const auto begin = set.values.begin() + static_cast<std::ptrdiff_t>(row * set.dimension);
      result.values.insert(result.values.end(), begin,
                           begin + static_cast<std::ptrdiff_t>(set.dimension));
    }
    return result;
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
  std::vector<std::shared_ptr<Base>> bases;  ///< The largest first.
  std::vector<std::shared_ptr<Chunk>> chunks;
  std::size_t tail_count = 0;
  std::size_t removed_count = 0;  ///< Rows in base and tail that are marked.
  std::uint64_t version = 0;

  bool shows(const RemovedAt& removed_at) const {
    const std::uint64_t at = removed_at.load(std::memory_order_acquire);
    return at == 0 || at > version;
  }
  std::size_t rowCount() const {
    std::size_t count = tail_count;
    for (const auto& base : bases) count += base->size();
    return count;
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
  ASSIGN_OR_RETURN(auto base, Base::build(std::move(set)));
  if (base->size() > 0) state->bases.push_back(std::move(base));
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
  } else {
    for (const std::shared_ptr<Base>& base : state.bases) {
      const auto position = base->positionOf(id);
      if (!position) continue;
      removed_at = &base->removed_at[*position];
      base->any_removed.store(true, std::memory_order_release);
      break;
    }
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
  NearestSet nearest(k, now->rowCount());
  for (const std::shared_ptr<Base>& base : now->bases) {
    std::function<bool(std::int64_t)> shown = accept;
    if (base->any_removed.load(std::memory_order_acquire)) {
      shown = [&](std::int64_t id) {
        return now->shows(base->removed_at[*base->positionOf(id)]) && (!accept || accept(id));
      };
    }
    ASSIGN_OR_RETURN(const std::vector<Neighbor> found,
                     base->index->search(context, query, k, shown));
    for (const Neighbor& neighbor : found) {
      if (nearest.wants(neighbor)) nearest.add(neighbor);
    }
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
  return now->tail_count > options_.rebuild_minimum || removedDue(*now);
}

bool LiveIndex::removedDue(const State& state) const {
  const double share = options_.rebuild_fraction * static_cast<double>(state.rowCount());
  return state.removed_count > options_.rebuild_minimum &&
         static_cast<double>(state.removed_count) > share;
}

/// What goes into a new base.
struct LiveIndex::Merge {
  std::size_t kept_bases = 0;  ///< The first so many stay as they are.
  VectorSet present;
  /// Marks of those rows, to carry over what is removed meanwhile.
  std::vector<std::pair<std::int64_t, const RemovedAt*>> marks;
};

LiveIndex::Merge LiveIndex::takeForMerge(const State& before) const {
  Merge merge{before.bases.size(), {dimension_, {}, {}}, {}};
  std::size_t count = before.tail_count;
  const bool all = removedDue(before);
  while (merge.kept_bases > 0) {
    const std::size_t size = before.bases[merge.kept_bases - 1]->size();
    if (!all && size > kMuchLarger * count) break;
    count += size;
    --merge.kept_bases;
  }
  merge.present.values.reserve(count * dimension_);
  merge.present.ids.reserve(count);
  merge.marks.reserve(count);
  const auto take = [&](std::int64_t id, std::span<const float> values,
                        const RemovedAt& removed_at) {
    if (!before.shows(removed_at)) return;
    merge.present.ids.push_back(id);
    merge.present.values.insert(merge.present.values.end(), values.begin(), values.end());
    merge.marks.emplace_back(id, &removed_at);
  };
  for (std::size_t b = merge.kept_bases; b < before.bases.size(); ++b) {
    const Base& old = *before.bases[b];
    const std::span<const float> rows(old.index->rows().values);
    for (std::size_t i = 0; i < old.size(); ++i) {
      take(old.ids()[i], rows.subspan(i * dimension_, dimension_), old.removed_at[i]);
    }
  }
  before.forTail(0, dimension_, take);
  return merge;
}

Status LiveIndex::rebuild() {
  const std::unique_lock only_one(rebuild_mutex_, std::try_to_lock);
  if (!only_one.owns_lock()) return {};
  std::shared_ptr<const State> before = state();
  Merge merge;
  std::optional<Result<std::shared_ptr<Base>>> built;
  // Only what holds no lock: who waits for a lock must not wait for the lowest priority.
  atLowestPriority([&] {
    merge = takeForMerge(*before);
    built = Base::build(std::move(merge.present));
  });
  ASSIGN_OR_RETURN(std::shared_ptr<Base> base, *std::move(built));
  {
    const std::lock_guard lock(write_mutex_);
    const std::shared_ptr<const State> now = state();
    auto next = std::make_shared<State>();
    next->bases.assign(now->bases.begin(),
                       now->bases.begin() + static_cast<std::ptrdiff_t>(merge.kept_bases));
    if (base->size() > 0) next->bases.push_back(std::move(base));
    next->version = now->version;
    for (const std::shared_ptr<Base>& kept : next->bases) {
      if (kept->any_removed) next->removed_count += kept->removedBy(next->version);
    }
    tail_position_.clear();
    now->forTail(before->tail_count, dimension_,
                 [&](std::int64_t id, std::span<const float> values, const RemovedAt& removed_at) {
                   appendRow(*next, id, values);
                   merge.marks.emplace_back(id, &removed_at);
                 });
    for (const auto& [id, removed_at] : merge.marks) {
      const std::uint64_t at = removed_at->load(std::memory_order_acquire);
      if (at != 0 && markRemoved(*next, id, at)) ++next->removed_count;
    }
    publish(std::move(next));
  }
  // The last searches of the old bases would have to free them: wait until they are done.
  std::vector<std::shared_ptr<Base>> dropped(
      before->bases.begin() + static_cast<std::ptrdiff_t>(merge.kept_bases), before->bases.end());
  before.reset();
  for (int wait = 0; wait < kLongestWait; ++wait) {
    if (std::all_of(dropped.begin(), dropped.end(),
                    [](const std::shared_ptr<Base>& old) { return old.use_count() == 1; })) {
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return {};
}

std::size_t LiveIndex::size() const {
  const std::shared_ptr<const State> now = state();
  return now->rowCount() - now->removed_count;
}

}  // namespace moduli
