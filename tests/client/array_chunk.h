#pragma once

#include <cstdint>
#include <vector>

#include "moduli/v1/parameterization.pb.h"

namespace moduli {

/// A piece of an array as the service sends it. offset: of its bytes within the whole.
template <typename Number>
v1::ArrayChunk chunk(v1::ArrayChunk::Array array, int rows, int columns,
                     const std::vector<Number>& numbers, std::int64_t offset = 0) {
  v1::ArrayChunk message;
  message.set_array(array);
  message.set_rows(rows);
  message.set_columns(columns);
  message.set_offset(offset);
  message.set_data(numbers.data(), numbers.size() * sizeof(Number));
  return message;
}

}  // namespace moduli
