#include "server/store/live_index.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <optional>
#include <thread>
#include <utility>

#include "core/base/parallel.h"
#include "core/retrieval/checks.h"
#include "core/retrieval/nearest_set.h"
#include "core/retrieval/squared_distance.h"

namespace moduli {

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
  std::vector<std::shared_ptr<LiveBase>> bases;  ///< The largest first.
  std::vector<std::shared_ptr<Chunk>> chunks;
  std::size_t tail_count = 0;
  std::size_t removed_count = 0;  ///< Rows in base and tail that are marked.
  std::uint64_t version = 0;      ///< Counts writes.

  bool shows(const RemovedAt& removed_at) const { return showsAt(version, removed_at); }
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
    : dimension_(dimension), options_(options), wanted_recall_(options.wanted_recall) {}

Result<std::shared_ptr<LiveIndex>> LiveIndex::build(VectorSet set, const Options& options) {
  std::shared_ptr<LiveIndex> index(new LiveIndex(set.dimension, options));
  auto state = std::make_shared<State>();
  ASSIGN_OR_RETURN(auto base, LiveBase::build(std::move(set), options.wanted_recall));
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
    for (std::size_t b = 0; b < state.bases.size() && removed_at == nullptr; ++b) {
      removed_at = state.bases[b]->markOf(id);
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

// Shows the rows of the tail to the nearest ones found in the bases.
class LiveIndex::Merging {
 public:
  Merging(const State& state, std::size_t dimension, std::span<const float> query, std::size_t k,
          const std::function<bool(std::int64_t)>& accept)
      : state_(state),
        dimension_(dimension),
        query_(query),
        accept_(accept),
        nearest_(k, state.rowCount()) {}

  void add(const NearestRows& found) {
    for (const Neighbor& neighbor : found.neighbors) {
      if (nearest_.wants(neighbor)) nearest_.add(neighbor);
    }
    if (found.recall) recall_ = std::min(recall_.value_or(1), *found.recall);
  }

  NearestRows finish() {
    state_.forTail(
        0, dimension_,
        [&](std::int64_t id, std::span<const float> values, const RemovedAt& removed_at) {
          const Neighbor neighbor{
              id, std::sqrt(squaredDistance(query_.data(), values.data(), dimension_))};
          if (nearest_.wants(neighbor) && state_.shows(removed_at) && (!accept_ || accept_(id))) {
            nearest_.add(neighbor);
          }
        });
    return {nearest_.take(), recall_};
  }

 private:
  const State& state_;
  const std::size_t dimension_;
  const std::span<const float> query_;
  const std::function<bool(std::int64_t)>& accept_;
  NearestSet nearest_;
  std::optional<double> recall_;
};

Result<NearestRows> LiveIndex::search(Context& context, std::span<const float> query, std::size_t k,
                                      const std::function<bool(std::int64_t)>& accept) const {
  RETURN_IF_ERROR(checkQuery(query, dimension_, k));
  const std::shared_ptr<const State> now = state();
  Merging merging(*now, dimension_, query, k, accept);
  for (const std::shared_ptr<LiveBase>& base : now->bases) {
    ASSIGN_OR_RETURN(const NearestRows found,
                     base->search(context, query, k, accept, now->version));
    merging.add(found);
  }
  RETURN_IF_ERROR(context.check());
  return merging.finish();
}

Result<std::vector<NearestRows>> LiveIndex::searchMany(
    Context& context, std::span<const std::vector<float>> queries, std::size_t k,
    const std::function<bool(std::int64_t)>& accept) const {
  RETURN_IF_ERROR(checkQueries(queries, dimension_, k));
  const std::shared_ptr<const State> now = state();
  std::deque<Merging> merging;
  for (const std::vector<float>& query : queries) {
    merging.emplace_back(*now, dimension_, query, k, accept);
  }
  for (const std::shared_ptr<LiveBase>& base : now->bases) {
    ASSIGN_OR_RETURN(const std::vector<NearestRows> found,
                     base->searchMany(context, queries, k, accept, now->version));
    for (std::size_t q = 0; q < queries.size(); ++q) merging[q].add(found[q]);
  }
  RETURN_IF_ERROR(context.check());
  std::vector<NearestRows> answers(queries.size());
  parallelBlocks(queries.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) answers[q] = merging[q].finish();
  });
  return answers;
}

void LiveIndex::setWantedRecall(const std::optional<double>& wanted_recall) {
  const std::lock_guard lock(state_mutex_);
  wanted_recall_ = wanted_recall;
}

std::optional<double> LiveIndex::wantedRecall() const {
  const std::lock_guard lock(state_mutex_);
  return wanted_recall_;
}

std::optional<double> LiveIndex::recall() const {
  std::optional<double> recall;
  const std::shared_ptr<const State> now = state();
  for (const std::shared_ptr<LiveBase>& base : now->bases) {
    if (base->recall()) recall = std::min(recall.value_or(1), *base->recall());
  }
  return recall;
}

bool LiveIndex::rebuildDue() const {
  const std::shared_ptr<const State> now = state();
  return now->tail_count > options_.rebuild_minimum || removedDue(*now) ||
         recallDue(*now, wantedRecall());
}

bool LiveIndex::recallDue(const State& state, const std::optional<double>& wanted_recall) {
  return std::any_of(
      state.bases.begin(), state.bases.end(),
      [&](const std::shared_ptr<LiveBase>& base) { return base->wantedRecall() != wanted_recall; });
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

LiveIndex::Merge LiveIndex::takeForMerge(const State& before,
                                         const std::optional<double>& wanted_recall) const {
  Merge merge{before.bases.size(), {dimension_, {}, {}}, {}};
  std::size_t count = before.tail_count;
  const bool all = removedDue(before) || recallDue(before, wanted_recall);
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
    const LiveBase& old = *before.bases[b];
    const std::span<const float> values(old.rows().values);
    for (std::size_t i = 0; i < old.size(); ++i) {
      take(old.rows().ids[i], values.subspan(i * dimension_, dimension_), old.removedAt(i));
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
  std::optional<Result<std::shared_ptr<LiveBase>>> built;
  // Only what holds no lock: who waits for a lock must not wait for the lowest priority.
  atLowestPriority([&] {
    const std::optional<double> wanted_recall = wantedRecall();
    merge = takeForMerge(*before, wanted_recall);
    built = LiveBase::build(std::move(merge.present), wanted_recall);
  });
  ASSIGN_OR_RETURN(std::shared_ptr<LiveBase> base, *std::move(built));
  {
    const std::lock_guard lock(write_mutex_);
    const std::shared_ptr<const State> now = state();
    auto next = std::make_shared<State>();
    next->bases.assign(now->bases.begin(),
                       now->bases.begin() + static_cast<std::ptrdiff_t>(merge.kept_bases));
    if (base->size() > 0) next->bases.push_back(std::move(base));
    next->version = now->version;
    for (const std::shared_ptr<LiveBase>& kept : next->bases) {
      next->removed_count += kept->removedBy(next->version);
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
  std::vector<std::shared_ptr<LiveBase>> dropped(
      before->bases.begin() + static_cast<std::ptrdiff_t>(merge.kept_bases), before->bases.end());
  before.reset();
  for (int wait = 0; wait < kLongestWait; ++wait) {
    if (std::all_of(dropped.begin(), dropped.end(),
                    [](const std::shared_ptr<LiveBase>& old) { return old.use_count() == 1; })) {
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
