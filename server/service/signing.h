#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>

#include "core/base/context.h"
#include "core/intrinsic/intrinsic_surface.h"
#include "core/mesh/format.h"
#include "core/mesh/prepare.h"
#include "core/mesh/triangle_soup.h"
#include "core/signature/compute.h"
#include "core/signature/signature.h"
#include "moduli/v1/mesh.pb.h"
#include "server/service/backend.h"
#include "server/store/mesh_store.h"

/// From where a mesh is to its signature.
namespace moduli {

/// A mesh file in memory.
struct MeshFile {
  std::string bytes;
  std::optional<MeshFormat> format;  ///< As the caller or the store says.
  std::string name = "mesh";         ///< For messages and its extension.
};

/// The file that a checked source means. Fails with kUploadNotFound, kCollectionNotFound,
/// kShapeNotFound and as the store does.
Result<MeshFile> loadMesh(Context& context, const Backend& backend, const v1::MeshSource& source);

/// What a file holds: a mesh, or, in a JSON file, an intrinsic triangulation.
using ParsedSurface = std::variant<TriangleSoup, IntrinsicSurface>;

/// Parses a file, within the server's limit of faces. Fails as readMesh or readIntrinsicJson
/// does.
Result<ParsedSurface> parseSurface(Context& context, const Backend& backend, const MeshFile& file);

/// Fails with kInvalidOption where `prepare` asks of an intrinsic triangulation what only a mesh
/// can undergo, and with kComponentNotFound where it names another component than the one there is.
Status checkIntrinsicPrepare(const PrepareOptions& prepare);

/// Parses, prepares and signs.
Result<Signature> signMesh(Context& context, const Backend& backend, const MeshFile& file,
                           const PrepareOptions& prepare, const SignatureOptions& options);

}  // namespace moduli
