#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/status.h"
#include "core/retrieval/vector_index.h"

namespace moduli {

/// kInvalidOption unless the sizes fit together and every value is finite and at most 1e38.
Status checkVectorSet(const VectorSet& set);

/// kInvalidOption unless the query is finite, of the right dimension, and k is positive.
Status checkQuery(std::span<const float> query, std::size_t dimension, std::size_t k);

/// checkQuery of every query, and k is positive even if there is none.
Status checkQueries(std::span<const std::vector<float>> queries, std::size_t dimension,
                    std::size_t k);

}  // namespace moduli
