#include "server/store/live_base.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/parallel.h"
#include "core/retrieval/approximate_index.h"
#include "core/retrieval/checks.h"
#include "core/retrieval/nearest_set.h"
#include "core/retrieval/squared_distance.h"

namespace moduli {
namespace {

VectorSet sorted(const VectorSet& set) {
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

}  // namespace

Result<std::shared_ptr<LiveBase>> LiveBase::build(VectorSet set,
                                                  const std::optional<double>& wanted_recall) {
  RETURN_IF_ERROR(checkVectorSet(set));
  if (!std::is_sorted(set.ids.begin(), set.ids.end())) set = sorted(set);
  set.values.shrink_to_fit();
  set.ids.shrink_to_fit();
  auto base = std::make_shared<LiveBase>();
  base->wanted_recall_ = wanted_recall;
  if (wanted_recall) {
    Context context;
    ASSIGN_OR_RETURN(auto index, makeApproximateIndex(context, std::move(set),
                                                      {.wanted_recall = *wanted_recall}));
    if (!index->exact()) base->recall_ = index->recall().recall;
    base->index_ = std::move(index);
  } else {
    ASSIGN_OR_RETURN(base->index_, makeFlannIndex(std::move(set)));
  }
  base->removed_at_ = std::make_unique<RemovedAt[]>(base->size());
  return base;
}

std::optional<std::size_t> LiveBase::positionOf(std::int64_t id) const {
  const std::vector<std::int64_t>& ids = rows().ids;
  const auto found = std::lower_bound(ids.begin(), ids.end(), id);
  if (found == ids.end() || *found != id) return std::nullopt;
  return static_cast<std::size_t>(found - ids.begin());
}

RemovedAt* LiveBase::markOf(std::int64_t id) {
  const auto position = positionOf(id);
  if (!position) return nullptr;
  any_removed_.store(true, std::memory_order_release);
  return &removed_at_[*position];
}

std::size_t LiveBase::removedBy(std::uint64_t version) const {
  if (!anyRemoved()) return 0;
  return static_cast<std::size_t>(
      std::count_if(removed_at_.get(), removed_at_.get() + size(),
                    [&](const RemovedAt& mark) { return !showsAt(version, mark); }));
}

LiveBase::Accept LiveBase::shown(const Accept& accept, std::uint64_t version) const {
  if (!anyRemoved()) return accept;
  return [this, &accept, version](std::int64_t id) {
    return showsAt(version, removed_at_[*positionOf(id)]) && (!accept || accept(id));
  };
}

Result<NearestRows> LiveBase::search(Context& context, std::span<const float> query, std::size_t k,
                                     const Accept& accept, std::uint64_t version) const {
  if (asksAll(accept)) {
    ASSIGN_OR_RETURN(std::vector<Neighbor> found, scan(context, query, k, accept, version));
    return NearestRows{std::move(found), {}};
  }
  ASSIGN_OR_RETURN(std::vector<Neighbor> found,
                   index_->search(context, query, k, shown(accept, version)));
  return trusted(context, query, k, version, std::move(found));
}

Result<std::vector<NearestRows>> LiveBase::searchMany(Context& context,
                                                      std::span<const std::vector<float>> queries,
                                                      std::size_t k, const Accept& accept,
                                                      std::uint64_t version) const {
  std::vector<NearestRows> answers;
  answers.reserve(queries.size());
  if (asksAll(accept)) {
    for (const std::vector<float>& query : queries) {
      ASSIGN_OR_RETURN(NearestRows answer, search(context, query, k, accept, version));
      answers.push_back(std::move(answer));
    }
    return answers;
  }
  ASSIGN_OR_RETURN(std::vector<std::vector<Neighbor>> found,
                   index_->searchMany(context, queries, k, shown(accept, version)));
  for (std::size_t q = 0; q < queries.size(); ++q) {
    ASSIGN_OR_RETURN(NearestRows answer,
                     trusted(context, queries[q], k, version, std::move(found[q])));
    answers.push_back(std::move(answer));
  }
  return answers;
}

// Without an `accept` of the caller's.
Result<NearestRows> LiveBase::trusted(Context& context, std::span<const float> query, std::size_t k,
                                      std::uint64_t version, std::vector<Neighbor> found) const {
  if (!recall_) return NearestRows{std::move(found), {}};
  if (found.size() >= std::min(k, size())) return NearestRows{std::move(found), recall_};
  ASSIGN_OR_RETURN(std::vector<Neighbor> all, scan(context, query, k, {}, version));
  return NearestRows{std::move(all), {}};
}

Result<std::vector<Neighbor>> LiveBase::scan(Context& context, std::span<const float> query,
                                             std::size_t k, const Accept& accept,
                                             std::uint64_t version) const {
  constexpr std::size_t kBlock = 4096;
  const VectorSet& set = rows();
  RETURN_IF_ERROR(checkQuery(query, set.dimension, k));
  std::vector<std::vector<Neighbor>> parts((set.ids.size() + kBlock - 1) / kBlock);
  parallelBlocks(set.ids.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    if (!context.check().ok()) return;
    NearestSet nearest(k, end - begin);
    for (std::size_t row = begin; row < end; ++row) {
      const std::int64_t id = set.ids[row];
      if (!showsAt(version, removed_at_[row]) || (accept && !accept(id))) continue;
      const float* values = set.values.data() + row * set.dimension;
      const Neighbor neighbor{id, std::sqrt(squaredDistance(query.data(), values, set.dimension))};
      if (nearest.wants(neighbor)) nearest.add(neighbor);
    }
    parts[begin / kBlock] = nearest.take();
  });
  RETURN_IF_ERROR(context.check());
  NearestSet merged(k, set.ids.size());
  for (const std::vector<Neighbor>& part : parts) {
    for (const Neighbor& neighbor : part) {
      if (merged.wants(neighbor)) merged.add(neighbor);
    }
  }
  return merged.take();
}

}  // namespace moduli
