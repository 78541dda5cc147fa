#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/core/testing.h"

/// The house has floors: a room includes its own headers and those of rooms below it, no others.
namespace moduli {
namespace {

namespace fs = std::filesystem;

// Lowest first. Rooms that do not exist yet keep their place.
const std::vector<std::string> kFloors = {
    "core/base",       "core/picture",   "core/mesh",     "core/linalg",       "core/optimize",
    "core/topology",   "core/intrinsic", "core/forms",    "core/ricci",        "core/spherical",
    "core/hyperbolic", "core/signature", "core/matching", "core/parameterize", "core/retrieval",
    "proto",           "server/rpc",     "server/store",  "server/service",    "server/server.",
    "server/daemon",   "client/cpp",     "client/cli"};

// What a room may not include although it lies below: thin clients know no insides of the core.
const std::map<std::string, std::vector<std::string>> kForbidden = {
    {"client/cpp",
     {"core/linalg", "core/topology", "core/intrinsic", "core/forms", "core/ricci",
      "core/spherical", "core/matching", "core/parameterize", "core/retrieval", "server/store",
      "server/service", "server/daemon"}},
    {"client/cli",
     {"core/linalg", "core/topology", "core/intrinsic", "core/forms", "core/ricci",
      "core/spherical", "core/matching", "core/parameterize", "core/retrieval", "server/store",
      "server/daemon"}},
    {"core/picture", {"core/mesh"}},
    {"core/mesh", {"core/picture"}},
    {"server/store", {"server/rpc", "proto"}},
};

// But for what is in files: of these a client knows meshes and intrinsic triangulations.
const std::set<std::string> kFileContents = {"core/intrinsic/intrinsic_json.h",
                                             "core/intrinsic/intrinsic_samples.h"};

// Headers that may appear in one adapter each, and nowhere else.
const std::map<std::string, std::string> kHeavy = {
    {"flann/", "core/retrieval"},    {"OpenMesh/", "core/mesh"},    {"cholmod.h", "core/linalg"},
    {"nlohmann/", "core/intrinsic"}, {"sqlite3.h", "server/store"}, {"zstd.h", "server/store"},
    {"expat.h", "core/mesh"},        {"zlib.h", "core/mesh"},       {"tiny_gltf.h", "core/mesh"}};

std::optional<std::size_t> floorOf(const std::string& path) {
  for (std::size_t i = 0; i < kFloors.size(); ++i) {
    if (path.starts_with(kFloors[i])) return i;
  }
  return std::nullopt;
}

struct Include {
  std::string file;
  std::string target;
};

std::vector<std::string> sourceFiles() {
  std::vector<std::string> files;
  for (const std::string top : {"core", "server", "client"}) {
    const fs::path root = fs::path(MODULI_SOURCE_DIR) / top;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cc") continue;
      files.push_back(fs::relative(entry.path(), MODULI_SOURCE_DIR).generic_string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<Include> includes() {
  static const std::regex pattern(R"re(^\s*#\s*include\s*[<"]([^>"]+)[>"])re");
  std::vector<Include> found;
  for (const std::string& file : sourceFiles()) {
    std::ifstream in(fs::path(MODULI_SOURCE_DIR) / file);
    for (std::string line; std::getline(in, line);) {
      std::smatch match;
      if (std::regex_search(line, match, pattern)) found.push_back({file, match[1]});
    }
  }
  return found;
}

// The floor that an include leads to; "moduli/v1/..." is the generated API.
std::string roomPath(const std::string& target) {
  return target.starts_with("moduli/v1/") ? "proto/" + target : target;
}

bool climbs(const Include& include) {
  const auto from = floorOf(include.file);
  const auto to = floorOf(roomPath(include.target));
  return from && to && *to > *from;
}

TEST(House, NoRoomIncludesARoomAboveIt) {
  const auto all = includes();
  ASSERT_GT(all.size(), 50U) << "the scan found hardly any include: is the source tree there?";
  for (const Include& include : all) {
    EXPECT_FALSE(climbs(include)) << include.file << " includes " << include.target;
  }
}

TEST(House, EveryFileStandsOnAFloor) {
  for (const std::string& file : sourceFiles()) {
    EXPECT_TRUE(floorOf(file)) << file << " is in no room that the house knows";
  }
}

TEST(House, AClimbingIncludeIsSeen) {
  EXPECT_TRUE(climbs({"core/mesh/read.cc", "core/forms/cotan.h"}));
  EXPECT_TRUE(climbs({"core/signature/compute.cc", "moduli/v1/mesh.pb.h"}));
  EXPECT_FALSE(climbs({"core/forms/cotan.h", "core/mesh/connectivity.h"}));
}

TEST(House, RoomsKeepApartWhatMustNotMeet) {
  for (const Include& include : includes()) {
    if (kFileContents.contains(include.target)) continue;
    for (const auto& [room, targets] : kForbidden) {
      if (!include.file.starts_with(room)) continue;
      for (const std::string& target : targets) {
        EXPECT_FALSE(roomPath(include.target).starts_with(target))
            << include.file << " includes " << include.target;
      }
    }
  }
}

TEST(House, HeavyHeadersStayInOneAdapter) {
  for (const Include& include : includes()) {
    for (const auto& [header, room] : kHeavy) {
      if (!include.target.starts_with(header)) continue;
      EXPECT_TRUE(include.file.starts_with(room)) << include.file << " includes " << include.target;
      EXPECT_TRUE(include.file.ends_with(".cc") || header == "sqlite3.h")
          << include.file << " spreads " << include.target;
    }
  }
}

}  // namespace
}  // namespace moduli
