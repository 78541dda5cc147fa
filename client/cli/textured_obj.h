#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "client/cli/texture_layout.h"
#include "client/cpp/parameterized_mesh.h"
#include "core/base/status.h"
#include "core/mesh/obj_statements.h"

namespace moduli::cli {

/// How a parameterized surface becomes an OBJ file.
struct TexturedObjOptions {
  /// What the surface's own OBJ file says of its looks; null: nothing.
  const ObjStatements* kept = nullptr;
  /// Name of a material file (texturedMaterials); "": none. With it, points are moved and scaled
  /// into the unit square by `layout`, and mapped faces have its material instead of their own.
  std::string materials;
  TextureLayout layout;
};

/// Writes a parameterized surface as OBJ: all vertices and faces in their order, a `vt` for every
/// point, and in each face that is mapped the points of its corners. Numbers are the shortest
/// decimals that read back as the same doubles. `sink` gets the text in pieces; its failure ends
/// the writing and is returned.
///
/// Of the surface's own file, groups, objects, smoothing groups, materials and their libraries
/// stand before the same faces; pieces of a face that was cut have what their face has. Faces that
/// were not cut keep their normals, unless their vertices have moved to the sphere, and those that
/// are not mapped their texture points. Nothing is kept where the file has another number of faces,
/// or it is not known which pieces are whose (servers of old). O(V + F).
Status writeTexturedObj(const ParameterizedMesh& mesh, const TexturedObjOptions& options,
                        const std::function<Status(std::string_view)>& sink);

/// The material file that belongs to it. texture: name of a picture beside it.
std::string texturedMaterials(const std::string& texture);

}  // namespace moduli::cli
