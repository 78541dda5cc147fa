#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "moduli/v1/parameterization.pb.h"

namespace moduli {

/// What an array of an answer is.
struct ArrayKind {
  enum class Number : std::uint8_t { kDouble, kInt32, kByte };

  v1::ArrayChunk::Array array;
  std::int32_t columns;
  Number number;
  bool required;
};

/// Puts arrays together from their chunks. Trusts no server: shapes, offsets and sizes are judged,
/// and memory is taken for what has arrived, not for what is promised. Not thread-safe.
class ArrayPieces {
 public:
  /// kinds: what an answer may have.
  explicit ArrayPieces(const std::vector<ArrayKind>& kinds);

  /// Fails with kInternal, naming the array, on a chunk that does not fit those before it.
  Status take(const v1::ArrayChunk& chunk);
  /// Fails with kInternal where an array is incomplete, or missing and required.
  Status checkComplete() const;

  /// -1: nothing of it has come. array: one of the kinds.
  std::int32_t rows(v1::ArrayChunk::Array array) const;
  const std::vector<double>& doubles(v1::ArrayChunk::Array array) const;
  const std::vector<std::int32_t>& integers(v1::ArrayChunk::Array array) const;
  std::vector<double> takeDoubles(v1::ArrayChunk::Array array);
  std::vector<std::int32_t> takeIntegers(v1::ArrayChunk::Array array);
  std::string takeBytes(v1::ArrayChunk::Array array);

 private:
  struct State {
    ArrayKind kind;
    std::int32_t rows = -1;
    std::uint64_t received = 0;  ///< Bytes.
    std::vector<double> doubles;
    std::vector<std::int32_t> integers;
    std::string bytes;
  };

  State* find(v1::ArrayChunk::Array array);
  const State& at(v1::ArrayChunk::Array array) const;

  std::vector<State> states_;
};

/// The kInternal of an answer that no sound server gives. array: "POINTS", or its number.
Status brokenArray(const std::string& array, const std::string& what);

}  // namespace moduli
