#include "core/mesh/format.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/mesh/read_formats.h"
#include "core/mesh/scanner.h"

namespace moduli {
namespace {

constexpr std::array<std::string_view, 5> kNames = {"obj", "off", "ply", "stl", "json"};

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

constexpr std::size_t kSample = 1024;  // Bytes that tell text from binary.

// Text has no control characters but spaces.
bool looksLikeText(std::string_view bytes) {
  return std::ranges::all_of(bytes.substr(0, kSample), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte >= 0x20 && byte != 0x7F) || isSpace(c);
  });
}

// The format that the first word of the content proves.
std::optional<MeshFormat> formatFromContent(std::string_view bytes) {
  if (isSizedBinaryStl(bytes)) return MeshFormat::kStl;
  Scanner scanner("", bytes);
  scanner.skipByteOrderMark();
  scanner.skipSpaceAndComments();
  const bool at_start = scanner.left() == bytes.size();
  const std::string_view word = scanner.word();
  if (word == "ply" && at_start) return MeshFormat::kPly;
  if (word.starts_with('{')) return MeshFormat::kJson;
  if (parseOffHeader(word)) return MeshFormat::kOff;
  if (looksLikeAsciiStl(bytes)) return MeshFormat::kStl;
  const bool zeros = bytes.substr(0, kSample).find('\0') != std::string_view::npos;
  if (isObjKeyword(word) && !zeros) return MeshFormat::kObj;
  return std::nullopt;
}

}  // namespace

std::string_view formatName(MeshFormat format) {
  return kNames[static_cast<std::size_t>(format)];
}

std::optional<MeshFormat> formatFromName(std::string_view name) {
  if (name.starts_with('.')) name.remove_prefix(1);
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (std::ranges::equal(name, kNames[i], {}, lower)) return static_cast<MeshFormat>(i);
  }
  return std::nullopt;
}

std::optional<MeshFormat> formatFromExtension(std::string_view file_name) {
  const std::size_t dot = file_name.rfind('.');
  if (dot == std::string_view::npos) return std::nullopt;
  return formatFromName(file_name.substr(dot));
}

std::optional<MeshFormat> detectFormat(std::string_view bytes, std::string_view file_name) {
  if (const auto format = formatFromContent(bytes)) return format;
  const auto format = formatFromExtension(file_name);
  if (!format) return std::nullopt;
  // A name proves nothing about bytes that cannot be that format at all.
  const bool possible = *format == MeshFormat::kStl   ? true
                        : *format == MeshFormat::kPly ? bytes.starts_with("ply")
                                                      : looksLikeText(bytes);
  return possible ? format : std::nullopt;
}

}  // namespace moduli
