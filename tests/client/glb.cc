#include "tests/client/glb.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "tests/client/process.h"

namespace moduli {
namespace {

std::uint32_t wordAt(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  EXPECT_LE(at + 4, bytes.size());
  if (at + 4 <= bytes.size()) std::memcpy(&word, bytes.data() + at, 4);
  return word;
}

}  // namespace

Glb Glb::parse(const std::string& bytes) {
  EXPECT_TRUE(bytes.starts_with("glTF"));
  EXPECT_EQ(wordAt(bytes, 4), 2U);
  EXPECT_EQ(wordAt(bytes, 8), bytes.size());
  const std::size_t size = wordAt(bytes, 12);
  EXPECT_EQ(size % 4, 0U);
  EXPECT_EQ(wordAt(bytes, 16), 0x4E4F534AU);
  std::string text = bytes.substr(std::min<std::size_t>(20, bytes.size()), size);
  text.erase(text.find_last_not_of(' ') + 1);
  Glb glb(Json::parse(text + "\n"));
  if (20 + size == bytes.size()) return glb;
  const std::size_t binary = wordAt(bytes, 20 + size);
  EXPECT_EQ(binary % 4, 0U);
  EXPECT_EQ(wordAt(bytes, 24 + size), 0x004E4942U);
  EXPECT_EQ(28 + size + binary, bytes.size());
  glb.bytes_ = bytes.substr(28 + size);
  EXPECT_LE(glb.json_["buffers"].at(0)["byteLength"].number(), double(binary));
  return glb;
}

std::string Glb::view(int i) const {
  const Json view = json_["bufferViews"].at(i);
  const auto begin =
      view.has("byteOffset") ? static_cast<std::size_t>(view["byteOffset"].number()) : 0;
  const auto size = static_cast<std::size_t>(view["byteLength"].number());
  EXPECT_EQ(begin % 4, 0U);
  EXPECT_LE(begin + size, bytes_.size());
  EXPECT_FALSE(view.has("byteStride"));
  return begin <= bytes_.size() ? bytes_.substr(begin, size) : "";
}

template <typename Number>
std::vector<Number> Glb::numbers(int i, int component) const {
  static const std::map<std::string, std::size_t> kColumns = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
  const Json item = accessor(i);
  EXPECT_EQ(item["componentType"].number(), component);
  const std::string data = view(static_cast<int>(item["bufferView"].number()));
  std::vector<Number> values(data.size() / sizeof(Number));
  std::memcpy(values.data(), data.data(), values.size() * sizeof(Number));
  const auto columns = kColumns.at(item["type"].string());
  EXPECT_EQ(static_cast<double>(values.size() / columns), item["count"].number());
  return values;
}

std::vector<float> Glb::attribute(int primitive_index, const std::string& name) const {
  const Json attributes = primitive(primitive_index)["attributes"];
  if (!attributes.has(name)) return {};
  return numbers<float>(static_cast<int>(attributes[name].number()), 5126);
}

std::vector<std::uint32_t> Glb::indices(int primitive_index) const {
  return numbers<std::uint32_t>(static_cast<int>(primitive(primitive_index)["indices"].number()),
                                5125);
}

std::string Glb::image() const {
  return view(static_cast<int>(json_["images"].at(0)["bufferView"].number()));
}

std::string gltfFault(const std::string& bytes, const std::string& folder) {
  const std::string module = MODULI_SOURCE_DIR "/build/npm/node_modules/gltf-validator";
  if (!std::filesystem::exists(module)) {
    return "skip: needs the Khronos validator: npm install --prefix build/npm gltf-validator";
  }
  const std::string path = folder + "/validated.glb";
  std::ofstream(path, std::ios::binary) << bytes;
  Process::Options options;
  options.scratch = folder;
  const ProcessResult result =
      Process({"/usr/bin/env", "node", MODULI_SOURCE_DIR "/tests/client/validate_gltf.js", module,
               path},
              options)
          .wait();
  if (result.exit_code == 127) return "skip: needs node";
  return result.exit_code == 0 ? result.out : "the validator failed: " + result.err;
}

}  // namespace moduli
