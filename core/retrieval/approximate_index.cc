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
#include "core/retrieval/flann_trees.h"
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
constexpr int kFewestChecks = 32;
constexpr double kMoreChecks = 1.2;

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

// Between the tree and the candidates of one query. Ends the search when cancelled.
class MemberVisitor final : public TreeVisitor {
 public:
  MemberVisitor(Context& context, std::span<const std::uint32_t> members, ExactNearest& nearest)
      : context_(context), members_(members), nearest_(nearest) {}

  const Status& status() const { return status_; }

  double limit() override {
    if (++asked_ % 64 == 0 && status_.ok()) status_ = context_.check();
    return status_.ok() ? nearest_.limit() : -1;
  }
  bool full() const override { return nearest_.full(); }
  void offer(std::size_t row) override { nearest_.offer(members_[row]); }

 private:
  Context& context_;
  const std::span<const std::uint32_t> members_;
  ExactNearest& nearest_;
  std::size_t asked_ = 0;
  Status status_;
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

class KMeansIndex final : public ApproximateIndex {
 public:
  explicit KMeansIndex(VectorSet set)
      : set_(std::move(set)),
        split_(set_),
        axes_(set_, split_.members),
        leads_(set_, axes_, split_.members) {}

  Status build(Context& context, double wanted_recall) {
    RETURN_IF_ERROR(context.check());
    ASSIGN_OR_RETURN(tree_, KMeansTree::build(leads_.row(0), leads_.count(), leads_.columns(),
                                              leads_.columns()));
    return tune(context, wanted_recall);
  }

  Result<Neighbors> search(Context& context, std::span<const float> query, std::size_t k,
                           const Accept& accept) const override {
    RETURN_IF_ERROR(checkQuery(query, set_.dimension, k));
    RETURN_IF_ERROR(context.check());
    const double more = std::max(1.0, static_cast<double>(k) / kNeighbors);
    return search(context, query, k, accept, recall_.checks * more, true);
  }

  const VectorSet& rows() const override { return set_; }
  bool exact() const override { return false; }
  const MeasuredRecall& recall() const override { return recall_; }

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
                           const Accept& accept, double checks, bool whole) const {
    const std::optional<std::vector<float>> turned = axes_.turn(query);
    const double slack = PrincipalAxes::slack(turned ? normOf(*turned) : 0);
    ExactNearest nearest(set_, query, k, accept, turned ? axes_.scale() : 0, slack);
    if (whole) {
      for (const std::uint32_t row : split_.held_out) nearest.offer(row);
    }
    if (!turned) return searchFar(context, nearest);
    MemberVisitor visitor(context, split_.members, nearest);
    const double most = static_cast<double>(leads_.count());
    tree_->search(leads_.leadOf(*turned).data(), static_cast<int>(std::min(checks, most)), visitor);
    RETURN_IF_ERROR(visitor.status());
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

  // ---- Tuning.

  Status tune(Context& context, double wanted_recall) {
    ASSIGN_OR_RETURN(const std::vector<double> truth, farthestOfNearest(context));
    double checks = kFewestChecks;
    for (;; checks *= kMoreChecks) {
      RETURN_IF_ERROR(measure(context, checks, truth));
      const double sure = recall_.recall - kStandardErrors * recall_.standard_error;
      if (sure >= wanted_recall || checks >= static_cast<double>(leads_.count())) return {};
    }
  }

  // Distance of the tenth nearest member from each held out row, up to what its turning rounds.
  Result<std::vector<double>> farthestOfNearest(Context& context) const {
    const LeadTiles tiles(leads_, leads_.count());
    std::vector<double> farthest(split_.held_out.size());
    std::vector<Status> outcomes(farthest.size());
    parallelBlocks(farthest.size(), 1, [&](std::size_t q, std::size_t) {
      const std::span<const float> query = rowOf(split_.held_out[q]);
      const std::optional<std::vector<float>> turned = axes_.turn(query);
      if (!turned) {  // An outlier among the members' distances: not to be judged by.
        farthest[q] = std::numeric_limits<double>::infinity();
        return;
      }
      const Accept all;
      // Tiles number the members.
      ExactNearest nearest(set_, query, kNeighbors, all, axes_.scale(),
                           PrincipalAxes::slack(normOf(*turned)));
      nearest.renumber(split_.members);
      outcomes[q] = tiles.scan(context, LeadTiles::query(leads_.leadOf(*turned)), nearest);
      farthest[q] = nearest.worst();
    });
    for (const Status& outcome : outcomes) RETURN_IF_ERROR(outcome);
    return farthest;
  }

  Status measure(Context& context, double checks, std::span<const double> farthest) {
    std::vector<double> shares(farthest.size());
    std::vector<Status> outcomes(farthest.size());
    parallelBlocks(farthest.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t q = begin; q < end; ++q) {
        const auto found =
            search(context, rowOf(split_.held_out[q]), kNeighbors, {}, checks, false);
        outcomes[q] = found.status();
        if (!found.ok()) continue;
        const auto right = std::count_if(found->begin(), found->end(), [&](const Neighbor& n) {
          return n.distance <= farthest[q];
        });
        shares[q] = static_cast<double>(right) / kNeighbors;
      }
    });
    for (const Status& outcome : outcomes) RETURN_IF_ERROR(outcome);
    const double count = static_cast<double>(shares.size());
    const double mean = std::accumulate(shares.begin(), shares.end(), 0.0) / count;
    double squares = 0;
    for (const double share : shares) squares += (share - mean) * (share - mean);
    recall_ = {mean, std::sqrt(squares / (count - 1) / count), shares.size(),
               static_cast<int>(checks)};
    return {};
  }

  const VectorSet set_;
  const Split split_;
  const PrincipalAxes axes_;
  LeadRows leads_;  ///< Of the members.
  std::optional<KMeansTree> tree_;
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
  auto index = std::make_unique<KMeansIndex>(std::move(set));
  RETURN_IF_ERROR(index->build(context, options.wanted_recall));
  return std::unique_ptr<ApproximateIndex>(std::move(index));
}

}  // namespace moduli
