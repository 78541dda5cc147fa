#include "server/store/index_keeper.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <set>
#include <shared_mutex>
#include <string>
#include <thread>
#include <tuple>
#include <utility>

#include "core/base/log.h"

namespace moduli {
namespace {

constexpr std::size_t kBatch = 1000;

/// Which vectors stand in one index together.
struct IndexKey {
  std::int64_t collection_id = 0;
  Space space = Space::kConformal;
  std::string type;  ///< Empty but in conformal space.
  std::size_t dimension = 0;

  auto operator<=>(const IndexKey&) const = default;
};

IndexKey makeKey(std::int64_t collection_id, Space space, std::string_view type,
                 std::size_t dimension) {
  return {collection_id, space, std::string(space == Space::kConformal ? type : ""), dimension};
}

/// Rebuilds indexes one after the other on a thread of its own.
class Rebuilder {
 public:
  Rebuilder() : thread_([this] { run(); }) {}

  ~Rebuilder() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    thread_.join();
  }

  void add(std::function<void()> task) {
    {
      const std::lock_guard lock(mutex_);
      queue_.push_back(std::move(task));
    }
    wake_.notify_all();
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    for (;;) {
      wake_.wait(lock, [this] { return stop_ || !queue_.empty(); });
      if (stop_) return;
      const std::function<void()> task = std::move(queue_.front());
      queue_.pop_front();
      lock.unlock();
      task();
      lock.lock();
    }
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> queue_;
  bool stop_ = false;
  std::thread thread_;
};

/// An index, and whether its rebuild has been asked for already.
struct Kept {
  std::shared_ptr<LiveIndex> index;
  std::shared_ptr<std::atomic<bool>> rebuilding = std::make_shared<std::atomic<bool>>(false);
};

/// What one batch of changes does to one index.
struct Delta {
  VectorSet added;
  std::vector<std::int64_t> removed;
};

class CatalogIndexKeeper final : public IndexKeeper {
 public:
  CatalogIndexKeeper(const Catalog& catalog, Options options)
      : catalog_(catalog), options_(std::move(options)) {
    if (!options_.background) rebuilder_ = std::make_unique<Rebuilder>();
  }

  Status readAll(Context& context) {
    std::map<IndexKey, VectorSet> sets;
    ASSIGN_OR_RETURN(const std::int64_t sequence,
                     catalog_.forEachVector(context, [&](const VectorRow& row) {
                       if (row.descriptor_version == options_.descriptor_version) {
                         append(sets[keyOf(row)], row);
                       }
                       return Status();
                     }));
    // After the snapshot: what has changed since comes again with the changes after it.
    ASSIGN_OR_RETURN(const auto recalls, catalog_.wantedRecalls());
    std::map<IndexKey, Kept> kept;
    for (auto& [key, set] : sets) {
      ASSIGN_OR_RETURN(kept[key].index,
                       LiveIndex::build(std::move(set), indexOptions(key, recalls)));
    }
    const std::unique_lock lock(map_mutex_);
    kept_ = std::move(kept);
    sequence_ = sequence;
    return {};
  }

  Status refresh() override {
    const std::lock_guard lock(refresh_mutex_);
    for (;;) {
      ASSIGN_OR_RETURN(const ChangeBatch batch, catalog_.changesSince(sequence_, kBatch));
      if (!batch.complete) {
        Context context;
        return readAll(context);
      }
      if (batch.changes.empty()) return {};
      RETURN_IF_ERROR(takeIn(batch));
      sequence_ = batch.changes.back().sequence;
      if (batch.changes.size() < kBatch) return {};
    }
  }

  Result<NearestRows> search(Context& context, std::int64_t collection_id, Space space,
                             std::string_view type, std::span<const float> query, std::size_t k,
                             const std::function<bool(std::int64_t)>& accept) const override {
    const auto index = find(makeKey(collection_id, space, type, query.size()));
    if (index == nullptr) return NearestRows();
    return index->search(context, query, k, accept);
  }

  Result<std::vector<NearestRows>> searchMany(
      Context& context, std::int64_t collection_id, Space space,
      std::span<const std::vector<float>> queries, std::size_t k,
      const std::function<bool(std::int64_t)>& accept) const override {
    const std::size_t dimension = queries.empty() ? 0 : queries.front().size();
    const auto index = find(makeKey(collection_id, space, "", dimension));
    if (index == nullptr) return std::vector<NearestRows>(queries.size());
    return index->searchMany(context, queries, k, accept);
  }

  std::optional<double> recall(std::int64_t collection_id) const override {
    std::optional<double> worst;
    const std::shared_lock lock(map_mutex_);
    for (const auto& [key, kept] : kept_) {
      if (key.collection_id != collection_id) continue;
      if (const auto recall = kept.index->recall()) worst = std::min(worst.value_or(1), *recall);
    }
    return worst;
  }

  std::size_t size(std::int64_t collection_id, Space space, std::string_view type,
                   std::size_t dimension) const override {
    const auto index = find(makeKey(collection_id, space, type, dimension));
    return index == nullptr ? 0 : index->size();
  }

  std::int64_t sequence() const override { return sequence_; }

 private:
  static IndexKey keyOf(const VectorRow& row) {
    return makeKey(row.collection_id, row.space, row.type, row.values.size());
  }

  static void append(VectorSet& set, const VectorRow& row) {
    set.dimension = row.values.size();
    set.ids.push_back(row.shape_id);
    set.values.insert(set.values.end(), row.values.begin(), row.values.end());
  }

  static std::optional<double> recallOf(const IndexKey& key,
                                        const std::map<std::int64_t, double>& recalls) {
    const auto found = recalls.find(key.collection_id);
    if (key.space == Space::kConformal || found == recalls.end()) return std::nullopt;
    return found->second;
  }

  LiveIndex::Options indexOptions(const IndexKey& key,
                                  const std::map<std::int64_t, double>& recalls) const {
    LiveIndex::Options options = options_.index;
    options.wanted_recall = recallOf(key, recalls);
    return options;
  }

  std::shared_ptr<LiveIndex> find(const IndexKey& key) const {
    const std::shared_lock lock(map_mutex_);
    const auto found = kept_.find(key);
    return found == kept_.end() ? nullptr : found->second.index;
  }

  // Under refresh_mutex_, which alone lets the map change.
  Status takeIn(const ChangeBatch& batch) {
    std::vector<std::int64_t> added;
    std::map<std::int64_t, std::vector<std::int64_t>> removed;  // By collection.
    std::set<std::int64_t> dropped, changed;
    for (const Change& change : batch.changes) {
      if (change.kind == Change::Kind::kShapeAdded) added.push_back(change.shape_id);
      if (change.kind == Change::Kind::kShapeRemoved) {
        removed[change.collection_id].push_back(change.shape_id);
      }
      if (change.kind == Change::Kind::kCollectionRemoved) dropped.insert(change.collection_id);
      if (change.kind == Change::Kind::kCollectionChanged) changed.insert(change.collection_id);
    }
    dropCollections(dropped);
    RETURN_IF_ERROR(takeInRecalls(changed));
    std::map<IndexKey, Delta> deltas;
    // Which of a collection's indexes has a removed shape is not known: each ignores what it lacks.
    for (const auto& [key, kept] : kept_) {
      const auto found = removed.find(key.collection_id);
      if (found != removed.end()) deltas[key].removed = found->second;
    }
    // Shapes that have been removed since are not read any more, which is as well.
    RETURN_IF_ERROR(catalog_.forEachVectorOf(added, [&](const VectorRow& row) {
      if (row.descriptor_version == options_.descriptor_version) {
        append(deltas[keyOf(row)].added, row);
      }
      return Status();
    }));
    for (const auto& [key, delta] : deltas) RETURN_IF_ERROR(apply(key, delta));
    return {};
  }

  Status takeInRecalls(const std::set<std::int64_t>& changed) {
    if (changed.empty()) return {};
    ASSIGN_OR_RETURN(const auto recalls, catalog_.wantedRecalls());
    for (const auto& [key, kept] : kept_) {
      if (!changed.contains(key.collection_id)) continue;
      kept.index->setWantedRecall(recallOf(key, recalls));
      askForRebuild(kept);
    }
    return {};
  }

  void dropCollections(const std::set<std::int64_t>& dropped) {
    if (dropped.empty()) return;
    const std::unique_lock lock(map_mutex_);
    std::erase_if(kept_,
                  [&](const auto& entry) { return dropped.contains(entry.first.collection_id); });
  }

  Status apply(const IndexKey& key, const Delta& delta) {
    auto found = kept_.find(key);
    if (found == kept_.end()) {
      Kept fresh;
      ASSIGN_OR_RETURN(const auto recalls, catalog_.wantedRecalls());
      ASSIGN_OR_RETURN(fresh.index,
                       LiveIndex::build({key.dimension, {}, {}}, indexOptions(key, recalls)));
      const std::unique_lock lock(map_mutex_);
      found = kept_.emplace(key, std::move(fresh)).first;
    }
    RETURN_IF_ERROR(found->second.index->apply(delta.added, delta.removed));
    askForRebuild(found->second);
    return {};
  }

  void askForRebuild(const Kept& kept) {
    if (!kept.index->rebuildDue()) return;
    // With a background of the caller's, which may drop tasks, every write asks again.
    if (rebuilder_ != nullptr && kept.rebuilding->exchange(true)) return;
    const auto task = [index = kept.index, rebuilding = kept.rebuilding] {
      for (;;) {
        const Status status = index->rebuild();
        rebuilding->store(false);
        if (!status.ok()) {
          log(LogLevel::kError, "an index cannot be rebuilt: " + status.toString());
          return;
        }
        // What was asked for meanwhile has been turned away.
        if (!index->rebuildDue() || rebuilding->exchange(true)) return;
      }
    };
    if (rebuilder_ != nullptr) {
      rebuilder_->add(task);
    } else {
      options_.background(task);
    }
  }

  const Catalog& catalog_;
  const Options options_;
  std::mutex refresh_mutex_;
  std::atomic<std::int64_t> sequence_{0};
  mutable std::shared_mutex map_mutex_;
  std::map<IndexKey, Kept> kept_;
  std::unique_ptr<Rebuilder> rebuilder_;
};

}  // namespace

Result<std::unique_ptr<IndexKeeper>> IndexKeeper::open(Context& context, const Catalog& catalog,
                                                       Options options) {
  auto keeper = std::make_unique<CatalogIndexKeeper>(catalog, std::move(options));
  RETURN_IF_ERROR(keeper->readAll(context));
  return std::unique_ptr<IndexKeeper>(std::move(keeper));
}

}  // namespace moduli
