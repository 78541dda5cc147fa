#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "core/base/context.h"
#include "core/mesh/format.h"
#include "core/mesh/prepare.h"
#include "core/mesh/triangle_soup.h"
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

/// Parses a file, within the server's limit of faces.
Result<TriangleSoup> parseMesh(Context& context, const Backend& backend, const MeshFile& file);

/// Parses, prepares and signs. space: only this one and the work that it needs.
Result<Signature> signMesh(Context& context, const Backend& backend, const MeshFile& file,
                           const PrepareOptions& prepare, std::optional<Space> space);

}  // namespace moduli
