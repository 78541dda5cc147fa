#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/core/mesh/read_helpers.h"

namespace moduli {
namespace {

struct Row {
  std::string file;
  std::string vertices;
  std::string faces;
};

// The columns file, V and F of the table of shared meshes; quoted fields come after them only.
std::vector<Row> manifest(const std::string& path) {
  std::vector<Row> rows;
  std::ifstream table(path);
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    std::vector<std::string> fields(1);
    bool quoted_field = false;
    for (const char c : line) {
      if (c == '"') {
        quoted_field = !quoted_field;
      } else if (c == ',' && !quoted_field) {
        fields.emplace_back();
      } else {
        fields.back() += c;
      }
    }
    rows.push_back({fields.at(0), fields.at(7), fields.at(8)});
  }
  return rows;
}

TEST(ReadShared, EveryFileHasTheVerticesAndFacesOfItsTable) {
  MODULI_NEED_SHARED_MESH(table, "MANIFEST.csv");
  const std::filesystem::path folder = std::filesystem::path(table).parent_path();
  std::size_t files = 0;
  for (const Row& row : manifest(table)) {
    ++files;
    Context context;
    const auto soup = readMeshFile(context, folder / row.file);
    if (row.vertices.empty()) {
      EXPECT_FALSE(soup.ok()) << row.file;
      continue;
    }
    ASSERT_OK(soup) << row.file;
    EXPECT_EQ(std::to_string(soup->faces.size()), row.faces) << row.file;
    // The table counts the corners of STL files before welding.
    const bool welded = row.file.find("stl_box") != std::string::npos;
    EXPECT_EQ(std::to_string(soup->vertices.size()), welded ? "8" : row.vertices) << row.file;
  }
  EXPECT_GT(files, 50U);
}

TEST(ReadShared, TheFilesThatAreNoMeshSayWhy) {
  MODULI_NEED_SHARED_MESH(commas, "bad/gpeyre__hole_sphere3.off");
  MODULI_NEED_SHARED_MESH(empty, "bad/trimesh__empty.obj");
  Context context;
  EXPECT_THAT(readMeshFile(context, commas),
              FailsAt(Reason::kSyntaxError, commas + ":3: '0.000000,' is not a coordinate"));
  EXPECT_THAT(readMeshFile(context, empty), FailsAt(Reason::kEmpty, empty + ":2: "));
}

}  // namespace
}  // namespace moduli
