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
/// GIFTI has float32 coordinates (gifti.h says why), as ASCII or compressed (GZipBase64Binary).
/// Binary STL rounds coordinates to float32 (its format has no more); STL of both encodings loses
/// the numbering and the vertices without faces.
/// Fails with kInvalidOption (a format that has no such encoding; JSON; FreeSurfer; in binary STL
/// and GIFTI a coordinate beyond float32). O(V + F).
Result<std::string> writeMesh(const TriangleSoup& soup, MeshFormat format,
                              Encoding encoding = Encoding::kText);

/// Writes a whole file or leaves what was there: a temporary file in the same folder, fsync, then a
/// rename. Behind a symbolic link the file itself is replaced; pipes and devices are written to as
/// they are. Fails with kFileUnwritable.
Status writeFile(const std::string& path, std::string_view bytes);

}  // namespace moduli
