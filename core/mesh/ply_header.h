#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/status.h"
#include "core/mesh/scanner.h"

namespace moduli {

enum class PlyEncoding : std::uint8_t { kText, kLittleEndian, kBigEndian };

enum class PlyType : std::uint8_t {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kFloat32,
  kFloat64,
};

inline std::size_t plyTypeSize(PlyType type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}
inline bool isInteger(PlyType type) {
  return type < PlyType::kFloat32;
}

struct PlyProperty {
  std::string_view name;
  PlyType type = PlyType::kInt8;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  ///< Of a list.
};

struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  const char* place = nullptr;  ///< Where the header declares it.

  const PlyProperty* find(std::string_view property) const;
  /// Fewest bytes that one such element takes in this encoding.
  std::uint64_t smallestSize(PlyEncoding encoding) const;
  /// Bytes of one element in a binary file if all have the same size, otherwise 0.
  std::size_t fixedSize() const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kText;
  std::vector<PlyElement> elements;
  const char* end_place = nullptr;  ///< Where "end_header" stands.
};

/// Reads the header and leaves the scanner at the first byte of the data. Names are views of the
/// scanner's bytes. Fails with kSyntaxError, kTruncatedFile, kUnsupportedContent.
Result<PlyHeader> readPlyHeader(Scanner& in);

}  // namespace moduli
