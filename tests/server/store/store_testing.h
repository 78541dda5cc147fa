#pragma once

#include <stdlib.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>

#include "core/base/digest.h"
#include "server/store/shape_record.h"
#include "tests/core/testing.h"

/// What the store's tests share.
namespace moduli {

/// A folder that goes with the object; in memory where there is such a place and the test does not
/// ask for the disk, whose syncs would take most of its time.
class TemporaryFolder {
 public:
  enum class Place { kMemory, kDisk };

  explicit TemporaryFolder(Place place = Place::kMemory) {
    const std::filesystem::path memory = "/dev/shm";
    const bool use_memory = place == Place::kMemory && ::access(memory.c_str(), W_OK) == 0;
    const auto parent = use_memory ? memory : std::filesystem::temp_directory_path();
    std::string name = (parent / "moduli-test-XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Bytes that do not compress, the same for the same seed.
inline std::string randomBytes(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes(size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

/// A torus called `name`, all of whose other fields follow from the name.
inline ShapeRecord sampleShape(const std::string& collection, const std::string& name) {
  ShapeRecord shape;
  shape.collection = collection;
  shape.name = name;
  shape.label = "label of " + name;
  shape.tags = {{"year", "2020"}, {"owner", name}};
  shape.digest = sha256Hex("mesh of " + name);
  shape.format = MeshFormat::kPly;
  shape.file_name = name + ".ply";
  shape.mesh_bytes = 1234;
  shape.topology = {"TORUS", 1, 0, 100, 200, 2.5};
  shape.descriptor_version = kDescriptorVersion;
  shape.signature = std::string("signature\0of ", 13) + name;
  const auto size = static_cast<float>(name.size());
  shape.vectors = {{0.5F, size}, {1, 2, size}, {3, 4, 5, size}};
  return shape;
}

}  // namespace moduli
