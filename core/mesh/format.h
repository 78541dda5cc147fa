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
  kJson,        ///< An intrinsic triangulation: no mesh, as it has no positions.
  kGifti,       ///< .gii and, gzipped as a whole, .gii.gz.
  kFreeSurfer,  ///< The binary surfaces of FreeSurfer; read only.
};

/// "obj", "off", "ply", "stl", "json", "gifti" or "freesurfer".
std::string_view formatName(MeshFormat format);

/// From a name such as "ply" or "PLY", with or without a leading dot; "gii" is "gifti", too.
std::optional<MeshFormat> formatFromName(std::string_view name);

/// From the extension of a file name, in any case. FreeSurfer's surfaces are told by what they
/// are: .pial, .white, .inflated, .smoothwm, .sphere. Names that GIFTI keeps for files without a
/// surface (.shape.gii, .func.gii, .label.gii...) tell no format of a mesh.
std::optional<MeshFormat> formatFromExtension(std::string_view file_name);

/// From the content first (magic words, also within a gzip file for GIFTI; a binary STL by its
/// size; a brace for JSON), then from the extension.
std::optional<MeshFormat> detectFormat(std::string_view bytes, std::string_view file_name);

}  // namespace moduli
