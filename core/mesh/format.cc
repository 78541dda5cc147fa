#include "core/mesh/format.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/mesh/freesurfer.h"
#include "core/mesh/gifti_document.h"
#include "core/mesh/read_formats.h"
#include "core/mesh/scanner.h"

namespace moduli {
namespace {

constexpr std::array<std::string_view, 7> kNames = {"obj",  "off",   "ply",       "stl",
                                                    "json", "gifti", "freesurfer"};

// Extensions that are not the format's name.
struct Extension {
  std::string_view text;
  MeshFormat format;
};
constexpr std::array kExtensions{
    Extension{"gii", MeshFormat::kGifti},           Extension{"pial", MeshFormat::kFreeSurfer},
    Extension{"white", MeshFormat::kFreeSurfer},    Extension{"inflated", MeshFormat::kFreeSurfer},
    Extension{"smoothwm", MeshFormat::kFreeSurfer}, Extension{"sphere", MeshFormat::kFreeSurfer},
};

// What GIFTI calls files that hold no surface: "x.shape.gii" and so on.
constexpr std::array<std::string_view, 9> kGiftiOthers = {
    ".coord", ".func", ".label", ".rgba", ".shape", ".tensor", ".time", ".topo", ".vector"};

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool equalText(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, {}, lower, lower);
}

bool endsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && equalText(text.substr(text.size() - end.size()), end);
}

constexpr std::size_t kSample = 1024;  // Bytes in which a zero tells binary from text.

// The format that the first word of the content proves.
std::optional<MeshFormat> formatFromContent(std::string_view bytes) {
  if (isSizedBinaryStl(bytes)) return MeshFormat::kStl;
  if (freeSurferFile(bytes)) return MeshFormat::kFreeSurfer;
  if (looksLikeGifti(bytes)) return MeshFormat::kGifti;
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
    if (equalText(name, kNames[i])) return static_cast<MeshFormat>(i);
  }
  if (equalText(name, "gii")) return MeshFormat::kGifti;
  return std::nullopt;
}

std::optional<MeshFormat> formatFromExtension(std::string_view file_name) {
  if (endsWith(file_name, ".gii.gz")) file_name.remove_suffix(3);
  const std::size_t dot = file_name.rfind('.');
  if (dot == std::string_view::npos) return std::nullopt;
  const std::string_view word = file_name.substr(dot + 1);
  for (const Extension& extension : kExtensions) {
    if (!equalText(word, extension.text)) continue;
    const std::string_view stem = file_name.substr(0, dot);
    const bool other = extension.format == MeshFormat::kGifti &&
                       std::ranges::any_of(kGiftiOthers, [&](std::string_view kind) {
                         return endsWith(stem, kind);
                       });
    return other ? std::nullopt : std::optional(extension.format);
  }
  return formatFromName(word);
}

std::optional<MeshFormat> detectFormat(std::string_view bytes, std::string_view file_name) {
  if (const auto format = formatFromContent(bytes)) return format;
  const auto format = formatFromExtension(file_name);
  if (!format) return std::nullopt;
  // A name proves nothing about bytes that cannot be that format at all.
  const bool possible = *format == MeshFormat::kStl          ? true
                        : *format == MeshFormat::kPly        ? bytes.starts_with("ply")
                        : *format == MeshFormat::kFreeSurfer ? false
                                                             : looksLikeText(bytes);
  return possible ? format : std::nullopt;
}

}  // namespace moduli
