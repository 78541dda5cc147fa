#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

/// The binary files of FreeSurfer begin with three bytes that tell what they are; one of these
/// words has two meanings.
namespace moduli {

enum class FreeSurferFile : std::uint8_t {
  kTriangles,  ///< FF FF FE: a surface (lh.white, lh.pial, lh.inflated, lh.sphere).
  kQuads,      ///< FF FF FF or FF FF FD: a surface of quadrangles, as before 1999.
  kValues,     ///< FF FF FF: "new curv", values of vertices (lh.sulc, lh.thickness).
};

inline constexpr std::size_t kFreeSurferMagicSize = 3;
inline constexpr std::size_t kFreeSurferValuesHeaderSize = 15;  // Magic, V, F, values per vertex.

/// What the first bytes say. FF FF FF is taken for values if the word behind V and F is 1, the one
/// number of values per vertex that there is; in a quadrangle surface this would be a part of the
/// first point, at most 0.1 mm from two coordinate planes. If even so only the size of a quadrangle
/// surface fits the whole, it is one.
std::optional<FreeSurferFile> freeSurferFile(std::string_view bytes);

}  // namespace moduli
