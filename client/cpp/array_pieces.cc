#include "client/cpp/array_pieces.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace moduli {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kLargestChunk = std::size_t{1} << 20;

std::size_t numberSize(const ArrayKind& kind) {
  switch (kind.number) {
    case ArrayKind::Number::kDouble:
      return sizeof(double);
    case ArrayKind::Number::kInt32:
      return sizeof(std::int32_t);
    default:
      return 1;
  }
}

// In bytes; at most 2^31 x 7 x 8.
std::uint64_t sizeOf(const ArrayKind& kind, std::int32_t rows) {
  return static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(kind.columns) *
         numberSize(kind);
}

template <typename Number>
void append(const std::string& bytes, std::vector<Number>& numbers) {
  const std::size_t before = numbers.size();
  numbers.resize(before + bytes.size() / sizeof(Number));
  if (!bytes.empty()) std::memcpy(numbers.data() + before, bytes.data(), bytes.size());
}

}  // namespace

ArrayPieces::ArrayPieces(const std::vector<ArrayKind>& kinds) {
  for (const ArrayKind& kind : kinds) states_.push_back({kind, -1, 0, {}, {}, {}});
}

ArrayPieces::State* ArrayPieces::find(v1::ArrayChunk::Array array) {
  const auto found = std::find_if(states_.begin(), states_.end(), [array](const State& state) {
    return state.kind.array == array;
  });
  return found == states_.end() ? nullptr : &*found;
}

const ArrayPieces::State& ArrayPieces::at(v1::ArrayChunk::Array array) const {
  return *const_cast<ArrayPieces*>(this)->find(array);
}

Status ArrayPieces::take(const v1::ArrayChunk& chunk) {
  State* const state = find(chunk.array());
  if (state == nullptr) {
    return brokenArray(std::to_string(chunk.array()), "is none that this client knows");
  }
  const ArrayKind& kind = state->kind;
  const std::string& name = v1::ArrayChunk::Array_Name(kind.array);
  if (chunk.rows() < 0 || chunk.columns() != kind.columns) {
    return brokenArray(name, "no such array can have " + std::to_string(chunk.rows()) + " x " +
                                 std::to_string(chunk.columns()) + " numbers");
  }
  if (state->rows >= 0 && state->rows != chunk.rows()) {
    return brokenArray(name, "changes its shape");
  }
  state->rows = chunk.rows();
  if (chunk.offset() < 0 || static_cast<std::uint64_t>(chunk.offset()) != state->received) {
    return brokenArray(name, "a chunk starts at byte " + std::to_string(chunk.offset()) +
                                 " instead of " + std::to_string(state->received));
  }
  const std::uint64_t whole = sizeOf(kind, chunk.rows());
  const std::size_t size = chunk.data().size();
  if (size > kLargestChunk || size % numberSize(kind) != 0 || size > whole - state->received) {
    return brokenArray(name, "a chunk of " + std::to_string(size) + " bytes does not fit");
  }
  state->received += size;
  if (kind.number == ArrayKind::Number::kDouble) {
    append(chunk.data(), state->doubles);
  } else if (kind.number == ArrayKind::Number::kByte) {
    state->bytes += chunk.data();
  } else {
    append(chunk.data(), state->integers);
  }
  return {};
}

Status ArrayPieces::checkComplete() const {
  for (const State& state : states_) {
    const std::string& name = v1::ArrayChunk::Array_Name(state.kind.array);
    if (state.rows < 0 && !state.kind.required) continue;
    if (state.rows < 0) return brokenArray(name, "is missing");
    const std::uint64_t whole = sizeOf(state.kind, state.rows);
    if (state.received != whole) {
      return brokenArray(name, "ends after " + std::to_string(state.received) + " of " +
                                   std::to_string(whole) + " bytes");
    }
  }
  return {};
}

std::int32_t ArrayPieces::rows(v1::ArrayChunk::Array array) const {
  return at(array).rows;
}

const std::vector<double>& ArrayPieces::doubles(v1::ArrayChunk::Array array) const {
  return at(array).doubles;
}

const std::vector<std::int32_t>& ArrayPieces::integers(v1::ArrayChunk::Array array) const {
  return at(array).integers;
}

std::vector<double> ArrayPieces::takeDoubles(v1::ArrayChunk::Array array) {
  return std::move(find(array)->doubles);
}

std::vector<std::int32_t> ArrayPieces::takeIntegers(v1::ArrayChunk::Array array) {
  return std::move(find(array)->integers);
}

std::string ArrayPieces::takeBytes(v1::ArrayChunk::Array array) {
  return std::move(find(array)->bytes);
}

Status brokenArray(const std::string& array, const std::string& what) {
  return {Reason::kInternal, "the server's answer is broken: array " + array + ": " + what,
          "try again; if it stays, update the server or this client"};
}

}  // namespace moduli
