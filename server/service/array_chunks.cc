#include "server/service/array_chunks.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "server/service/backend.h"

namespace moduli {

static_assert(std::endian::native == std::endian::little);

void ArrayChunks::fill(v1::ArrayChunk& chunk) {
  const ArrayView& view = arrays_[array_];
  const std::size_t length = std::min(kMaxChunkBytes, view.size - offset_);
  chunk.set_array(view.array);
  chunk.set_rows(static_cast<std::int32_t>(view.rows));
  chunk.set_columns(view.columns);
  chunk.set_offset(static_cast<std::int64_t>(offset_));
  if (length > 0) chunk.set_data(view.bytes + offset_, length);
  offset_ += length;
  if (offset_ < view.size) return;
  offset_ = 0;
  ++array_;
}

}  // namespace moduli
