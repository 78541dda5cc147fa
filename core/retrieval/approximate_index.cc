#include "core/retrieval/approximate_index.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>

#include "core/base/parallel.h"
#include "core/retrieval/checks.h"
#include "core/retrieval/exact_nearest.h"
#include "core/retrieval/lead_rows.h"
#include "core/retrieval/lead_tiles.h"
#include "core/retrieval/principal_axes.h"

namespace moduli {
namespace {

using Accept = std::function<bool(std::int64_t)>;
using Neighbors = std::vector<Neighbor>;

constexpr std::size_t kSmall = 4000;  // Rows that an exact index is as fast for.
constexpr std::size_t kHeldOut = 400;
constexpr std::size_t kNeighbors = 10;
constexpr double kStandardErrors = 2;
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

/// An exact index in the place of an approximate one.
class ExactInstead final : public ApproximateIndex {
 public:
  explicit ExactInstead(std::unique_ptr<VectorIndex> index) : index_(std::move(index)) {}

  Result<Neighbors> search(Context& context, std::span<const float> query, std::size_t k,
                           const Accept& accept) const override {
    return index_->search(context, query, k, accept);
  }
  Result<std::vector<Neighbors>> searchMany(Context& context,
                                            std::span<const std::vector<float>> queries,
                                            std::size_t k, const Accept& accept) const override {
    return index_->searchMany(context, queries, k, accept);
  }
  const VectorSet& rows() const override { return index_->rows(); }
  bool exact() const override { return true; }
  const MeasuredRecall& recall() const override { return recall_; }

 private:
  const std::unique_ptr<VectorIndex> index_;
  const MeasuredRecall recall_;
};

// Rows by ascending id, every so many held out.
struct Split {
  std::vector<std::uint32_t> members, held_out;

  explicit Split(const VectorSet& set) {
    std::vector<std::uint32_t> order(set.ids.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return set.ids[a] < set.ids[b]; });
    const std::size_t step = order.size() / kHeldOut;
    for (std::size_t i = 0; i < order.size(); ++i) {
      (i % step == step / 2 ? held_out : members).push_back(order[i]);
    }
  }
};

class FewTilesIndex final : public ApproximateIndex {
 public:
  explicit FewTilesIndex(VectorSet set)
      : set_(std::move(set)),
        split_(set_),
        axes_(set_, split_.members),
        leads_(set_, axes_, split_.members, LeadRows::few(set_.dimension)),
        tiles_(leads_, split_.members.size()) {
    leads_.forgetRows();
  }

  Result<Neighbors> search(Context& context, std::span<const float> query, std::size_t k,
                           const Accept& accept) const override {
    RETURN_IF_ERROR(checkQuery(query, set_.dimension, k));
    RETURN_IF_ERROR(context.check());
    const std::size_t more = (k + kNeighbors - 1) / kNeighbors;
    return search(context, query, k, accept, recall_.tiles * more, true);
  }

  const VectorSet& rows() const override { return set_; }
  bool exact() const override { return false; }
  const MeasuredRecall& recall() const override { return recall_; }

  /// Looks at more and more tiles until enough is found.
  Status tune(Context& context, double wanted_recall) {
    // All tiles: exact.
    std::vector<double> farthest(split_.held_out.size());
    RETURN_IF_ERROR(forHeldOut(context, kAll, [&](std::size_t q, const Neighbors& found) {
      farthest[q] = found.back().distance;
    }));
    for (std::size_t tiles = 1;; tiles += 1 + tiles / 6) {
      RETURN_IF_ERROR(measure(context, tiles, farthest));
      const double sure = recall_.recall - kStandardErrors * recall_.standard_error;
      if (sure >= wanted_recall || tiles > split_.members.size()) return {};
    }
  }

 private:
  std::span<const float> rowOf(std::size_t row) const {
    return std::span(set_.values).subspan(row * set_.dimension, set_.dimension);
  }

  static double normOf(std::span<const float> values) {
    double squared = 0;
    for (const float value : values) squared += static_cast<double>(value) * value;
    return std::sqrt(squared);
  }

  // whole: held out rows too.
  Result<Neighbors> search(Context& context, std::span<const float> query, std::size_t k,
                           const Accept& accept, std::size_t tiles, bool whole) const {
    const std::optional<std::vector<float>> turned = axes_.turn(query);
    const double slack = PrincipalAxes::slack(turned ? normOf(*turned) : 0);
    ExactNearest nearest(set_, query, k, accept, turned ? axes_.scale() : 0, slack);
    if (whole) {
      for (const std::uint32_t row : split_.held_out) nearest.offer(row);
    }
    if (!turned) return searchFar(context, nearest);
    nearest.renumber(split_.members);
    RETURN_IF_ERROR(tiles_.scan(context, LeadTiles::query(leads_.leadOf(*turned)), nearest, tiles));
    return nearest.take();
  }

  // From so far that float32 does not tell the rows apart any more: all of them.
  Result<Neighbors> searchFar(Context& context, ExactNearest& nearest) const {
    for (std::size_t i = 0; i < split_.members.size(); ++i) {
      if (i % 4096 == 0) RETURN_IF_ERROR(context.check());
      nearest.offer(split_.members[i]);
    }
    return nearest.take();
  }

  // note(q, the ten nearest members of held out row q).
  template <typename Note>
  Status forHeldOut(Context& context, std::size_t tiles, const Note& note) const {
    std::vector<Status> outcomes(split_.held_out.size());
    parallelBlocks(outcomes.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t q = begin; q < end; ++q) {
        const auto found = search(context, rowOf(split_.held_out[q]), kNeighbors, {}, tiles, false);
        outcomes[q] = found.status();
        if (found.ok()) note(q, *found);
      }
    });
    for (const Status& outcome : outcomes) RETURN_IF_ERROR(outcome);
    return {};
  }

  Status measure(Context& context, std::size_t tiles, std::span<const double> farthest) {
    std::vector<double> shares(farthest.size());
    RETURN_IF_ERROR(forHeldOut(context, tiles, [&](std::size_t q, const Neighbors& found) {
      const auto right = std::count_if(found.begin(), found.end(), [&](const Neighbor& neighbor) {
        return neighbor.distance <= farthest[q];
      });
      shares[q] = static_cast<double>(right) / kNeighbors;
    }));
    const double count = static_cast<double>(shares.size());
    const double mean = std::accumulate(shares.begin(), shares.end(), 0.0) / count;
    double squares = 0;
    for (const double share : shares) squares += (share - mean) * (share - mean);
    recall_ = {mean, std::sqrt(squares / (count - 1) / count), shares.size(), tiles};
    return {};
  }

  const VectorSet set_;
  const Split split_;
  const PrincipalAxes axes_;
  LeadRows leads_;         ///< Without rows once built.
  const LeadTiles tiles_;  ///< Of the members.
  MeasuredRecall recall_;
};

}  // namespace

Result<std::unique_ptr<ApproximateIndex>> makeApproximateIndex(Context& context, VectorSet set,
                                                               const ApproximateOptions& options) {
  if (!(options.wanted_recall > 0 && options.wanted_recall <= 1)) {
    return Status(Reason::kInvalidOption, "a recall lies in (0, 1]");
  }
  if (set.ids.size() < kSmall || set.dimension == 0 || options.wanted_recall == 1) {
    ASSIGN_OR_RETURN(auto index, makeFlannIndex(std::move(set)));
    return std::unique_ptr<ApproximateIndex>(std::make_unique<ExactInstead>(std::move(index)));
  }
  RETURN_IF_ERROR(checkVectorSet(set));
  if (set.ids.size() > std::numeric_limits<std::int32_t>::max()) {
    return Status(Reason::kInvalidOption, "an approximate index holds at most 2^31 - 1 rows");
  }
  auto index = std::make_unique<FewTilesIndex>(std::move(set));
  RETURN_IF_ERROR(index->tune(context, options.wanted_recall));
  return std::unique_ptr<ApproximateIndex>(std::move(index));
}

}  // namespace moduli
