#pragma once

#include <array>
#include <functional>
#include <string>

#include "client/cpp/parameterized_mesh.h"
#include "core/base/status.h"
#include "core/picture/image.h"

namespace moduli::cli {

/// The colour of corner k of face f, 3 f + k.
using CornerColor = std::function<Color(std::size_t corner)>;

/// A parameterized surface as the bytes of a .glb file (core/mesh/gltf.h): faces that are mapped
/// in a primitive with texture points and a checkerboard (checkerTexture), the others in one
/// without, each in the order of the faces. Vertices are split where texture points differ, those
/// of no face left out; normals are smooth, also across seams. The layout is moved and scaled into
/// the unit square with v from the top down: the node's extras tell by what, as uv_scale and
/// uv_origin_u, uv_origin_v: a point (u, v) of the plane is at (uv_scale (u - uv_origin_u), 1 -
/// uv_scale (v - uv_origin_v)). A map to the sphere has its vertices there and no texture points;
/// one to the disk or the Poincaré disk has its points like any other.
///
/// Doubles become float32: faces of less than 1e-7 of the layout may fold by it.
/// colors: where given, vertices have the mean of their corners' colours instead of the
/// checkerboard. name: of the surface. Fails as writeGltf and encodePng do. O(F log F).
Result<std::string> parameterizationGltf(const ParameterizedMesh& mesh, const std::string& name,
                                         const CornerColor& colors = {});

}  // namespace moduli::cli
