#include "client/cli/map_ply.h"

#include <bit>
#include <cstdint>
#include <cstring>

#include "client/cli/texture_layout.h"

namespace moduli::cli {
namespace {

static_assert(std::endian::native == std::endian::little);

template <typename Number>
void append(std::string& bytes, Number value) {
  char raw[sizeof(Number)];
  std::memcpy(raw, &value, sizeof(Number));
  bytes.append(raw, sizeof(Number));
}

std::string headerOf(std::size_t vertices, std::size_t faces, bool has_points,
                     const std::string& texture) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  if (!texture.empty()) text += "comment TextureFile " + texture + "\n";
  text += "element vertex " + std::to_string(vertices) +
          "\nproperty double x\nproperty double y\nproperty double z\n";
  if (has_points) text += "property float s\nproperty float t\n";
  return text + "element face " + std::to_string(faces) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

}  // namespace

std::string parameterizationPly(const ParameterizedMesh& mesh, const std::string& texture) {
  const bool has_points = !mesh.points.empty();
  const TextureLayout layout = texture.empty() ? TextureLayout() : fitUnitSquare(mesh);
  const SplitVertices split = splitVertices(mesh);
  const std::size_t vertices = split.vertex.size(), faces = mesh.faces.size() / 3;
  std::string bytes = headerOf(vertices, faces, has_points, texture);
  bytes.reserve(bytes.size() + vertices * 32 + faces * 13);
  for (std::size_t i = 0; i < vertices; ++i) {
    const double* place = mesh.positions.data() + 3 * static_cast<std::size_t>(split.vertex[i]);
    for (int axis = 0; axis < 3; ++axis) append(bytes, place[axis]);
    if (!has_points) continue;
    const auto point = static_cast<std::size_t>(split.point[i]);
    const bool mapped = split.point[i] >= 0;
    append(bytes, mapped ? static_cast<float>(layout.s(mesh.points[2 * point])) : 0.0F);
    append(bytes, mapped ? static_cast<float>(layout.t(mesh.points[2 * point + 1])) : 0.0F);
  }
  for (std::size_t k = 0; k < split.corner.size(); ++k) {
    if (k % 3 == 0) append(bytes, std::uint8_t{3});
    append(bytes, split.corner[k]);
  }
  return bytes;
}

}  // namespace moduli::cli
