#include <cmath>

#include "core/retrieval/checks.h"
#include "core/retrieval/nearest_set.h"
#include "core/retrieval/squared_distance.h"
#include "core/retrieval/vector_index.h"

namespace moduli {
namespace {

class BruteForceIndex final : public VectorIndex {
 public:
  explicit BruteForceIndex(VectorSet set) : set_(std::move(set)) {}

  Result<std::vector<Neighbor>> search(
      Context& context, std::span<const float> query, std::size_t k,
      const std::function<bool(std::int64_t)>& accept) const override {
    RETURN_IF_ERROR(checkQuery(query, set_.dimension, k));
    NearestSet nearest(k, set_.ids.size());
    for (std::size_t row = 0; row < set_.ids.size(); ++row) {
      if (row % 4096 == 0) RETURN_IF_ERROR(context.check());
      const float* values = set_.values.data() + row * set_.dimension;
      const Neighbor neighbor{set_.ids[row],
                              std::sqrt(squaredDistance(query.data(), values, set_.dimension))};
      if (nearest.wants(neighbor) && (!accept || accept(neighbor.id))) nearest.add(neighbor);
    }
    return nearest.take();
  }

  const VectorSet& rows() const override { return set_; }
  bool exact() const override { return true; }

 private:
  const VectorSet set_;
};

}  // namespace

Result<std::unique_ptr<VectorIndex>> makeBruteForceIndex(VectorSet set) {
  RETURN_IF_ERROR(checkVectorSet(set));
  return std::unique_ptr<VectorIndex>(std::make_unique<BruteForceIndex>(std::move(set)));
}

}  // namespace moduli
