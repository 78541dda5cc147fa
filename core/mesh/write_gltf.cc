// The one file that knows tinygltf.
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "core/base/text.h"
#include "core/mesh/gltf.h"

namespace moduli {
namespace {

// What a chunk and the whole file may measure; the JSON beside the numbers stays below a megabyte.
constexpr std::size_t kMostBytes = std::numeric_limits<std::uint32_t>::max() - (1U << 20);

Status unfit(const std::string& what) {
  return {Reason::kInvalidOption, "as glTF: " + what};
}

bool areFinite(const std::vector<float>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); });
}

Status check(const GltfPart& part) {
  const std::size_t vertices = part.positions.size() / 3;
  const auto fits = [vertices](const std::vector<float>& numbers, std::size_t columns) {
    return numbers.empty() || numbers.size() == columns * vertices;
  };
  if (part.positions.size() % 3 != 0 || part.indices.size() % 3 != 0 || !fits(part.normals, 3) ||
      !fits(part.texture, 2) || !fits(part.colors, 3) || (part.textured && part.texture.empty())) {
    return unfit("arrays of a part that do not fit each other");
  }
  if (std::any_of(part.indices.begin(), part.indices.end(),
                  [vertices](std::uint32_t i) { return i >= vertices; })) {
    return unfit("an index that names no vertex");
  }
  if (!areFinite(part.positions) || !areFinite(part.normals) || !areFinite(part.texture) ||
      !areFinite(part.colors)) {
    return unfit("a number that is not finite, or beyond the range of float32");
  }
  return {};
}

std::size_t bytesOf(const GltfPart& part) {
  const std::size_t numbers = part.positions.size() + part.normals.size() + part.texture.size() +
                              part.colors.size() + part.indices.size();
  return 4 * numbers;
}

/// A model of tinygltf's while it is filled.
class Builder {
 public:
  explicit Builder(const GltfModel& model) : source_(model) {
    model_.asset.version = "2.0";
    model_.asset.generator = "moduli";
    model_.buffers.emplace_back();
  }

  tinygltf::Model build() && {
    tinygltf::Mesh mesh;
    for (const GltfPart& part : source_.parts) {
      if (!part.indices.empty()) mesh.primitives.push_back(primitive(part));
    }
    if (isPrintableUtf8(source_.name)) mesh.name = source_.name;
    model_.scenes.emplace_back();
    model_.defaultScene = 0;
    if (mesh.primitives.empty()) {
      model_.scenes[0].name = "empty";  // The library makes a null of a scene without anything.
      model_.buffers.clear();
    } else {
      tinygltf::Node node;
      node.mesh = 0;
      node.name = mesh.name;
      node.extras = extras();
      model_.meshes.push_back(std::move(mesh));
      model_.nodes.push_back(std::move(node));
      model_.scenes[0].nodes.push_back(0);
    }
    return std::move(model_);
  }

 private:
  // A view of its own for each array; returns its number.
  int addView(const void* data, std::size_t size, int target) {
    std::vector<unsigned char>& bytes = model_.buffers[0].data;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes.size();
    view.byteLength = size;
    view.target = target;
    const auto* begin = static_cast<const unsigned char*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
    model_.bufferViews.push_back(std::move(view));
    return static_cast<int>(model_.bufferViews.size()) - 1;
  }

  template <typename Number>
  int addAccessor(const std::vector<Number>& numbers, std::size_t columns, int type, int component,
                  int target) {
    tinygltf::Accessor accessor;
    accessor.bufferView = addView(numbers.data(), numbers.size() * sizeof(Number), target);
    accessor.componentType = component;
    accessor.count = numbers.size() / columns;
    accessor.type = type;
    model_.accessors.push_back(std::move(accessor));
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  int addFloats(const std::vector<float>& numbers, std::size_t columns) {
    return addAccessor(numbers, columns, columns == 2 ? TINYGLTF_TYPE_VEC2 : TINYGLTF_TYPE_VEC3,
                       TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
  }

  int addPositions(const std::vector<float>& positions) {
    const int index = addFloats(positions, 3);
    tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
    accessor.minValues.assign(positions.begin(), positions.begin() + 3);
    accessor.maxValues = accessor.minValues;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      accessor.minValues[i % 3] = std::min<double>(accessor.minValues[i % 3], positions[i]);
      accessor.maxValues[i % 3] = std::max<double>(accessor.maxValues[i % 3], positions[i]);
    }
    return index;
  }

  int addColors(const std::vector<float>& colors) {
    std::vector<float> linear(colors.size());
    std::transform(colors.begin(), colors.end(), linear.begin(), [](float x) {
      return static_cast<float>(linearLight(std::clamp(x, 0.0F, 1.0F)));
    });
    return addFloats(linear, 3);
  }

  int addMaterial(const GltfPart& part) {
    tinygltf::Material material;
    material.doubleSided = true;
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.pbrMetallicRoughness.roughnessFactor = 0.75;
    for (std::size_t k = 0; k < 3; ++k) {
      material.pbrMetallicRoughness.baseColorFactor[k] = linearLight(part.color[k]);
    }
    if (part.textured) {
      addTexture();
      material.pbrMetallicRoughness.baseColorTexture.index = 0;
    }
    model_.materials.push_back(std::move(material));
    return static_cast<int>(model_.materials.size()) - 1;
  }

  void addTexture() {
    if (!model_.textures.empty()) return;
    tinygltf::Image image;
    image.mimeType = "image/png";
    image.bufferView = addView(source_.texture_png.data(), source_.texture_png.size(), 0);
    model_.images.push_back(std::move(image));
    tinygltf::Sampler sampler;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    model_.samplers.push_back(std::move(sampler));
    tinygltf::Texture texture;
    texture.source = 0;
    texture.sampler = 0;
    model_.textures.push_back(std::move(texture));
  }

  tinygltf::Primitive primitive(const GltfPart& part) {
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.attributes["POSITION"] = addPositions(part.positions);
    if (!part.normals.empty()) primitive.attributes["NORMAL"] = addFloats(part.normals, 3);
    if (!part.texture.empty()) primitive.attributes["TEXCOORD_0"] = addFloats(part.texture, 2);
    if (!part.colors.empty()) primitive.attributes["COLOR_0"] = addColors(part.colors);
    primitive.indices =
        addAccessor(part.indices, 1, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                    TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    primitive.material = addMaterial(part);
    return primitive;
  }

  tinygltf::Value extras() const {
    tinygltf::Value::Object items;
    for (const auto& [key, value] : source_.numbers) items[key] = tinygltf::Value(value);
    for (const auto& [key, value] : source_.words) items[key] = tinygltf::Value(value);
    return items.empty() ? tinygltf::Value() : tinygltf::Value(std::move(items));
  }

  const GltfModel& source_;
  tinygltf::Model model_;
};

}  // namespace

double linearLight(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

Result<std::string> writeGltf(const GltfModel& model) {
  std::size_t bytes = model.texture_png.size();
  for (const GltfPart& part : model.parts) {
    RETURN_IF_ERROR(check(part));
    if (part.textured && model.texture_png.empty()) return unfit("a texture that is not there");
    bytes += bytesOf(part);
  }
  if (bytes > kMostBytes) return unfit("more than 4 GiB");
  for (const auto& [key, value] : model.numbers) {
    if (!std::isfinite(value)) return unfit("a number that is not finite");
  }
  for (const auto& [key, value] : model.words) {
    if (!isPrintableUtf8(value)) return unfit("a word that is not UTF-8");
  }
  const tinygltf::Model built = Builder(model).build();
  std::ostringstream out;
  tinygltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&built, out, false, true)) {
    return Status(Reason::kInternal, "the glTF library failed");
  }
  return std::move(out).str();
}

}  // namespace moduli
