#include "core/retrieval/vector_index.h"

#include "core/base/parallel.h"
#include "core/retrieval/checks.h"

namespace moduli {

Result<std::vector<std::vector<Neighbor>>> VectorIndex::searchMany(
    Context& context, std::span<const std::vector<float>> queries, std::size_t k,
    const std::function<bool(std::int64_t)>& accept) const {
  RETURN_IF_ERROR(checkQueries(queries, dimension(), k));
  RETURN_IF_ERROR(context.check());
  std::vector<std::vector<Neighbor>> found(queries.size());
  std::vector<Status> outcomes(queries.size());
  parallelBlocks(queries.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) {
      auto answer = search(context, queries[q], k, accept);
      outcomes[q] = answer.status();
      if (answer.ok()) found[q] = *std::move(answer);
    }
  });
  for (const Status& outcome : outcomes) RETURN_IF_ERROR(outcome);
  return found;
}

}  // namespace moduli
