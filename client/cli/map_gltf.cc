#include "client/cli/map_gltf.h"

#include <utility>
#include <vector>

#include "client/cli/texture_layout.h"
#include "core/mesh/gltf.h"
#include "core/picture/vec3.h"

namespace moduli::cli {
namespace {

using namespace vec3;

Vec3 placeOf(const ParameterizedMesh& mesh, std::int32_t vertex) {
  const double* p = mesh.positions.data() + 3 * static_cast<std::size_t>(vertex);
  return {p[0], p[1], p[2]};
}

// Per vertex, weighted by area; upwards where the faces have none.
std::vector<Vec3> normalsOf(const ParameterizedMesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size() / 3, Vec3{});
  for (std::size_t i = 0; i + 2 < mesh.faces.size(); i += 3) {
    const Vec3 a = placeOf(mesh, mesh.faces[i]);
    const Vec3 n =
        cross(placeOf(mesh, mesh.faces[i + 1]) - a, placeOf(mesh, mesh.faces[i + 2]) - a);
    for (std::size_t k = i; k < i + 3; ++k) {
      Vec3& sum = normals[static_cast<std::size_t>(mesh.faces[k])];
      sum = sum + n;
    }
  }
  for (Vec3& n : normals) {
    n = normalized(n);
    if (!(dot(n, n) > 0.5) || !finite(n)) n = {0, 0, 1};
  }
  return normals;
}

std::vector<Vec3> meanColors(const SplitVertices& split, const CornerColor& colors) {
  std::vector<Vec3> sums(split.vertex.size(), Vec3{});
  std::vector<double> counts(split.vertex.size(), 0.0);
  for (std::size_t k = 0; k < split.corner.size(); ++k) {
    const auto at = static_cast<std::size_t>(split.corner[k]);
    const Color color = colors(k);
    sums[at] = sums[at] + Vec3{color.red / 255.0, color.green / 255.0, color.blue / 255.0};
    ++counts[at];
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (counts[i] > 0) sums[i] = (1 / counts[i]) * sums[i];
  }
  return sums;
}

/// Fills the parts of a model from split vertices.
class Parts {
 public:
  Parts(const ParameterizedMesh& mesh, const TextureLayout& layout, const CornerColor& colors)
      : mesh_(mesh), layout_(layout), split_(splitVertices(mesh)), normals_(normalsOf(mesh)) {
    if (colors) colors_ = meanColors(split_, colors);
  }

  /// Of the faces that are mapped, or of the others.
  GltfPart part(bool mapped) const {
    GltfPart part;
    std::vector<std::int64_t> place(split_.vertex.size(), -1);
    for (std::size_t k = 0; k < split_.corner.size(); ++k) {
      if ((mesh_.corners[k] >= 0) != mapped) continue;
      const auto at = static_cast<std::size_t>(split_.corner[k]);
      if (place[at] < 0) {
        place[at] = static_cast<std::int64_t>(part.positions.size() / 3);
        addVertex(part, at);
      }
      part.indices.push_back(static_cast<std::uint32_t>(place[at]));
    }
    return part;
  }

 private:
  static void add(std::vector<float>& numbers, const Vec3& p) {
    for (const double x : p) numbers.push_back(static_cast<float>(x));
  }

  void addVertex(GltfPart& part, std::size_t at) const {
    const std::int32_t vertex = split_.vertex[at];
    add(part.positions, placeOf(mesh_, vertex));
    add(part.normals, normals_[static_cast<std::size_t>(vertex)]);
    if (!colors_.empty()) add(part.colors, colors_[at]);
    if (split_.point[at] < 0) return;
    const double* uv = mesh_.points.data() + 2 * static_cast<std::size_t>(split_.point[at]);
    part.texture.push_back(static_cast<float>(layout_.s(uv[0])));
    part.texture.push_back(static_cast<float>(1 - layout_.t(uv[1])));
  }

  const ParameterizedMesh& mesh_;
  const TextureLayout& layout_;
  SplitVertices split_;
  std::vector<Vec3> normals_, colors_;
};

}  // namespace

Result<std::string> parameterizationGltf(const ParameterizedMesh& mesh, const std::string& name,
                                         const CornerColor& colors) {
  using Options = v1::ParameterizationOptions;
  const TextureLayout layout = fitUnitSquare(mesh);
  const Parts parts(mesh, layout, colors);
  GltfModel model;
  model.name = name;
  model.words = {{"target", Options::Target_Name(mesh.result.target())}};
  GltfPart mapped = parts.part(true);
  if (!mapped.indices.empty()) {
    model.numbers = {
        {"uv_scale", layout.scale}, {"uv_origin_u", layout.u0}, {"uv_origin_v", layout.v0}};
    if (!colors) {
      ASSIGN_OR_RETURN(model.texture_png, checkerTexture(mesh, layout));
      mapped.textured = true;
    }
    mapped.color = {1, 1, 1};
    model.parts.push_back(std::move(mapped));
  }
  model.parts.push_back(parts.part(false));
  if (colors) model.parts.back().color = {1, 1, 1};
  return writeGltf(model);
}

}  // namespace moduli::cli
