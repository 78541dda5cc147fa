#include "tests/core/testing.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace moduli {
namespace {

std::filesystem::path meshFolder() {
  if (const char* shared = std::getenv("MODULI_SHARED")) {
    return std::filesystem::path(shared) / "meshes";
  }
  return std::filesystem::path(MODULI_SOURCE_DIR).parent_path() / "shared" / "meshes";
}

}  // namespace

std::optional<std::string> sharedMesh(const std::string& name) {
  const std::filesystem::path path = meshFolder() / name;
  if (!std::filesystem::is_regular_file(path)) return std::nullopt;
  return path.string();
}

std::vector<std::string> sharedMeshes(const std::string& folder) {
  std::vector<std::string> paths;
  if (!std::filesystem::is_directory(meshFolder() / folder)) return paths;
  for (const auto& entry : std::filesystem::directory_iterator(meshFolder() / folder)) {
    if (entry.is_regular_file()) paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace moduli
