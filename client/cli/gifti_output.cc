#include "client/cli/gifti_output.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/mesh/deflate.h"
#include "core/mesh/vertex_data.h"

namespace moduli::cli {
namespace {

std::string lowerCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Six times the volume of the tetrahedron over a face, with the centre of the sphere: positive
/// where the face does not fold. Differences of near numbers of float32 have no error.
template <typename Number>
double volume(const std::vector<Number>& positions, const std::int32_t* face) {
  std::array<Eigen::Vector3d, 3> p;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto at = 3 * static_cast<std::size_t>(face[c]);
    p[c] = Eigen::Vector3d(positions[at], positions[at + 1], positions[at + 2]);
  }
  return p[0].dot((p[1] - p[0]).cross(p[2] - p[0]));
}

bool foldsAsFloats(const ParameterizedMesh& mesh) {
  std::vector<float> rounded;
  for (const double x : mesh.positions) rounded.push_back(static_cast<float>(x));
  for (std::size_t f = 0; f + 2 < mesh.faces.size(); f += 3) {
    const std::int32_t* face = mesh.faces.data() + f;
    if (volume(mesh.positions, face) > 0 && !(volume(rounded, face) > 0)) return true;
  }
  return false;
}

std::string gzippedFor(const std::string& path, std::string bytes) {
  return lowerCase(path).ends_with(".gz") ? gzipBytes(bytes) : bytes;
}

}  // namespace

bool isGiftiFileName(const std::string& path) {
  const std::string name = lowerCase(path);
  return name.ends_with(".gii") || name.ends_with(".gii.gz");
}

bool isValuesFileName(const std::string& path) {
  return isGiftiFileName(path) || lowerCase(path).ends_with(".txt");
}

GiftiTags tagsOf(const std::string& bytes, const std::string& name) {
  if (detectFormat(bytes, name) != MeshFormat::kGifti) return {};
  Context context;
  ReadOptions options;
  options.name = name;
  auto surface = readGiftiSurface(context, bytes, options);
  return surface.ok() ? std::move(surface->tags) : GiftiTags();
}

Result<std::string> sphereGifti(const ParameterizedMesh& mesh, GiftiTags tags,
                                const std::string& path) {
  const auto type = std::find_if(tags.points.begin(), tags.points.end(),
                                 [](const auto& item) { return item.name == "GeometricType"; });
  if (type != tags.points.end()) {
    type->value = "Spherical";
  } else {
    tags.points.push_back({"GeometricType", "Spherical"});
  }
  TriangleSoup soup;
  for (std::size_t i = 0; i + 2 < mesh.positions.size(); i += 3) {
    soup.vertices.emplace_back(mesh.positions[i], mesh.positions[i + 1], mesh.positions[i + 2]);
  }
  for (std::size_t i = 0; i + 2 < mesh.faces.size(); i += 3) {
    soup.faces.push_back({mesh.faces[i], mesh.faces[i + 1], mesh.faces[i + 2]});
  }
  GiftiWriteOptions options;
  options.tags = std::move(tags);
  options.doubles = foldsAsFloats(mesh);
  ASSIGN_OR_RETURN(std::string bytes, writeGiftiSurface(soup, options));
  return gzippedFor(path, std::move(bytes));
}

Result<std::string> valuesFile(const std::vector<double>& values, const std::string& name,
                               const GiftiTags& tags, const std::string& path) {
  if (!isGiftiFileName(path)) {
    std::string text;
    for (const double value : values) text += shortestDouble(value) + "\n";
    return text;
  }
  GiftiWriteOptions options;
  for (const auto* items : {&tags.file, &tags.points}) {
    for (const GiftiMetaItem& item : *items) {
      if (item.name == "AnatomicalStructurePrimary" && options.tags.file.empty()) {
        options.tags.file.push_back(item);
      }
    }
  }
  constexpr double kLargestFloat = std::numeric_limits<float>::max();
  options.doubles = std::any_of(values.begin(), values.end(),
                                [](double x) { return !(std::abs(x) <= kLargestFloat); });
  ASSIGN_OR_RETURN(std::string bytes, writeGiftiShape({values, name}, options));
  return gzippedFor(path, std::move(bytes));
}

}  // namespace moduli::cli
