#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "moduli/v1/parameterization.pb.h"

/// Arrays of numbers on their way out.
namespace moduli {

/// An array: its shape, and its bytes in memory, which are what is sent.
struct ArrayView {
  v1::ArrayChunk::Array array;
  std::size_t rows;
  int columns;
  const char* bytes;
  std::size_t size;
};

/// Of rows without gaps: `columns` numbers each.
template <typename Row>
ArrayView viewOf(v1::ArrayChunk::Array array, int columns, const std::vector<Row>& rows) {
  return {array, rows.size(), columns, reinterpret_cast<const char*>(rows.data()),
          rows.size() * sizeof(Row)};
}

/// Hands out arrays in chunks of at most kMaxChunkBytes, one array after the other. The arrays must
/// live as long.
class ArrayChunks {
 public:
  explicit ArrayChunks(std::vector<ArrayView> arrays) : arrays_(std::move(arrays)) {}

  bool done() const { return array_ == arrays_.size(); }
  /// The next piece; an empty array has one, too, for the sake of its shape. Precondition: !done().
  void fill(v1::ArrayChunk& chunk);

 private:
  std::vector<ArrayView> arrays_;
  std::size_t array_ = 0;
  std::size_t offset_ = 0;
};

/// The messages of an answer one after the other: arrays in chunks, then what `finish` fills in,
/// then nothing. The arrays must live as long; `finish` may own them.
template <typename Response>
std::function<std::optional<Response>()> inParts(std::vector<ArrayView> arrays,
                                                 std::function<void(Response&)> finish) {
  struct State {
    ArrayChunks arrays;
    bool done = false;
  };
  const auto state = std::make_shared<State>(State{ArrayChunks(std::move(arrays))});
  return [state, finish = std::move(finish)]() -> std::optional<Response> {
    if (state->done) return std::nullopt;
    Response response;
    if (!state->arrays.done()) {
      state->arrays.fill(*response.mutable_array());
      return response;
    }
    finish(response);
    state->done = true;
    return response;
  };
}

}  // namespace moduli
