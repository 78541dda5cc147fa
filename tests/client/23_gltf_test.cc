#include <cmath>
#include <limits>
#include <set>

#include "client/cli/map_gltf.h"
#include "client/cli/texture_layout.h"
#include "core/mesh/gltf.h"
#include "tests/client/cli_test.h"
#include "tests/client/glb.h"
#include "tests/client/obj.h"
#include "tests/client/small_maps.h"

/// glTF files: what is in them, and what the Khronos validator says.
namespace moduli::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// The validator is content, or not there: see `skipped`.
class Gltf : public CliTest {
 protected:
  void expectValid(const std::string& bytes) {
    const std::string fault = gltfFault(bytes, path("."));
    if (fault.starts_with("skip: ")) {
      skipped_ = fault;
    } else {
      EXPECT_EQ(fault, "");
    }
  }
  std::string skipped_;
};

#define MODULI_NEED_VALIDATOR() \
  if (!skipped_.empty()) GTEST_SKIP() << skipped_.substr(6)

GltfModel triangle() {
  GltfPart part;
  part.positions = {0, 0, 0, 1, 0, 0, 0, 1, -2};
  part.indices = {0, 1, 2};
  GltfModel model;
  model.parts.push_back(part);
  return model;
}

TEST(WriteGltf, HasBoundsOfPositionsAndNothingElse) {
  const auto bytes = writeGltf(triangle());
  ASSERT_OK(bytes);
  const Glb glb = Glb::parse(*bytes);
  ASSERT_EQ(glb.primitives(), 1);
  const Json accessor =
      glb.accessor(static_cast<int>(glb.primitive(0)["attributes"]["POSITION"].number()));
  const auto row = [&](const char* key) {
    return std::array{accessor[key].at(0).number(), accessor[key].at(1).number(),
                      accessor[key].at(2).number()};
  };
  EXPECT_THAT(row("min"), ElementsAre(0, 0, -2));
  EXPECT_THAT(row("max"), ElementsAre(1, 1, 0));
  EXPECT_EQ(glb.indices(0), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_FALSE(glb.json().has("images"));
  EXPECT_FALSE(glb.json().has("textures"));
}

TEST(WriteGltf, RefusesWhatDoesNotFit) {
  const auto refused = [](auto change) {
    GltfModel model = triangle();
    change(model.parts[0]);
    return writeGltf(model);
  };
  const auto kWrong = Reason::kInvalidOption;
  EXPECT_THAT(refused([](auto& part) { part.indices[1] = 3; }), FailsWith(kWrong));
  EXPECT_THAT(refused([](auto& part) { part.indices.pop_back(); }), FailsWith(kWrong));
  EXPECT_THAT(refused([](auto& part) { part.positions.pop_back(); }), FailsWith(kWrong));
  EXPECT_THAT(refused([](auto& part) { part.texture = {0, 0}; }), FailsWith(kWrong));
  EXPECT_THAT(refused([](auto& part) { part.normals = {0, 0, 1}; }), FailsWith(kWrong));
  EXPECT_THAT(refused([](auto& part) { part.colors = {0, 0, 1}; }), FailsWith(kWrong));
  EXPECT_THAT(refused([](auto& part) { part.textured = true; }), FailsWith(kWrong));
  EXPECT_THAT(refused([](auto& part) {
                part.texture.assign(6, 0.5F);
                part.textured = true;  // But the model has none.
              }),
              FailsWith(kWrong));
  EXPECT_THAT(
      refused([](auto& part) { part.positions[4] = std::numeric_limits<float>::infinity(); }),
      FailsWith(kWrong));
  ParameterizedMesh far = gridMap(2, false);
  far.positions[4] = 1e39;  // No float32.
  EXPECT_THAT(parameterizationGltf(far, "far"), FailsWith(kWrong));
}

TEST(LinearLight, IsTheStandardsCurve) {
  EXPECT_EQ(linearLight(0), 0);
  EXPECT_NEAR(linearLight(1), 1, 1e-15);
  // IEC 61966-2-1: the middle grey 188 of 255 is half of the light, to the step of a byte.
  EXPECT_NEAR(linearLight(188.0 / 255), 0.5, 0.004);
  EXPECT_NEAR(linearLight(0.04045), 0.04045 / 12.92, 1e-15);
  EXPECT_NEAR(linearLight(0.04046), 0.04045 / 12.92, 2e-6);
}

TEST(SplitVertices, KeepsWholeVerticesAndSplitsAtSeams) {
  const ParameterizedMesh whole = gridMap(4, false);
  const SplitVertices same = splitVertices(whole);
  EXPECT_EQ(same.vertex.size(), 25U);
  EXPECT_EQ(same.corner, whole.faces);
  ParameterizedMesh torn = gridMap(4, true);
  const SplitVertices split = splitVertices(torn);
  // One for each corner: no two share a point, and every vertex is in some face.
  EXPECT_EQ(split.vertex.size(), torn.corners.size());
  std::set<std::int32_t> points(split.point.begin(), split.point.end());
  EXPECT_EQ(points.size(), torn.corners.size());
  for (std::size_t k = 0; k < torn.faces.size(); ++k) {
    EXPECT_EQ(split.vertex[static_cast<std::size_t>(split.corner[k])], torn.faces[k]);
    EXPECT_EQ(split.point[static_cast<std::size_t>(split.corner[k])], torn.corners[k]);
  }
}

TEST(TextureLayout, FillsTheUnitSquareInItsLongerDirection) {
  ParameterizedMesh map = gridMap(3, false);
  for (std::size_t i = 0; i < map.points.size(); i += 2) {
    map.points[i] = 8 * map.points[i] - 3;
    map.points[i + 1] = 2 * map.points[i + 1] + 100;
  }
  const TextureLayout layout = fitUnitSquare(map);
  EXPECT_DOUBLE_EQ(layout.scale, 1.0 / 8);
  EXPECT_DOUBLE_EQ(layout.s(-3), 0);
  EXPECT_DOUBLE_EQ(layout.s(5), 1);
  EXPECT_DOUBLE_EQ(layout.t(102), 0.25);
  std::fill(map.corners.begin(), map.corners.end(), -1);
  EXPECT_EQ(fitUnitSquare(map).scale, 1);
}

// Points (u, v) of the plane are at (s, 1 - t), by what the extras tell.
void expectPointsOf(const ParameterizedMesh& map, const Glb& glb, int primitive,
                    const std::vector<std::size_t>& faces) {
  const Json extras = glb.json()["nodes"].at(0)["extras"];
  const double scale = extras["uv_scale"].number();
  const double u0 = extras["uv_origin_u"].number(), v0 = extras["uv_origin_v"].number();
  const auto uv = glb.attribute(primitive, "TEXCOORD_0");
  const auto xyz = glb.attribute(primitive, "POSITION");
  const auto indices = glb.indices(primitive);
  ASSERT_EQ(indices.size(), 3 * faces.size());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::size_t k = 3 * faces[i / 3] + i % 3;
    const auto vertex = static_cast<std::size_t>(map.faces[k]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(xyz[3 * indices[i] + axis], static_cast<float>(map.positions[3 * vertex + axis]));
    }
    const auto point = static_cast<std::size_t>(map.corners[k]);
    // Rounded once to float32 near 1.
    EXPECT_NEAR(uv[2 * indices[i]], scale * (map.points[2 * point] - u0), 1e-7);
    EXPECT_NEAR(uv[2 * indices[i] + 1], 1 - scale * (map.points[2 * point + 1] - v0), 1e-7);
  }
}

TEST_F(Gltf, AMapToThePlaneHasItsPointsAndACheckerboard) {
  const ParameterizedMesh map = gridMap(6, true);
  const auto bytes = parameterizationGltf(map, "grid \xC3\xA9.obj");
  ASSERT_OK(bytes);
  const Glb glb = Glb::parse(*bytes);
  ASSERT_EQ(glb.primitives(), 1);
  std::vector<std::size_t> all(72);
  for (std::size_t f = 0; f < all.size(); ++f) all[f] = f;
  expectPointsOf(map, glb, 0, all);
  EXPECT_EQ(glb.json()["nodes"].at(0)["name"].string(), "grid \xC3\xA9.obj");
  EXPECT_EQ(glb.json()["nodes"].at(0)["extras"]["target"].string(), "FLAT");
  EXPECT_TRUE(glb.image().starts_with("\x89PNG"));
  // The grid is tilted to z = x / 2: all normals are (-1, 0, 2) / sqrt 5.
  const auto normals = glb.attribute(0, "NORMAL");
  for (std::size_t i = 0; i < normals.size(); i += 3) {
    EXPECT_NEAR(normals[i], -1 / std::sqrt(5.0), 1e-7);
    EXPECT_NEAR(normals[i + 2], 2 / std::sqrt(5.0), 1e-7);
  }
  expectValid(*bytes);
  MODULI_NEED_VALIDATOR();
}

TEST_F(Gltf, FacesThatAreNotMappedStandApartWithoutPoints) {
  ParameterizedMesh map = gridMap(4, false);
  std::vector<std::size_t> mapped;
  for (std::size_t f = 0; f < 32; ++f) {
    if (f % 3 != 0) {
      mapped.push_back(f);
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) map.corners[3 * f + k] = -1;
  }
  const auto bytes = parameterizationGltf(map, "part");
  ASSERT_OK(bytes);
  const Glb glb = Glb::parse(*bytes);
  ASSERT_EQ(glb.primitives(), 2);
  expectPointsOf(map, glb, 0, mapped);
  EXPECT_EQ(glb.indices(1).size(), 3 * (32 - mapped.size()));
  EXPECT_TRUE(glb.attribute(1, "TEXCOORD_0").empty());
  EXPECT_NE(glb.primitive(0)["material"].number(), glb.primitive(1)["material"].number());
  expectValid(*bytes);
  MODULI_NEED_VALIDATOR();
}

TEST_F(Gltf, ASphereHasNeitherPointsNorATexture) {
  const auto bytes = parameterizationGltf(ballMap(8), "ball");
  ASSERT_OK(bytes);
  const Glb glb = Glb::parse(*bytes);
  ASSERT_EQ(glb.primitives(), 1);
  EXPECT_TRUE(glb.attribute(0, "TEXCOORD_0").empty());
  EXPECT_FALSE(glb.json().has("images"));
  EXPECT_FALSE(glb.json()["nodes"].at(0)["extras"].has("uv_scale"));
  const auto normals = glb.attribute(0, "NORMAL"), positions = glb.attribute(0, "POSITION");
  for (std::size_t i = 0; i < normals.size(); i += 3) {
    double along = 0;
    for (std::size_t k = i; k < i + 3; ++k) along += double(normals[k]) * double(positions[k]);
    EXPECT_GT(along, 0.98) << "outwards, up to the size of the faces";
  }
  expectValid(*bytes);
  MODULI_NEED_VALIDATOR();
}

TEST_F(Gltf, VerticesBearColorsInLinearLight) {
  const ParameterizedMesh map = gridMap(3, false);
  const auto bytes = parameterizationGltf(map, "colours", [&](std::size_t corner) {
    return map.faces[corner] == 5 ? Color{255, 0, 188} : Color{0, 0, 0};
  });
  ASSERT_OK(bytes);
  const Glb glb = Glb::parse(*bytes);
  const auto colors = glb.attribute(0, "COLOR_0"), positions = glb.attribute(0, "POSITION");
  int lit = 0;
  for (std::size_t i = 0; i < colors.size(); i += 3) {
    if (colors[i] == 0) continue;
    ++lit;
    EXPECT_EQ(colors[i], 1);
    EXPECT_EQ(colors[i + 1], 0);
    EXPECT_NEAR(colors[i + 2], linearLight(188.0 / 255), 1e-7);
    EXPECT_EQ(positions[i], static_cast<float>(map.positions[15]));
  }
  EXPECT_EQ(lit, 1);
  EXPECT_FALSE(glb.json().has("images"));
  expectValid(*bytes);
  MODULI_NEED_VALIDATOR();
}

TEST_F(Gltf, OddMapsAreStillFiles) {
  ParameterizedMesh flat = gridMap(2, false);
  std::fill(flat.points.begin(), flat.points.end(), 0.25);
  ParameterizedMesh needle = gridMap(2, false);
  std::fill(needle.positions.begin(), needle.positions.end(), 1e-30);
  for (const ParameterizedMesh& map : {ParameterizedMesh(), flat, needle}) {
    // Bytes that are no UTF-8 make no name.
    const auto bytes = parameterizationGltf(map, "\xFF\xFE");
    ASSERT_OK(bytes);
    EXPECT_EQ(Glb::parse(*bytes).primitives(), map.faces.empty() ? 0 : 1);
    expectValid(*bytes);
  }
  MODULI_NEED_VALIDATOR();
}

TEST_F(Gltf, TheValidatorSeesAFault) {
  auto bytes = parameterizationGltf(gridMap(2, false), "grid");
  ASSERT_OK(bytes);
  const std::size_t at = bytes->find("\"max\":[1.0");
  ASSERT_NE(at, std::string::npos);
  bytes->replace(at, 10, "\"max\":[2.0");
  const std::string fault = gltfFault(*bytes, path("."));
  if (fault.starts_with("skip: ")) GTEST_SKIP() << fault.substr(6);
  EXPECT_THAT(fault, HasSubstr("ACCESSOR_MAX_MISMATCH"));
}

TEST_F(Gltf, TheCommandWritesEveryTarget) {
  sample("torus.obj", {"torus", "resolution=12"});
  sample("sphere.off", {"spheroid", "resolution=5"});
  sample("disk.ply", {"disk", "resolution=5"});
  sample("double.off", {"genus", "genus=2", "resolution=4"});
  const std::vector<std::array<std::string, 2>> runs = {{"torus.obj", "flat"},
                                                        {"sphere.off", "sphere"},
                                                        {"disk.ply", "disk"},
                                                        {"disk.ply", "flat"},
                                                        {"double.off", "hyperbolic"}};
  for (const auto& [mesh, target] : runs) {
    EXPECT_THAT(run({"parameterize", mesh, "--to", target, "-o", "out.glb"}), Succeeds()) << mesh;
    const Glb glb = Glb::parse(read("out.glb"));
    EXPECT_EQ(glb.json().has("images"), target != "sphere");
    expectValid(read("out.glb"));
    // The same map as the OBJ has.
    EXPECT_THAT(run({"parameterize", mesh, "--to", target, "-o", "out.obj"}), Succeeds());
    const Obj obj = Obj::parse(read("out.obj"));
    EXPECT_EQ(glb.indices(0).size(), 3 * obj.faces.size());
    const auto uv = glb.attribute(0, "TEXCOORD_0");
    if (target == "sphere") continue;
    const double scale = glb.json()["nodes"].at(0)["extras"]["uv_scale"].number();
    const auto first = glb.indices(0)[0], second = glb.indices(0)[1];
    const auto edge = obj.points[obj.corners[0][1]] - obj.points[obj.corners[0][0]];
    EXPECT_NEAR(uv[2 * second] - uv[2 * first], scale * edge.real(), 2e-7);
    EXPECT_NEAR(uv[2 * second + 1] - uv[2 * first + 1], -scale * edge.imag(), 2e-7);
  }
  MODULI_NEED_VALIDATOR();
}

}  // namespace
}  // namespace moduli::cli
