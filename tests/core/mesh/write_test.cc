#include "core/mesh/write.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/core/mesh/read_helpers.h"

namespace moduli {
namespace {

TriangleSoup oneTriangle() {
  return {{{0.1, -0.0, 1e300}, {1, 0, 0}, {0, 1, 0.25}}, {{0, 1, 2}}};
}

TEST(Write, TextIsPlainAndShort) {
  EXPECT_EQ(*writeMesh(oneTriangle(), MeshFormat::kObj),
            "v 0.1 -0 1e+300\nv 1 0 0\nv 0 1 0.25\nf 1 2 3\n");
  EXPECT_EQ(*writeMesh(oneTriangle(), MeshFormat::kOff),
            "OFF\n3 1 0\n0.1 -0 1e+300\n1 0 0\n0 1 0.25\n3 0 1 2\n");
  EXPECT_EQ(
      *writeMesh(oneTriangle(), MeshFormat::kPly),
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
      "property double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0.1 -0 1e+300\n1 0 0\n0 1 0.25\n3 0 1 2\n");
  const TriangleSoup flat = {{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(*writeMesh(flat, MeshFormat::kStl),
            "solid mesh\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 2 0\n"
            "endloop\nendfacet\nendsolid mesh\n");
}

TEST(Write, BinarySizesAreThoseOfTheFormats) {
  const auto stl = writeMesh(tetrahedronSoup(), MeshFormat::kStl, Encoding::kBinary);
  ASSERT_OK(stl);
  EXPECT_EQ(stl->size(), 84U + 4 * 50);
  EXPECT_FALSE(stl->starts_with("solid"));
  const auto ply = writeMesh(tetrahedronSoup(), MeshFormat::kPly, Encoding::kBinary);
  ASSERT_OK(ply);
  EXPECT_EQ(ply->size() - (ply->find("end_header\n") + 11), 4U * 24 + 4 * 13);
}

TEST(Write, BinaryStlNormalsAreUnitOrZeroAtAnyScale) {
  const auto normalOf = [](const TriangleSoup& soup) {
    const auto bytes = writeMesh(soup, MeshFormat::kStl, Encoding::kBinary);
    EXPECT_OK(bytes);
    float normal[3];
    std::memcpy(normal, bytes->data() + 84, sizeof(normal));
    return Eigen::Vector3f(normal[0], normal[1], normal[2]);
  };
  for (const double scale : {1e-40, 1.0, 1e38}) {
    EXPECT_EQ(normalOf({{{0, 0, 0}, {scale, 0, 0}, {0, 0, scale}}, {{0, 1, 2}}}),
              Eigen::Vector3f(0, -1, 0));
  }
  EXPECT_EQ(normalOf({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}), Eigen::Vector3f(0, 0, 0));
  EXPECT_EQ(normalOf({{{0, NAN, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}), Eigen::Vector3f(0, 0, 0));
}

TEST(Write, WhatAFormatCannotHoldIsRefused) {
  EXPECT_THAT(writeMesh(oneTriangle(), MeshFormat::kObj, Encoding::kBinary),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(writeMesh(oneTriangle(), MeshFormat::kOff, Encoding::kBinary),
              FailsWith(Reason::kInvalidOption));
  const auto stl = writeMesh(oneTriangle(), MeshFormat::kStl, Encoding::kBinary);
  EXPECT_THAT(stl, FailsAt(Reason::kInvalidOption, "vertex 0 lies beyond the range"));
}

class WriteFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "moduli_write_test_" + std::to_string(::getpid());
    std::filesystem::create_directory(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  static std::string contentOf(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }
  std::size_t filesInFolder() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_), {}));
  }
  std::string folder_;
};

TEST_F(WriteFile, ReplacesTheWholeFileAndLeavesNothingElse) {
  const std::string path = folder_ + "/a.off";
  ASSERT_OK(writeFile(path, "long content"));
  ::chmod(path.c_str(), 0640);
  ASSERT_OK(writeFile(path, std::string("a\0b", 3)));
  EXPECT_EQ(contentOf(path), std::string("a\0b", 3));
  EXPECT_EQ(filesInFolder(), 1U);
  struct stat about {};
  ASSERT_EQ(::stat(path.c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 0777U, 0640U);
}

TEST_F(WriteFile, KeepsASymbolicLink) {
  ASSERT_OK(writeFile(folder_ + "/a.off", "old"));
  std::filesystem::create_symlink("a.off", folder_ + "/link.off");
  ASSERT_OK(writeFile(folder_ + "/link.off", "new"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ + "/link.off"));
  EXPECT_EQ(contentOf(folder_ + "/a.off"), "new");
}

TEST_F(WriteFile, FailuresNameThePathAndLeaveNothing) {
  EXPECT_THAT(writeFile(folder_ + "/no/a.off", "x"),
              FailsAt(Reason::kFileUnwritable, folder_ + "/no/a.off: "));
  EXPECT_THAT(writeFile(folder_, "x"), FailsAt(Reason::kFileUnwritable, folder_ + ": "));
  EXPECT_EQ(filesInFolder(), 0U);
}

TEST_F(WriteFile, DevicesAreWrittenToAndStay) {
  EXPECT_OK(writeFile("/dev/null", "x"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

}  // namespace
}  // namespace moduli
