#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <tuple>

#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/mesh/write.h"
#include "tests/client/cli_test.h"
#include "tests/core/matching/renumbered.h"

/// match: maps from one surface to another, as files, words and pictures.
namespace moduli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::UnorderedElementsAre;

/// An ellipsoid with a lump: no symmetry. 252 vertices, 500 faces.
TriangleSoup lumpy() {
  TriangleSoup soup = *makeSample("sphere", {{"resolution", 5}, {"seed", 3}});
  for (Eigen::Vector3d& p : soup.vertices) {
    const double lump = std::exp(4 * (p.dot(Eigen::Vector3d(0.6, 0.48, 0.64)) - 1));
    p = Eigen::Vector3d(p.x(), 1.2 * p.y(), 0.9 * p.z()) * (1 + 0.4 * lump);
  }
  return soup;
}

std::string off(const TriangleSoup& soup) {
  return *writeMesh(soup, MeshFormat::kOff);
}

/// A map as its file has it.
struct Row {
  Index vertex = kNone, face = kNone;
  std::array<double, 3> weights = {0, 0, 0};
};

std::vector<Row> parseMap(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  EXPECT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line, "vertex,face,b0,b1,b2");
  std::vector<Row> rows;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::vector<std::string> numbers;
    for (std::string word; std::getline(words, word, ',');) numbers.push_back(word);
    EXPECT_EQ(numbers.size(), 5U) << line;
    if (numbers.size() != 5) return rows;
    Row row{std::atoi(numbers[0].c_str()), std::atoi(numbers[1].c_str()), {}};
    for (int c = 0; c < 3; ++c) row.weights[c] = std::strtod(numbers[2 + c].c_str(), nullptr);
    EXPECT_EQ(row.vertex, static_cast<Index>(rows.size()));
    rows.push_back(row);
  }
  return rows;
}

/// The vertex of a surface that a row is, to the last bit; kNone where it is none.
Index vertexOf(const Row& row, const TriangleSoup& soup) {
  for (int c = 0; c < 3; ++c) {
    if (row.weights[c] == 1) return soup.faces[row.face][c];
  }
  return kNone;
}

Eigen::Vector3d placeOf(const Row& row, const TriangleSoup& soup) {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) p += row.weights[c] * soup.vertices[soup.faces[row.face][c]];
  return p;
}

class Match : public CliTest {
 protected:
  Match() : copy_(renumbered(lumpy(), 5)) {
    write("a.off", off(lumpy()));
    write("b.off", off(moved(copy_.soup)));
  }

  const Renumbered copy_;  ///< b.off, where a.off is.
};

TEST_F(Match, ARenumberedCopyIsTheIdentityInBothDirections) {
  const ProcessResult result =
      run({"match", "a.off", "b.off", "-o", "map.csv", "--inverse", "back.csv"});
  ASSERT_THAT(result, Succeeds());
  EXPECT_THAT(result.out, StartsWith("a.off to b.off\n  distance      "));
  EXPECT_THAT(result.out, HasSubstr("\n  method        SAME_TRIANGULATION\n"));
  EXPECT_THAT(result.out, HasSubstr("0 flipped faces, dilatation 1 on average"));
  EXPECT_THAT(result.out, testing::EndsWith("\nmap.csv: 252 vertices\nback.csv: 252 vertices\n"));
  const std::vector<Row> map = parseMap(read("map.csv")), back = parseMap(read("back.csv"));
  ASSERT_EQ(map.size(), 252U);
  ASSERT_EQ(back.size(), 252U);
  for (Index v = 0; v < 252; ++v) {
    EXPECT_EQ(vertexOf(map[v], copy_.soup), copy_.image[v]);
    EXPECT_EQ(vertexOf(back[copy_.image[v]], lumpy()), v);
  }
}

TEST_F(Match, JsonIsTheResultAlone) {
  const Json match = json({"match", "a.off", "b.off"});
  EXPECT_THAT(match.keys(),
              UnorderedElementsAre("distance", "method", "certificate", "alternatives", "timing"));
  EXPECT_THAT(match["certificate"].keys(),
              UnorderedElementsAre("flipped_faces", "mean_dilatation", "dilatation_95",
                                   "max_dilatation", "area_distortion", "cycle_error", "warnings"));
  EXPECT_EQ(match["certificate"]["flipped_faces"].number(), 0);
  // Singular values are equal to the root of what rounding leaves of their squares: some 2^-26.
  EXPECT_LT(match["distance"].number(), 1e-7);
  EXPECT_LT(match["certificate"]["cycle_error"].number(), 1e-9);
}

TEST_F(Match, BySurfacesAloneACopyIsNearlyTheIdentity) {
  const std::vector<std::string> words = {"match", "a.off", "b.off",  "--same-triangulation",
                                          "off",   "-o",    "map.csv"};
  const Json match = json(words);
  EXPECT_NE(match["method"].string(), "SAME_TRIANGULATION");
  EXPECT_EQ(match["certificate"]["flipped_faces"].number(), 0);
  EXPECT_GE(match["certificate"]["defect"].number(), 0);
  // Within an edge's length, about a third; the mean of all within a tenth of that.
  double sum = 0;
  const std::vector<Row> map = parseMap(read("map.csv"));
  ASSERT_EQ(map.size(), 252U);
  for (Index v = 0; v < 252; ++v) {
    sum += (placeOf(map[v], copy_.soup) - lumpy().vertices[v]).norm();
  }
  EXPECT_LT(sum / 252, 0.03);
}

TEST_F(Match, LandmarksAreMet) {
  std::ostringstream lines;
  lines << "# vertices\n";
  for (const int v : {3, 40, 100, 200}) lines << v << " " << copy_.image[v] << "\n";
  write("marks.txt", lines.str());
  const std::vector<std::string> words = {"match",     "a.off", "b.off",  "--landmarks",
                                          "marks.txt", "-o",    "map.csv"};
  const Json match = json(words);
  EXPECT_NE(match["method"].string(), "SAME_TRIANGULATION");
  EXPECT_EQ(match["certificate"]["flipped_faces"].number(), 0);
  EXPECT_LT(match["certificate"]["landmark_error"].number(), 1e-9);
  const std::vector<Row> map = parseMap(read("map.csv"));
  ASSERT_EQ(map.size(), 252U);
  for (const int v : {3, 40, 100, 200}) {
    EXPECT_LT((placeOf(map[v], copy_.soup) - lumpy().vertices[v]).norm(), 1e-9);
  }
  EXPECT_THAT(run(words).out, HasSubstr("landmarks are met up to "));
  // One that is not where it belongs may be missed.
  write("soft.txt", "60 " + std::to_string(copy_.image[61]) + "\n");
  std::vector<std::string> both = words;
  both.insert(both.end(), {"--soft-landmarks", "soft.txt"});
  const Json drawn = json(both);
  EXPECT_LT(drawn["certificate"]["landmark_error"].number(), 1e-9);
  EXPECT_GT(drawn["certificate"]["soft_landmark_error"].number(), 1e-6);
  EXPECT_THAT(run(both).out, HasSubstr("soft landmarks are missed by up to "));
  write("soft.txt", "60\n");
  expectRefusal(both, "error: soft.txt:1: has 1 word instead of two vertices");
  // What is wrong with them is told by line.
  write("marks.txt", "3 3\n4 252\n");
  expectRefusal(words, "error: marks.txt:2: on the second surface: a landmark at vertex 252, but");
  write("marks.txt", "3\n");
  expectRefusal(words, "error: marks.txt:1: has 1 word instead of two vertices");
}

TEST_F(Match, AMirrorImageIsMetTurnedOver) {
  const TriangleSoup mirror = mirrored(lumpy());
  write("m.off", off(mirror));
  ASSERT_THAT(run({"match", "a.off", "m.off", "--mirror", "-o", "map.csv"}), Succeeds());
  const std::vector<Row> map = parseMap(read("map.csv"));
  ASSERT_EQ(map.size(), 252U);
  for (Index v = 0; v < 252; ++v) EXPECT_EQ(vertexOf(map[v], mirror), v);
}

TEST_F(Match, OtherTopologiesAreRefusedWithWhatWouldHelp) {
  sample("torus.off", {"torus", "resolution=6"});
  expectRefusal({"match", "a.off", "torus.off", "-o", "map.csv"},
                "error: a.off and torus.off: the surfaces are not of one topology: genus 0, "
                "closed, and genus 1, closed (UNSUPPORTED_TOPOLOGY); ");
  EXPECT_FALSE(exists("map.csv"));
  TriangleSoup open = lumpy();
  open.faces.pop_back();
  write("open.off", off(open));
  expectRefusal({"match", "open.off", "b.off"}, "genus 0 with 1 boundary loop");
  EXPECT_THAT(run({"match", "open.off", "b.off"}).err, HasSubstr("; --fill-holes closes holes of"));
  const ProcessResult filled = run({"match", "open.off", "b.off", "--fill-holes", "-o", "map.csv"});
  ASSERT_THAT(filled, Succeeds());
  EXPECT_THAT(filled.out, HasSubstr("\n  warning       open.off: REPAIRED: "));
  const std::vector<Row> map = parseMap(read("map.csv"));
  ASSERT_EQ(map.size(), 252U);
  for (Index v = 0; v < 252; ++v) EXPECT_EQ(vertexOf(map[v], copy_.soup), copy_.image[v]);
}

TEST_F(Match, SurfacesWithHandlesAreMatched) {
  // Two triangulations of a torus, and of a surface of genus 2.
  sample("t1.off", {"torus", "R=2", "resolution=16"});
  sample("t2.off", {"torus", "R=2", "resolution=14", "seed=3"});
  sample("g1.off", {"genus", "genus=2", "resolution=4"});
  sample("g2.off", {"genus", "genus=2", "resolution=4", "seed=5"});
  for (const std::string kind : {"t", "g"}) {
    SCOPED_TRACE(kind);
    const std::string a = kind + "1.off", b = kind + "2.off";
    const Json match =
        json({"match", a, b, "-o", "map.csv", "--inverse", "back.csv", "--picture", "map.png"});
    EXPECT_EQ(match["certificate"]["flipped_faces"].number(), 0);
    EXPECT_NE(match["method"].string(), "SAME_TRIANGULATION");
    // Of tori alone; these are one surface.
    if (kind == "t") {
      EXPECT_LT(match["certificate"]["teichmuller_distance"].number(), 0.02);
    }
    for (const auto& [file, from, to] :
         {std::tuple{"map.csv", a, b}, std::tuple{"back.csv", b, a}}) {
      const std::vector<Row> map = parseMap(read(file));
      EXPECT_EQ(map.size(), json({"inspect", from})["topology"]["vertices"].number());
      const double faces = json({"inspect", to})["topology"]["faces"].number();
      for (const Row& row : map) {
        EXPECT_GE(row.face, 0);
        EXPECT_LT(row.face, faces);
        EXPECT_NEAR(row.weights[0] + row.weights[1] + row.weights[2], 1, 1e-12);
      }
    }
  }
  // Landmarks are met on them, too; two of them cannot go to one place.
  write("marks.txt", "# faces\n7 0.5 0.25 0.25 7 1 0 0\n");
  const Json marked = json({"match", "g1.off", "g1.off", "--landmarks", "marks.txt"});
  EXPECT_LT(marked["certificate"]["landmark_error"].number(), 1e-9);
  write("marks.txt", "1 1\n2 1\n");
  expectRefusal({"match", "g1.off", "g1.off", "--landmarks", "marks.txt"},
                "marks.txt:1 and marks.txt:2 are sent to the same place");
}

TEST_F(Match, BoundariesGoOntoBoundaries) {
  // Disks and rings, each against another triangulation of it.
  sample("d1.off", {"disk", "resolution=8"});
  sample("d2.off", {"disk", "resolution=9", "seed=3"});
  sample("r1.off", {"annulus", "resolution=6"});
  sample("r2.off", {"annulus", "resolution=7", "seed=3"});
  for (const std::string kind : {"d", "r"}) {
    SCOPED_TRACE(kind);
    const std::string a = kind + "1.off", b = kind + "2.off";
    const Json match = json({"match", a, b, "-o", "map.csv"});
    EXPECT_EQ(match["certificate"]["flipped_faces"].number(), 0);
    Context context;
    const TriangleSoup from = *readMeshFile(context, path(a)), to = *readMeshFile(context, path(b));
    const std::vector<Row> map = parseMap(read("map.csv"));
    ASSERT_EQ(map.size(), from.vertices.size());
    for (const Row& row : map) {
      // Round boundaries: the outer one of both, and the inner one of the ring.
      const double radius = from.vertices[row.vertex].norm(), there = placeOf(row, to).norm();
      const double outer = kind == "d" ? 1 : 2;
      if (radius > outer - 1e-9 || (kind == "r" && radius < 1 + 1e-9)) {
        EXPECT_NEAR(there, radius, 0.02);  // Sagittas of edges.
        EXPECT_EQ(*std::min_element(row.weights.begin(), row.weights.end()), 0);
      }
    }
  }
}

TEST_F(Match, SymmetricSurfacesHaveOtherAnswers) {
  sample("e1.off", {"ellipsoid", "a=1", "b=0.7", "c=0.45", "resolution=6", "seed=3"});
  sample("e2.off", {"ellipsoid", "a=1", "b=0.7", "c=0.45", "resolution=7", "seed=5"});
  const Json best = json({"match", "e1.off", "e2.off", "-o", "best.csv"});
  ASSERT_GT(best["alternatives"].size(), 0);
  const Json other = json({"match", "e1.off", "e2.off", "--alternative", "1", "-o", "other.csv"});
  EXPECT_EQ(other["alternatives"].size(), best["alternatives"].size());
  EXPECT_EQ(other["certificate"]["defect"].number(), best["alternatives"].at(0)["defect"].number());
  EXPECT_NE(read("best.csv"), read("other.csv"));
  expectRefusal({"match", "e1.off", "e2.off", "--alternative", "99"}, "there is no answer 99");
}

TEST_F(Match, StoredShapesAreMatched) {
  ASSERT_THAT(run({"add", "-c", "lumps", "a.off", "b.off"}), Succeeds());
  ASSERT_THAT(run({"match", "lumps/a", "lumps/b", "-o", "map.csv", "--picture", "map.png"}),
              Succeeds());
  const std::vector<Row> map = parseMap(read("map.csv"));
  ASSERT_EQ(map.size(), 252U);
  for (Index v = 0; v < 252; ++v) EXPECT_EQ(vertexOf(map[v], copy_.soup), copy_.image[v]);
  EXPECT_THAT(read("map.png"), StartsWith("\x89PNG"));
  expectRefusal({"match", "lumps/a", "lumps/c"}, "c");
}

TEST_F(Match, APictureIsMadeInItsSize) {
  ASSERT_THAT(run({"match", "a.off", "b.off", "--picture", "map.png", "--size", "300x200", "--view",
                   "front"}),
              Succeeds());
  const std::string png = read("map.png");
  ASSERT_THAT(png, StartsWith("\x89PNG"));
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\x01\x2c\0\0\0\xc8", 8));
}

TEST_F(Match, WhatDoesNotGoTogetherIsAUsageError) {
  const auto usage = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "match");
    const ProcessResult result = run(words);
    EXPECT_THAT(result, IsUsageError());
    return result.err;
  };
  usage({"a.off"});
  EXPECT_THAT(usage({"-", "-"}), HasSubstr("only one of the two can come from standard input"));
  EXPECT_THAT(usage({"a.off", "b.off", "-o", "m.csv", "--inverse", "m.csv"}),
              HasSubstr("name the same file"));
  EXPECT_THAT(usage({"a.off", "b.off", "--picture", "m.svg"}), HasSubstr("written as PNG"));
  EXPECT_THAT(usage({"a.off", "b.off", "--size", "300x200"}), HasSubstr("that of a --picture"));
  EXPECT_THAT(usage({"a.off", "b.off", "--picture", "m.png", "--size", "3"}), HasSubstr("no size"));
  usage({"a.off", "b.off", "--same-triangulation", "maybe"});
  usage({"a.off", "b.off", "--alternative", "0"});
}

TEST_F(Match, NothingIsLeftWhereNothingCanBeWrittenOrRead) {
  EXPECT_THAT(run({"match", "a.off", "b.off", "-o", "none/map.csv"}), FailsWithOneLine());
  EXPECT_THAT(run({"match", "a.off", "none.off", "-o", "map.csv"}).err,
              HasSubstr("error: none.off: no such file"));
  EXPECT_FALSE(exists("map.csv"));
  expectRefusal({"match", "a.off", "b.off", "--landmarks", "none.txt"}, "none.txt");
}

TEST_F(Match, StandardInputIsOneOfTheTwo) {
  Process::Options options;
  options.input = off(lumpy());
  EXPECT_THAT(run({"match", "-", "b.off", "--quiet"}, options), Succeeds());
}

}  // namespace
}  // namespace moduli
