#include "client/cpp/parameterized_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

namespace moduli {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kLargestChunk = std::size_t{1} << 20;

/// What each array is, in the order of its enum.
struct ArrayKind {
  const char* name;
  std::int32_t columns;
  std::size_t number_size;
};
constexpr std::array<ArrayKind, 6> kKinds = {{{"POSITIONS", 3, sizeof(double)},
                                              {"FACES", 3, sizeof(std::int32_t)},
                                              {"POINTS", 2, sizeof(double)},
                                              {"CORNERS", 3, sizeof(std::int32_t)},
                                              {"CARRIED", 1, sizeof(double)},
                                              {"GEODESICS", 7, sizeof(double)}}};
constexpr std::size_t kFirstOptional = 4;  // From here on they may be missing.

// In bytes; at most 2^31 x 3 x 8.
std::uint64_t sizeOf(const ArrayKind& kind, std::int32_t rows) {
  return static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(kind.columns) *
         kind.number_size;
}

Status broken(const std::string& array, const std::string& what) {
  return {Reason::kInternal, "the server's answer is broken: array " + array + ": " + what,
          "try again; if it stays, update the server or this client"};
}

template <typename Number>
void append(const std::string& bytes, std::vector<Number>& numbers) {
  const std::size_t before = numbers.size();
  numbers.resize(before + bytes.size() / sizeof(Number));
  if (!bytes.empty()) std::memcpy(numbers.data() + before, bytes.data(), bytes.size());
}

bool inRange(const std::vector<std::int32_t>& indices, std::int32_t lowest, std::int32_t end) {
  return std::all_of(indices.begin(), indices.end(),
                     [=](std::int32_t index) { return index >= lowest && index < end; });
}

bool areFinite(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

// Each face has three points or none.
bool isWhole(const std::vector<std::int32_t>& corners) {
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const bool mapped = corners[i] >= 0;
    if ((corners[i + 1] >= 0) != mapped || (corners[i + 2] >= 0) != mapped) return false;
  }
  return true;
}

}  // namespace

Status ArrayAssembler::take(const v1::ArrayChunk& chunk) {
  if (chunk.array() < v1::ArrayChunk::POSITIONS || chunk.array() > v1::ArrayChunk::GEODESICS) {
    return broken(std::to_string(chunk.array()), "is none that this client knows");
  }
  const auto which = static_cast<std::size_t>(chunk.array() - v1::ArrayChunk::POSITIONS);
  const ArrayKind& kind = kKinds[which];
  State& state = states_[which];
  if (chunk.rows() < 0 || chunk.columns() != kind.columns) {
    return broken(kind.name, "no such array can have " + std::to_string(chunk.rows()) + " x " +
                                 std::to_string(chunk.columns()) + " numbers");
  }
  if (state.rows >= 0 && state.rows != chunk.rows()) return broken(kind.name, "changes its shape");
  state.rows = chunk.rows();
  if (chunk.offset() < 0 || static_cast<std::uint64_t>(chunk.offset()) != state.received) {
    return broken(kind.name, "a chunk starts at byte " + std::to_string(chunk.offset()) +
                                 " instead of " + std::to_string(state.received));
  }
  const std::uint64_t whole = sizeOf(kind, chunk.rows());
  const std::size_t size = chunk.data().size();
  if (size > kLargestChunk || size % kind.number_size != 0 || size > whole - state.received) {
    return broken(kind.name, "a chunk of " + std::to_string(size) + " bytes does not fit");
  }
  state.received += size;
  switch (chunk.array()) {
    case v1::ArrayChunk::POSITIONS:
      append(chunk.data(), mesh_.positions);
      break;
    case v1::ArrayChunk::FACES:
      append(chunk.data(), mesh_.faces);
      break;
    case v1::ArrayChunk::POINTS:
      append(chunk.data(), mesh_.points);
      break;
    case v1::ArrayChunk::CORNERS:
      append(chunk.data(), mesh_.corners);
      break;
    case v1::ArrayChunk::GEODESICS:
      append(chunk.data(), mesh_.geodesics);
      break;
    default:
      append(chunk.data(), mesh_.carried);
  }
  return {};
}

Result<ParameterizedMesh> ArrayAssembler::finish() {
  for (std::size_t i = 0; i < kArrays; ++i) {
    const State& state = states_[i];
    if (state.rows < 0 && i >= kFirstOptional) continue;
    if (state.rows < 0) return broken(kKinds[i].name, "is missing");
    const std::uint64_t whole = sizeOf(kKinds[i], state.rows);
    if (state.received != whole) {
      return broken(kKinds[i].name, "ends after " + std::to_string(state.received) + " of " +
                                        std::to_string(whole) + " bytes");
    }
  }
  const auto rows = [this](v1::ArrayChunk::Array array) {
    return states_[static_cast<std::size_t>(array - v1::ArrayChunk::POSITIONS)].rows;
  };
  if (rows(v1::ArrayChunk::FACES) != rows(v1::ArrayChunk::CORNERS)) {
    return broken("CORNERS", "has not as many rows as there are faces");
  }
  if (!inRange(mesh_.faces, 0, rows(v1::ArrayChunk::POSITIONS))) {
    return broken("FACES", "names a vertex that is not there");
  }
  if (!inRange(mesh_.corners, -1, rows(v1::ArrayChunk::POINTS))) {
    return broken("CORNERS", "names a point that is not there");
  }
  if (!isWhole(mesh_.corners)) return broken("CORNERS", "maps a face in part");
  if (rows(v1::ArrayChunk::CARRIED) > rows(v1::ArrayChunk::POSITIONS)) {
    return broken("CARRIED", "has more rows than there are vertices");
  }
  if (!areFinite(mesh_.points)) return broken("POINTS", "has a number that is not finite");
  if (!areFinite(mesh_.carried)) return broken("CARRIED", "has a number that is not finite");
  if (!areFinite(mesh_.geodesics)) return broken("GEODESICS", "has a number that is not finite");
  return std::move(mesh_);
}

Status checkGeodesics(const ParameterizedMesh& mesh) {
  const auto rows = static_cast<std::int64_t>(mesh.geodesics.size() / 7);
  for (const v1::ClosedGeodesic& geodesic : mesh.result.hyperbolic().geodesics()) {
    const std::int64_t first = geodesic.first_point(), points = geodesic.points();
    if (first < 0 || points < 1 || first + points > rows) {
      return broken("GEODESICS", "has not the points that the result names");
    }
  }
  return {};
}

}  // namespace moduli
