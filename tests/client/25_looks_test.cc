#include <cmath>
#include <cstring>
#include <map>
#include <sstream>

#include "client/cli/map_ply.h"
#include "client/cli/textured_obj.h"
#include "core/mesh/read.h"
#include "tests/client/cli_test.h"
#include "tests/client/small_maps.h"

/// What the artist brought is kept in OBJ, textures beside it, and PLY.
namespace moduli::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// All lines but those of vertices and new points.
std::vector<std::string> looksOf(const std::string& text) {
  std::vector<std::string> kept;
  for (const std::string& line : linesOf(text)) {
    if (!line.starts_with("v ") && !line.starts_with("vt ")) kept.push_back(line);
  }
  return kept;
}

int countLines(const std::string& text, const std::string& prefix) {
  int count = 0;
  for (const std::string& line : linesOf(text)) count += line.starts_with(prefix) ? 1 : 0;
  return count;
}

std::string written(const ParameterizedMesh& mesh, const TexturedObjOptions& options) {
  std::string text;
  EXPECT_OK(writeTexturedObj(mesh, options, [&text](std::string_view piece) {
    text += piece;
    return Status();
  }));
  return text;
}

// A quad and two triangles in two groups, the last triangle not mapped.
const std::string kFile =
    "mtllib shop.mtl\no sign\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
    "vt 0.125 0.5\nvt 0.25 0.5\nvt 0.375 0.5\nvt 0.5 0.5\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0\n"
    "g left\nusemtl red\ns 1\nf 1/1/1 2/2/1 3/3/1 4/4/2\n"
    "g right\nusemtl blue\ns off\nf 2/1/1 5/2/1 6/3/1\nf 2/3/3 6/4/3 3/2/3\n";

ParameterizedMesh sign() {
  ParameterizedMesh map;
  map.result.set_target(v1::ParameterizationOptions::FLAT);
  map.positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0, 2, 1, 0};
  map.faces = {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2};
  map.points = {0, 0, 10, 0, 10, 10, 0, 10, 20, 0, 20, 10};
  map.corners = {0, 1, 2, 0, 2, 3, 1, 4, 5, -1, -1, -1};
  return map;
}

TEST(TexturedObj, KeepsWhatTheFileSays) {
  const ObjStatements kept = readObjStatements(kFile);
  const std::string text = written(sign(), {.kept = &kept, .materials = {}, .layout = {}});
  EXPECT_THAT(
      looksOf(text),
      ElementsAre("vn 0 0 1", "vn 0 1 0", "vn 1 0 0", "mtllib shop.mtl", "o sign", "g left",
                  "usemtl red", "s 1", "f 1/1/1 2/2/1 3/3/1", "f 1/1/1 3/3/1 4/4/2", "g right",
                  "usemtl blue", "s off", "f 2/2/1 5/5/1 6/6/1",
                  // Its old points 3, 4, 2 stand behind the six new ones, the first is gone.
                  "f 2/8/3 6/9/3 3/7/3"));
  EXPECT_EQ(countLines(text, "vt "), 9);
  EXPECT_THAT(text, HasSubstr("vt 20 10\nvt 0.25 0.5\nvt 0.375 0.5\nvt 0.5 0.5\n"));
}

TEST(TexturedObj, PiecesHaveTheLooksOfTheirFace) {
  // The third face is cut at the middle of its edge 4-5.
  ParameterizedMesh map = sign();
  map.result.set_refined(true);
  map.positions.insert(map.positions.end(), {2, 0.5, 0});
  map.points.insert(map.points.end(), {20, 5});
  map.faces = {0, 1, 2, 0, 2, 3, 1, 4, 6, 1, 6, 5, 1, 5, 2};
  map.corners = {0, 1, 2, 0, 2, 3, 1, 4, 6, 1, 6, 5, -1, -1, -1};
  map.parents = {0, 1, 2, 2, 3};
  const ObjStatements kept = readObjStatements(kFile);
  const std::string text = written(map, {.kept = &kept, .materials = {}, .layout = {}});
  EXPECT_THAT(text,
              HasSubstr("g right\nusemtl blue\ns off\nf 2/2 5/5 7/7\nf 2/2 7/7 6/6\nf 2/9/3"));
  // A server that does not tell whose pieces they are: nothing is kept.
  map.parents.clear();
  EXPECT_THAT(written(map, {.kept = &kept, .materials = {}, .layout = {}}),
              Not(HasSubstr("usemtl")));
}

TEST(TexturedObj, AnotherFilesLooksAreNotTaken) {
  const ObjStatements kept = readObjStatements("v 0 0 0\nv 1 0 0\nv 0 1 0\ng one\nf 1 2 3\n");
  EXPECT_EQ(written(sign(), {.kept = &kept, .materials = {}, .layout = {}}), written(sign(), {}));
}

TEST(TexturedObj, VerticesThatMoveLoseTheirNormals) {
  ParameterizedMesh map = sign();
  map.result.set_target(v1::ParameterizationOptions::SPHERE);
  map.points.clear();
  map.corners.assign(map.corners.size(), -1);
  const ObjStatements kept = readObjStatements(kFile);
  const std::string text = written(map, {.kept = &kept, .materials = {}, .layout = {}});
  EXPECT_EQ(countLines(text, "vn "), 0);
  EXPECT_THAT(text, HasSubstr("g right\nusemtl blue\ns off\nf 2/1 5/2 6/3\n")) << "points stay";
}

TEST(TexturedObj, ATextureTakesThePlaceOfMaterialsWhereItIs) {
  const ObjStatements kept = readObjStatements(kFile);
  const ParameterizedMesh map = sign();
  const std::string text =
      written(map, {.kept = &kept, .materials = "out.mtl", .layout = fitUnitSquare(map)});
  EXPECT_TRUE(text.starts_with("mtllib out.mtl\nv 0 0 0\n"));
  EXPECT_THAT(text, HasSubstr("\nvt 0 0\nvt 0.5 0\nvt 0.5 0.5\nvt 0 0.5\nvt 1 0\nvt 1 0.5\n"));
  EXPECT_THAT(text, HasSubstr("g left\ns 1\nusemtl moduli_checker\nf 1/1/1"));
  EXPECT_THAT(text, HasSubstr("g right\ns off\nf 2/2/1 5/5/1 6/6/1\nusemtl blue\nf 2/8/3"));
  const std::string materials = texturedMaterials("a b.png");
  EXPECT_THAT(materials, HasSubstr("newmtl moduli_checker\n"));
  EXPECT_THAT(materials, HasSubstr("\nmap_Kd a b.png\n"));
}

/// The `s`, `t` of every vertex behind three doubles, read plainly.
std::vector<std::pair<float, float>> pointsOf(const std::string& ply, std::size_t vertices) {
  std::size_t at = ply.find("end_header\n") + 11;
  std::vector<std::pair<float, float>> points;
  for (std::size_t i = 0; i < vertices && at + 32 <= ply.size(); ++i, at += 32) {
    float st[2];
    std::memcpy(st, ply.data() + at + 24, 8);
    points.emplace_back(st[0], st[1]);
  }
  return points;
}

TEST(MapPly, HasSplitVerticesBehindTheInputs) {
  const ParameterizedMesh map = gridMap(3, true);
  const std::string ply = parameterizationPly(map, "");
  Context context;
  const auto soup = readMesh(context, ply, {});
  ASSERT_OK(soup);
  ASSERT_EQ(soup->faces.size(), 18U);
  ASSERT_EQ(soup->vertices.size(), 54U);
  for (std::size_t v = 0; v < 16; ++v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(soup->vertices[v][static_cast<Eigen::Index>(axis)], map.positions[3 * v + axis]);
    }
  }
  const auto points = pointsOf(ply, soup->vertices.size());
  for (std::size_t k = 0; k < map.faces.size(); ++k) {
    const auto v = static_cast<std::size_t>(soup->faces[k / 3][k % 3]);
    const auto point = static_cast<std::size_t>(map.corners[k]);
    EXPECT_EQ(points[v].first, static_cast<float>(map.points[2 * point]));
    EXPECT_EQ(points[v].second, static_cast<float>(map.points[2 * point + 1]));
  }
  EXPECT_THAT(ply, HasSubstr("property float s\nproperty float t\n"));
}

TEST(MapPly, ATextureIsNamedAndScaledFor) {
  const std::string ply = parameterizationPly(sign(), "sign.png");
  EXPECT_THAT(ply, HasSubstr("\ncomment TextureFile sign.png\n"));
  const auto points = pointsOf(ply, 7);
  EXPECT_EQ(points[5], std::pair(1.0F, 0.5F));
  const std::string ball = parameterizationPly(ballMap(4), "");
  EXPECT_THAT(ball, Not(HasSubstr("property float")));
  Context context;
  EXPECT_OK(readMesh(context, ball, {}));
}

class Looks : public CliTest {};

// A disk, and a quad that is not mapped with --component largest.
TEST_F(Looks, TheCommandKeepsThemAndWritesATexture) {
  sample("disk.obj", {"disk", "resolution=3"});
  std::string file = "mtllib own.mtl\nvn 0 0 1\ng plate\nusemtl wood\n";
  for (const std::string& line : linesOf(read("disk.obj"))) file += line + "\n";
  file +=
      "v 10 0 0\nv 11 0 0\nv 11 1 0\nv 10 1 0\nvt 0.5 0.75\ng card\nusemtl paper\n"
      "f -4/1/1 -3/1/1 -2/1/1 -1/1/1\n";
  write("in.obj", file);
  const std::vector<std::string> words = {"parameterize", "in.obj",  "--to", "disk",
                                          "--component",  "largest", "-o",   "out.obj"};
  ASSERT_THAT(run(words), Succeeds());
  const std::string out = read("out.obj");
  EXPECT_THAT(out, HasSubstr("mtllib own.mtl\ng plate\nusemtl wood\nf "));
  EXPECT_THAT(out, HasSubstr("vt 0.5 0.75\nvn 0 0 1\n"));
  const std::vector<std::string> lines = linesOf(out);
  EXPECT_EQ(lines[lines.size() - 4], "g card");
  EXPECT_EQ(lines[lines.size() - 3], "usemtl paper");
  EXPECT_FALSE(exists("out.mtl"));

  std::vector<std::string> textured = words;
  textured.insert(textured.end(), {"--texture", "checker"});
  ASSERT_THAT(run(textured), Succeeds());
  EXPECT_THAT(read("out.obj"), HasSubstr("mtllib out.mtl\n"));
  EXPECT_THAT(read("out.mtl"), HasSubstr("map_Kd out.png\n"));
  EXPECT_TRUE(read("out.png").starts_with("\x89PNG"));
  textured[7] = "out.ply";
  ASSERT_THAT(run(textured), Succeeds());
  EXPECT_THAT(read("out.ply"), HasSubstr("comment TextureFile out.png\n"));
  EXPECT_THAT(run({"inspect", "out.ply"}), Succeeds());
}

TEST_F(Looks, FilesComeTogetherOrNotAtAll) {
  sample("disk.obj", {"disk", "resolution=3"});
  // A disk has no map to the sphere.
  ASSERT_THAT(run({"parameterize", "disk.obj", "--to", "sphere", "-o", "x.obj"}),
              FailsWithOneLine());
  EXPECT_FALSE(exists("x.obj"));
  const auto refused = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"parameterize", "disk.obj", "--to", "disk"});
    EXPECT_THAT(run(words), IsUsageError());
  };
  refused({"--texture", "checker"});
  refused({"--texture", "checker", "-o", "x.glb"});
  refused({"--texture", "checker", "-o", "x.obj", "--picture", "x.png"});
  refused({"--texture", "stripes", "-o", "x.obj"});
  refused({"--draw", "scale"});
  refused({"--draw", "scale", "-o", "x.obj"});
  refused({"-o", "x.stl"});
  for (const char* name : {"x.obj", "x.mtl", "x.png", "x.glb"}) EXPECT_FALSE(exists(name)) << name;
}

}  // namespace
}  // namespace moduli::cli
