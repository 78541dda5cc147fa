#include "core/mesh/obj_statements.h"

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/mesh/read.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using testing::ElementsAre;

std::vector<std::string> texts(const ObjStatements& statements) {
  std::vector<std::string> lines;
  for (const auto& [face, text] : statements.statements) {
    lines.push_back(std::to_string(face) + " " + text);
  }
  return lines;
}

TEST(ObjStatements, HoldFromTheNextTriangleOn) {
  const auto read = readObjStatements(
      "mtllib a.mtl b.mtl\no thing\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 2 2\n"
      "g front # not a comment\nusemtl red\ns 1\nf 1 2 3 4 5\n"
      "s off\nmg 1 0.5\nf 1 2 3\nusemtl blue\n");
  EXPECT_THAT(texts(read),
              ElementsAre("0 mtllib a.mtl b.mtl", "0 o thing", "0 g front # not a comment",
                          "0 usemtl red", "0 s 1", "3 s off", "3 mg 1 0.5", "4 usemtl blue"));
  ASSERT_EQ(read.texture.size(), 4U) << "a pentagon is three triangles";
  EXPECT_EQ(read.texture[0], (Triangle{kNone, kNone, kNone}));
}

TEST(ObjStatements, CornersNameRowsByEveryFormOfIndex) {
  const auto read = readObjStatements(
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0 # first\nvt 1 0\nvt 1 1\nvn 0 0 1\n"
      "f 1/1/1 2/2/1 3/3/1 4/-3/-1\nf 1//1 2//1 3//1\nf 1/1 2/3 3/2\nvt 0.5 0.25\nf 1/-1 2/-2 3/1\n"
      "fo 1/4/1 2/1/1 3/1/1\nf 1/9 2/1 3/1\nf 1/0 2/1 3/1\nf 1 2 3\n");
  EXPECT_THAT(read.texture_points, ElementsAre("0 0", "1 0", "1 1", "0.5 0.25"));
  EXPECT_THAT(read.normals, ElementsAre("0 0 1"));
  const Triangle none = {kNone, kNone, kNone};
  EXPECT_THAT(read.texture,
              ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 0}, none, Triangle{0, 2, 1},
                          Triangle{3, 2, 0}, Triangle{3, 0, 0}, none, none, none));
  EXPECT_THAT(read.normal, ElementsAre(Triangle{0, 0, 0}, Triangle{0, 0, 0}, Triangle{0, 0, 0},
                                       none, none, Triangle{0, 0, 0}, none, none, none));
}

TEST(ObjStatements, LinesAreJoinedAndEndAnyWay) {
  const auto read = readObjStatements(
      "\xEF\xBB\xBFv 0 0 0\rv 1 0 0\r\nv \\\n 1 1 0\nvt 0 \\\r\n 0.5\nvt 1 1\n# f 1 2 3 \\\n"
      "usemtl ends\\\nf 1/1 \\\n 2/2 \\\r\n3/2\r\ng last");
  EXPECT_THAT(texts(read), ElementsAre("0 usemtl ends\\", "1 g last"));
  ASSERT_EQ(read.texture.size(), 1U);
  EXPECT_EQ(read.texture[0], (Triangle{0, 1, 1}));
  EXPECT_EQ(read.texture_points.size(), 2U);
}

TEST(ObjStatements, HaveTheTrianglesThatTheReaderHas) {
  const std::vector<std::string> paths = sharedMeshes("closed_g0");
  if (paths.empty()) GTEST_SKIP() << "needs the shared meshes: set MODULI_SHARED";
  for (const std::string& path : paths) {
    if (!path.ends_with(".obj")) continue;
    Context context;
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    const std::string bytes = text.str();
    ReadOptions options;
    options.name = path;
    const auto soup = readMesh(context, bytes, options);
    if (!soup.ok()) continue;
    EXPECT_EQ(readObjStatements(bytes).texture.size(), soup->faces.size()) << path;
  }
}

TEST(ObjStatements, NoBytesBreakThem) {
  std::string bytes =
      "v 0 0 0\nf 1/1/1 2//3 3/ /2 / // /// 1/2/3/4\nf 1/99999999999999999999 2 3\nvt\nvn #\n";
  bytes += std::string("f \\\n\\\n\0\xFF 1\n", 11);
  for (std::size_t end = 0; end <= bytes.size(); ++end) {
    const auto read = readObjStatements(std::string_view(bytes).substr(0, end));
    EXPECT_EQ(read.texture.size(), read.normal.size());
  }
}

}  // namespace
}  // namespace moduli
