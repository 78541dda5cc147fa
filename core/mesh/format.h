#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace moduli {

enum class MeshFormat : std::uint8_t {
  kObj,
  kOff,
  kPly,
  kStl,
  kJson,  ///< An intrinsic triangulation: no mesh, as it has no positions.
};

/// "obj", "off", "ply", "stl" or "json".
std::string_view formatName(MeshFormat format);

/// From a name such as "ply" or "PLY", with or without a leading dot.
std::optional<MeshFormat> formatFromName(std::string_view name);

/// From the extension of a file name, in any case.
std::optional<MeshFormat> formatFromExtension(std::string_view file_name);

/// From the content first (magic words; a binary STL by its size; a brace for JSON), then from the
/// extension.
std::optional<MeshFormat> detectFormat(std::string_view bytes, std::string_view file_name);

}  // namespace moduli
