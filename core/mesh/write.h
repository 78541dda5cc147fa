#pragma once

#include <string>
#include <string_view>

#include "core/base/status.h"
#include "core/mesh/format.h"
#include "core/mesh/triangle_soup.h"

namespace moduli {

enum class Encoding { kText, kBinary };

/// The bytes of a mesh file. Text has the shortest decimals that read back as the same doubles; PLY
/// is written with double coordinates, in text or little-endian binary. OBJ and OFF are text only.
/// STL keeps float32 coordinates at most (its format has no more) and loses the numbering.
/// Fails with kInvalidOption (a format that has no such encoding; in STL a coordinate beyond
/// float32). O(V + F).
Result<std::string> writeMesh(const TriangleSoup& soup, MeshFormat format,
                              Encoding encoding = Encoding::kText);

/// Writes a whole file or leaves none: a temporary file in the same folder, then a rename.
/// Fails with kFileUnwritable.
Status writeFile(const std::string& path, std::string_view bytes);

}  // namespace moduli
