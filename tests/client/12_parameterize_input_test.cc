#include <filesystem>
#include <numbers>

#include "tests/client/cli_test.h"
#include "tests/client/obj.h"

/// parameterize: side files, cones that do not fit, and what becomes of the input's elements.
namespace moduli {
namespace {

using testing::HasSubstr;

class ParameterizeInput : public CliTest {
 protected:
  ProcessResult flat(const std::string& mesh, std::vector<std::string> words = {}) const {
    words.insert(words.begin(), {"parameterize", mesh, "--to", "flat"});
    return run(words);
  }

  Obj map(const std::string& mesh, std::vector<std::string> words = {}) const {
    words.insert(words.end(), {"-o", "out.obj"});
    EXPECT_THAT(flat(mesh, words), Succeeds());
    return Obj::parse(read("out.obj"));
  }

  /// What a torus with these cones fails with.
  std::string conesError(const std::string& cones, std::vector<std::string> words = {}) const {
    sample("torus.off", {"torus", "resolution=4"});  // 32 vertices.
    write("cones.txt", cones);
    words.insert(words.end(), {"--cones", "cones.txt", "-o", "out.obj"});
    const ProcessResult result = flat("torus.off", words);
    EXPECT_THAT(result, FailsWithOneLine());
    EXPECT_FALSE(exists("out.obj"));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path(".")), {}), 2)
        << "something was left behind";
    return result.err;
  }
};

/// A torus of m x n squares, as quadrilaterals; its first vertex is the one behind `skipped`.
std::string quadTorus(int m, int n, int skipped = 0) {
  std::string text;
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < n; ++j) {
      const double u = 2 * std::numbers::pi * i / m, v = 2 * std::numbers::pi * j / n;
      const double r = 2 + std::cos(v);
      text += "v " + std::to_string(r * std::cos(u)) + " " + std::to_string(r * std::sin(u)) + " " +
              std::to_string(std::sin(v)) + "\n";
    }
  }
  const auto vertex = [&](int i, int j) {
    return " " + std::to_string(i % m * n + j % n + 1 + skipped);
  };
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < n; ++j) {
      text +=
          "f" + vertex(i, j) + vertex(i + 1, j) + vertex(i + 1, j + 1) + vertex(i, j + 1) + "\n";
    }
  }
  return text;
}

TEST_F(ParameterizeInput, WhatIsWrongWithASideFileIsToldByLine) {
  EXPECT_THAT(conesError("# one\n\n3 1 2\n"),
              HasSubstr("cones.txt:3: has 3 words instead of a vertex and a curvature "
                        "(SYNTAX_ERROR); write 'vertex curvature' on each line, in radians"));
  EXPECT_THAT(conesError("3\n"), HasSubstr("cones.txt:1: has 1 word instead"));
  EXPECT_THAT(conesError("0,1\n3.5 1\n"), HasSubstr("cones.txt:2: '3.5' is not a vertex's number"));
  EXPECT_THAT(conesError("3 pi\n"), HasSubstr("cones.txt:1: 'pi' is not a curvature"));
  EXPECT_THAT(conesError("3 nan\n"), HasSubstr("cones.txt:1: 'nan' is not a curvature"));
  EXPECT_THAT(conesError("3 1e999\n"), HasSubstr("cones.txt:1: "));
  EXPECT_THAT(conesError("-1 1\n"),
              HasSubstr("cones.txt:1: there is no vertex '-1' (INDEX_OUT_OF_RANGE)"));
  EXPECT_THAT(conesError("99999999999 1\n"), HasSubstr("INDEX_OUT_OF_RANGE"));
  EXPECT_THAT(conesError("\xEF\xBB\xBF"
                         "3 1\n4 1\n3 2\n"),
              HasSubstr("cones.txt:3: vertex 3 has a curvature in cones.txt:1 already"));
  EXPECT_THAT(conesError(std::string("3 1\0\n", 5)), HasSubstr("cones.txt:1: "));
}

TEST_F(ParameterizeInput, ASideFileThatIsNotThereIsToldFromARule) {
  sample("torus.off", {"torus", "resolution=4"});
  EXPECT_THAT(flat("torus.off", {"--cones", "none.txt"}), FailsWithOneLine());
  EXPECT_THAT(
      flat("torus.off", {"--cones", "none.txt"}).err,
      HasSubstr("none.txt: no such file (FILE_NOT_FOUND); check the path given to --cones"));
  EXPECT_THAT(flat("torus.off", {"--boundary", "Circle"}).err,
              HasSubstr("Circle: no such file (FILE_NOT_FOUND); --boundary takes straight, circle, "
                        "free or a file"));
  write("cones.txt", "3 1\n");
  write("boundary.txt", "1 1\n3 -1\n");
  EXPECT_THAT(flat("torus.off", {"--cones", "cones.txt", "--boundary", "boundary.txt"}).err,
              HasSubstr("boundary.txt:2: vertex 3 has a curvature in cones.txt:1 already"));
}

TEST_F(ParameterizeInput, ConesAreRefusedInTheNumbersOfTheFile) {
  EXPECT_THAT(conesError("32 1\n"), HasSubstr("torus.off: a cone at vertex 32, but the mesh has "
                                              "vertices 0 to 31 (INVALID_OPTION)"));
  EXPECT_THAT(conesError("31 6.5\n"), HasSubstr("a cone at vertex 31 of curvature 6.5: inside the "
                                                "surface it must be below 2 pi"));
  sample("disk.obj", {"disk", "resolution=3"});
  write("cones.txt", "36 3.2\n");  // The outer ring: 18 vertices after 1 + 6 + 12.
  EXPECT_THAT(
      flat("disk.obj", {"--cones", "cones.txt"}).err,
      HasSubstr("a cone at vertex 36 of curvature 3.2: on the boundary it must be below pi"));
  write("cones.txt", "36 1\n");
  EXPECT_THAT(
      flat("disk.obj", {"--cones", "cones.txt", "--boundary", "free"}).err,
      HasSubstr("a cone at vertex 36 is on the boundary, and a free one takes the curvature "
                "that comes out (INVALID_OPTION); ask for a straight boundary or a circle"));
}

TEST_F(ParameterizeInput, PolygonsAreFansAndVerticesOfNobodyStay) {
  write("quads.obj", "v 7 7 7\n" + quadTorus(6, 5, 1) + "v 8 8 8\n");
  const Obj out = map("quads.obj");
  ASSERT_EQ(out.vertices.size(), 32U);
  EXPECT_EQ(out.vertices.front(), "v 7 7 7");
  EXPECT_EQ(out.vertices.back(), "v 8 8 8");
  ASSERT_EQ(out.faces.size(), 60U);
  EXPECT_EQ(out.faces[0], (std::array{1, 6, 7}));
  EXPECT_EQ(out.faces[1], (std::array{1, 7, 2}));
  for (const auto& corners : out.corners) {
    for (const int corner : corners) EXPECT_GE(corner, 0);
  }
  write("cones.txt", "0 1\n");
  EXPECT_THAT(flat("quads.obj", {"--cones", "cones.txt"}).err,
              HasSubstr("a cone at vertex 0, which no face uses"));
}

TEST_F(ParameterizeInput, FacesOfOtherComponentsAreWrittenWithoutPoints) {
  write("two.obj", "v 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\n" + quadTorus(6, 5, 3));
  EXPECT_THAT(flat("two.obj"), FailsWithOneLine());
  const Obj out = map("two.obj", {"--component", "1"});
  ASSERT_EQ(out.faces.size(), 61U);
  EXPECT_EQ(out.corners[0], (std::array{-1, -1, -1}));
  EXPECT_GE(out.corners[1][0], 0);
  EXPECT_THAT(read("out.obj"), HasSubstr("\nf 1 2 3\nf 4/"));
  write("cones.txt", "2 1\n");
  EXPECT_THAT(flat("two.obj", {"--component", "1", "--cones", "cones.txt"}).err,
              HasSubstr("a cone at vertex 2, whose faces are in another component"));
}

TEST_F(ParameterizeInput, ARepairedSurfaceIsWrittenAsItWas) {
  // A torus with its first face three times and a face that is turned around.
  const std::string torus = quadTorus(6, 5);
  write("torn.obj", torus + "f 1 6 7\nf 7 1 6\nf 1 1 2\n");
  EXPECT_THAT(flat("torn.obj"), FailsWithOneLine());
  const Obj out = map("torn.obj", {"--repair"});
  ASSERT_EQ(out.faces.size(), 63U);
  EXPECT_EQ(out.faces[61], (std::array{6, 0, 5}));
  EXPECT_GE(out.corners[0][0], 0);
  for (std::size_t f = 60; f < 63; ++f) EXPECT_EQ(out.corners[f], (std::array{-1, -1, -1}));
  EXPECT_THAT(flat("torn.obj", {"--repair", "--json"}).out,
              HasSubstr("REPAIRED: drop duplicate faces"));
}

TEST_F(ParameterizeInput, HolesAreFilledForTheMapAndNotInTheFile) {
  // Without its last two faces the torus has a hole.
  std::string torus = quadTorus(8, 6);
  torus.erase(torus.rfind("f "));
  write("holed.obj", torus);
  const Obj out = map("holed.obj", {"--fill-holes"});
  ASSERT_EQ(out.faces.size(), 94U);
  std::vector<bool> used(out.points.size(), false);
  for (const auto& corners : out.corners) {
    for (const int corner : corners) used.at(static_cast<std::size_t>(corner)) = true;
  }
  EXPECT_THAT(used, testing::Each(true)) << "points of faces that are not written";
}

TEST_F(ParameterizeInput, ASurfaceWithoutPositionsIsItsImage) {
  write("square.json",
        R"({"format": "moduli-intrinsic-triangulation", "version": 1, "geometry": "euclidean",
            "vertices": 1, "faces": [[0, 0, 0], [0, 0, 0]], "gluing": [[4, 5, 3], [2, 0, 1]],
            "lengths": [[1, 1, 1.4142135623730951], [1.4142135623730951, 1, 1]]})");
  const Obj out = map("square.json");
  ASSERT_EQ(out.positions.size(), 4U) << "a square of two triangles";
  ASSERT_EQ(out.points.size(), 4U);
  for (std::size_t p = 0; p < 4; ++p) {
    EXPECT_EQ(std::complex(out.positions[p][0], out.positions[p][1]), out.points[p]);
    EXPECT_EQ(out.positions[p][2], 0);
  }
  ASSERT_EQ(out.faces.size(), 2U);
  EXPECT_EQ(out.faces, out.corners);
  EXPECT_NEAR(out.doubledArea(0), 1, 1e-12);
  EXPECT_NEAR(out.doubledArea(1), 1, 1e-12);
  write("cones.txt", "1 0.5\n");
  EXPECT_THAT(flat("square.json", {"--cones", "cones.txt"}).err,
              HasSubstr("a cone at vertex 1, but the mesh has vertices 0 to 0"));
  EXPECT_THAT(flat("square.json", {"--repair"}), FailsWithOneLine());
}

TEST_F(ParameterizeInput, WhereNothingCanBeWrittenNothingIsComputed) {
  sample("torus.off", {"torus", "resolution=4"});
  const ProcessResult result = flat("torus.off", {"-o", "none/out.obj"});
  EXPECT_THAT(result, FailsWithOneLine());
  EXPECT_THAT(result.err, HasSubstr("none/out.obj: cannot be written"));
  EXPECT_THAT(result.err, HasSubstr("FILE_UNWRITABLE"));
}

}  // namespace
}  // namespace moduli
