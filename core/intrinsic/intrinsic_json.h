#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/intrinsic/intrinsic_surface.h"

/// Intrinsic triangulations as JSON:
///
///   {"format": "moduli-intrinsic-triangulation", "version": 1,
///    "geometry": "hyperbolic",                     or "euclidean", "spherical"
///    "vertices": 6,
///    "faces": [[0, 1, 2], ...],                    vertices counter-clockwise, counted from 0
///    "gluing": [[17, -1, 30], ...],                optional
///    "lengths": [[1.5, 1.5, 1.5], ...]}
///
/// Halfedge 3 f + c runs in face f from corner c to the next one. gluing[f][c] is the opposite
/// halfedge, -1 on the boundary; without a gluing, faces are glued where two of them have the same
/// two vertices, and then loops and double edges cannot be told. lengths[f][c] is the length of
/// that halfedge; both sides of an edge state the same one, or differ by at most 1e-12 of it, and
/// then that of the lower halfedge counts. Keys may come in any order, once each, and no others.
namespace moduli {

struct IntrinsicJsonOptions {
  std::string name = "surface";  ///< The file's name, for messages.
  std::size_t max_faces = std::numeric_limits<Index>::max() / 3;
};

/// Reads one connected oriented surface; every number to the last bit of a double.
///
/// Fails with kSyntaxError (no JSON, or not the form above), kTruncatedFile, kUnsupportedContent
/// (another format or version), kCountTooLarge, kIndexOutOfRange, kMeshTooLarge (more than
/// max_faces), kCancelled, and as assembleSurface does. Messages start with the name, then the byte
/// offset where the text is no JSON ("klein.json: byte 480: ..."), and name the element; the hint
/// says what to do. Bytes are hostile: memory stays within a small multiple of their size, and
/// nesting costs none. O(bytes), one pass.
Result<IntrinsicSurface> readIntrinsicJson(Context& context, std::string_view bytes,
                                           const IntrinsicJsonOptions& options = {});

/// The text of such a file, with the gluing, a line for each face. Lengths are the shortest
/// decimals that read back as the same doubles: what is read again is the same surface to the last
/// bit. O(F).
std::string writeIntrinsicJson(const IntrinsicSurface& surface);

/// True if the beginning of a file says that it is of this kind: JSON files may be anything.
bool looksLikeIntrinsicJson(std::string_view beginning);

}  // namespace moduli
