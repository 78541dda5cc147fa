#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/base/status.h"

/// Surfaces as glTF 2.0, in its binary form (.glb): what viewers, Blender and browsers read.
///
///   GltfPart part;
///   part.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
///   part.indices = {0, 1, 2};
///   GltfModel model;
///   model.parts.push_back(std::move(part));
///   const Result<std::string> bytes = writeGltf(model);
namespace moduli {

/// Triangles of one look. The format has no doubles.
struct GltfPart {
  std::vector<float> positions;        ///< x y z per vertex, finite.
  std::vector<float> normals;          ///< Per vertex, of length 1; or empty.
  std::vector<float> texture;          ///< u v per vertex, v from the top down; or empty.
  std::vector<float> colors;           ///< Red, green, blue in [0, 1] (sRGB) per vertex; or empty.
  std::vector<std::uint32_t> indices;  ///< Three per face.
  std::array<double, 3> color = {0.8, 0.8,
                                 0.8};  ///< Of all of it (sRGB), times texture and colors.
  bool textured = false;                ///< Bears the model's texture; needs `texture`.
};

struct GltfModel {
  std::string name;  ///< Left out where it is not UTF-8 without control characters.
  std::vector<GltfPart> parts;
  std::string texture_png;  ///< Bytes of a PNG file; embedded where a part bears it.
  /// Said in the `extras` of the node, which programs leave alone or show as properties.
  std::vector<std::pair<std::string, double>> numbers;
  std::vector<std::pair<std::string, std::string>> words;
};

/// sRGB to linear light, both in [0, 1]: glTF has colours of vertices and materials in the latter.
double linearLight(double srgb);

/// The bytes of a .glb file: one node with one mesh, a primitive for every part that has faces, in
/// their order. Without any the scene is empty. Indices are 32 bits wide, everything begins at a
/// multiple of four bytes, positions have their bounds. Both sides of faces are seen.
/// Fails with kInvalidOption where arrays of a part do not fit each other, an index names no
/// vertex, a number is not finite, or the file would exceed 2^32 - 1 bytes. O(V + F).
/// Source: Khronos Group, glTF 2.0 Specification, 2021 (also ISO/IEC 12113:2022).
Result<std::string> writeGltf(const GltfModel& model);

}  // namespace moduli
