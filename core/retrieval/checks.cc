#include "core/retrieval/checks.h"

#include <cmath>
#include <limits>
#include <string>

namespace moduli {
namespace {

// Half of the largest float32 is 1.7e38: below it the sum of two values stays finite.
constexpr float kLargest = 1e38F;

}  // namespace

Status checkVectorSet(const VectorSet& set) {
  if (set.values.size() != set.ids.size() * set.dimension) {
    return {Reason::kInvalidOption, std::to_string(set.ids.size()) + " rows of dimension " +
                                        std::to_string(set.dimension) + " do not make " +
                                        std::to_string(set.values.size()) + " values"};
  }
  for (std::size_t i = 0; i < set.values.size(); ++i) {
    if (!(std::abs(set.values[i]) <= kLargest)) {
      return {Reason::kInvalidOption, "vector of shape " +
                                          std::to_string(set.ids[i / set.dimension]) +
                                          " has a value that is not finite"};
    }
  }
  return {};
}

Status checkQuery(std::span<const float> query, std::size_t dimension, std::size_t k) {
  if (k == 0) return {Reason::kInvalidOption, "at least one neighbour has to be asked for"};
  if (query.size() != dimension) {
    return {Reason::kInvalidOption, "the query has dimension " + std::to_string(query.size()) +
                                        ", the index " + std::to_string(dimension)};
  }
  for (const float value : query) {
    if (!(std::abs(value) <= kLargest)) {
      return {Reason::kInvalidOption, "the query has a value that is not finite"};
    }
  }
  return {};
}

Status checkQueries(std::span<const std::vector<float>> queries, std::size_t dimension,
                    std::size_t k) {
  RETURN_IF_ERROR(checkQuery(std::vector<float>(dimension), dimension, k));
  for (const std::vector<float>& query : queries) RETURN_IF_ERROR(checkQuery(query, dimension, k));
  return {};
}

}  // namespace moduli
