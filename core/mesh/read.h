#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/format.h"
#include "core/mesh/triangle_soup.h"

/// Strict readers. Every number is read to the last bit of a double; nothing is rounded, guessed,
/// dropped or reordered. Bytes are hostile: counts are checked against the bytes that are left
/// before memory is taken, so memory stays within a small multiple of the input's size, or of what
/// InflateAllowance permits compressed parts to grow to.
namespace moduli {

struct ReadOptions {
  std::optional<MeshFormat> format;  ///< Empty: told from the content, then from the name.
  std::string name = "mesh";         ///< The file's name, for messages and its extension.
  /// Faces after fan triangulation; more fail with kMeshTooLarge.
  std::size_t max_faces = std::numeric_limits<Index>::max() / 3;
};

/// Reads OBJ, OFF (OFF, COFF, NOFF, CNOFF, STOFF, 4OFF refused by name, comments), PLY (ascii,
/// binary of both byte orders), STL (ascii, binary; corners with exactly equal coordinates become
/// one vertex, numbered by first use), GIFTI (.gii, .gii.gz; gifti.h says which) or a binary
/// surface of triangles of FreeSurfer. Polygons become fans from their first corner. Coordinates
/// are those of the file: no transform that it tells of is applied.
///
/// Fails with kUnknownFormat, kSyntaxError, kTruncatedFile, kCountTooLarge, kIndexOutOfRange,
/// kUnsupportedContent (also for JSON: an intrinsic triangulation has no positions), kEmpty (no
/// faces), kMeshTooLarge, kCancelled. The message starts with the name and the 1-based line
/// ("part.obj:17: ...") or the byte offset ("part.ply: byte 480: ..."), names the defect, and the
/// hint says what to do; lines of a gzipped file are those of the text in it. NaN and infinity are
/// read as such where the format spells them ("nan", "inf"): validation reports them as
/// NON_FINITE_COORDINATE. O(bytes), one pass.
Result<TriangleSoup> readMesh(Context& context, std::string_view bytes, const ReadOptions& options);

/// Reads and parses a file. Fails also with kFileNotFound, kFileUnreadable.
Result<TriangleSoup> readMeshFile(Context& context, const std::string& path,
                                  ReadOptions options = {});

}  // namespace moduli
