#include <cmath>

#include "tests/core/mesh/read_helpers.h"

namespace moduli {
namespace {

using testing::ElementsAre;

const std::string kPoints = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";  // Lines 1 to 4.

Result<TriangleSoup> obj(const std::string& text) {
  return parse(text, "part.obj");
}

TEST(ReadObj, AllCornerFormsNameTheSameVertices) {
  for (const std::string face :
       {"f 1 2 3", "f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1/1/1 2/1/1 3/1/1", "f -4 -3 -2",
        "f -4/-1/-1 -3/-1/-1 -2/-1/-1", "f\t1  2\t3  "}) {
    const auto soup = obj(kPoints + "vt 0 0\nvn 0 0 1\n" + face + "\n");
    ASSERT_OK(soup) << face;
    EXPECT_THAT(soup->faces, ElementsAre(Triangle{0, 1, 2})) << face;
  }
}

TEST(ReadObj, PolygonsBecomeFansFromTheirFirstCorner) {
  const auto soup = obj(kPoints + "v 1 1 1\nf 2 3 4 5 1\n");
  ASSERT_OK(soup);
  EXPECT_THAT(soup->faces, ElementsAre(Triangle{1, 2, 3}, Triangle{1, 3, 4}, Triangle{1, 4, 0}));
}

TEST(ReadObj, LineEndsByteOrderMarkAndMissingLastLineEndDoNotMatter) {
  const auto expected = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ASSERT_OK(expected);
  for (const std::string text :
       {"v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r",
        "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3",
        "  v 0 0 0#x\nv 1 0 0 # y\n\n\nv 0 1 0\nf 1 2 3#"}) {
    const auto soup = obj(text);
    ASSERT_OK(soup);
    EXPECT_EQ(soup->vertices, expected->vertices);
    EXPECT_EQ(soup->faces, expected->faces);
  }
}

TEST(ReadObj, ABackslashJoinsLines) {
  const auto soup =
      obj("v 0 \\\n0 0\nv 1 0 0\\\r\n\nv 0 1 0\nl 1 \\\n2\nvt 1\\\n 2\nf 1\\\n 2 \\\n3\n");
  ASSERT_OK(soup);
  EXPECT_EQ(soup->vertices.size(), 3U);
  EXPECT_THAT(soup->faces, ElementsAre(Triangle{0, 1, 2}));
}

TEST(ReadObj, ABackslashAtTheEndOfTheFileJoinsNothing) {
  EXPECT_OK(obj(kPoints + "f 1 2 3\nl 1 2\\"));
  EXPECT_THAT(obj(kPoints + "f 1 2 3\\"), FailsAt(Reason::kSyntaxError, "part.obj:5: "));
}

TEST(ReadObj, ABackslashAtTheEndOfANameIsPartOfIt) {
  EXPECT_OK(obj("mtllib C:\\parts\\\n# C:\\x\\\n" + kPoints + "f 1 2 3\n"));
}

TEST(ReadObj, WeightsAndColoursAreSteppedOverWhateverTheirNumbers) {
  const auto soup =
      obj("v 1 2 3 1\nv 4 5 6 nan nan nan\nv 7 8 9 1 0.5 0.5 0.5\nv 1 1 1 .1 -nan(ind) 1.#QNAN\n"
          "f 1 2 3\n");
  ASSERT_OK(soup);
  EXPECT_EQ(soup->vertices[2], Eigen::Vector3d(7, 8, 9));
}

TEST(ReadObj, NumbersKeepEveryBit) {
  const auto soup =
      obj("v 0.1234567890123456 +1e-310 -0.0\nv nan inf -inf\nv 1e-400 -1e-999999999999 5.\n"
          "f 1 2 3\n");
  ASSERT_OK(soup);
  EXPECT_EQ(soup->vertices[0][0], 0.1234567890123456);
  EXPECT_EQ(soup->vertices[0][1], 1e-310);
  EXPECT_TRUE(std::signbit(soup->vertices[0][2]));
  EXPECT_TRUE(std::isnan(soup->vertices[1][0]));
  EXPECT_EQ(soup->vertices[1][1], INFINITY);
  EXPECT_EQ(soup->vertices[1][2], -INFINITY);
  EXPECT_EQ(soup->vertices[2], Eigen::Vector3d(0, 0, 5));
  EXPECT_TRUE(std::signbit(soup->vertices[2][1]));
}

TEST(ReadObj, FacesMayComeBeforeTheirVertices) {
  const auto soup = obj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
  ASSERT_OK(soup);
  EXPECT_THAT(soup->faces, ElementsAre(Triangle{0, 1, 2}));
}

TEST(ReadObj, EveryDefectNamesItsLine) {
  const auto at5 = [](Reason reason, const std::string& line, const std::string& text) {
    EXPECT_THAT(obj(kPoints + line + "\nf 1 2 3\n"), FailsAt(reason, "part.obj:5: " + text))
        << line;
  };
  at5(Reason::kSyntaxError, "v 1 2", "a vertex with 2 coordinates instead of 3");
  at5(Reason::kSyntaxError, "v 1 2 x", "'x' is not a coordinate");
  at5(Reason::kSyntaxError, "v 1 2 3,", "'3,' is not a coordinate");
  at5(Reason::kSyntaxError, "v 1 2 1e999", "'1e999' is not a coordinate");
  at5(Reason::kSyntaxError, "v 1 2 +-3", "'+-3' is not a coordinate");
  at5(Reason::kSyntaxError, "v 1 2 3 4 5", "a vertex with 5 numbers");
  at5(Reason::kSyntaxError, "v 1 2 3 4 5 6 7 8", "a vertex with 8 numbers");
  at5(Reason::kSyntaxError, "v 1 2 3 red", "'red' is not a number");
  at5(Reason::kSyntaxError, "f 1 2", "a face with 2 corners");
  at5(Reason::kSyntaxError, "f", "a face with 0 corners");
  at5(Reason::kSyntaxError, "f 1 2 3.5", "'3.5' is not a corner of a face");
  at5(Reason::kSyntaxError, "f 1 2 3/", "'3/' is not a corner of a face");
  at5(Reason::kSyntaxError, "f 1 2 3/1/1/1", "'3/1/1/1' is not a corner of a face");
  at5(Reason::kSyntaxError, "f 1/0 2/1 3/1", "'1/0' is not a corner of a face");
  at5(Reason::kSyntaxError, "f 1/1 2//1 3/1", "the corner '2//1' is not of the form of the others");
  at5(Reason::kSyntaxError, "f 1 2 3/1", "the corner '3/1' is not of the form of the others");
  at5(Reason::kSyntaxError, "f 1 2 99999999999999999999", "'99999999999999999999' is not a corner");
  at5(Reason::kSyntaxError, "hello", "'hello' is no OBJ statement");
  at5(Reason::kUnsupportedContent, "surf 0 1 0 1 1 2 3", "the statement 'surf' is not supported");
  at5(Reason::kUnsupportedContent, "call other.obj", "the statement 'call' is not supported");
  at5(Reason::kIndexOutOfRange, "f 1 2 5", "a face uses vertex 5, but the file has 4 vertices");
  at5(Reason::kIndexOutOfRange, "f 1 2 3000000000", "a face uses vertex 3000000000");
  at5(Reason::kIndexOutOfRange, "f 0 1 2", "a face uses vertex 0");
  at5(Reason::kIndexOutOfRange, "f 0/1 1/1 2/1", "a face uses vertex 0");
  at5(Reason::kIndexOutOfRange, "f 1 2 -5", "a face uses vertex -5");
}

TEST(ReadObj, LinesAreCountedWhateverEndsThem) {
  EXPECT_THAT(obj("v 0 0 0\r\nv 0 0 0\r\n\r\nx"), FailsAt(Reason::kSyntaxError, "part.obj:4: 'x'"));
  EXPECT_THAT(obj("v 0 0 0\rv 0 0 0\r\rx"), FailsAt(Reason::kSyntaxError, "part.obj:4: 'x'"));
}

TEST(ReadObj, ALineCutOffAtTheEndIsTruncation) {
  EXPECT_THAT(obj(kPoints + "f 1 2"), FailsAt(Reason::kTruncatedFile, "part.obj:5: a face with 2"));
  EXPECT_THAT(obj(kPoints + "f 1 2 3\nv 1 2"), FailsAt(Reason::kTruncatedFile, "part.obj:6: "));
}

TEST(ReadObj, NoFacesIsEmpty) {
  EXPECT_THAT(obj(kPoints), FailsAt(Reason::kEmpty, "part.obj:5: the file has no faces"));
  EXPECT_THAT(obj("# only a comment"), FailsAt(Reason::kEmpty, "part.obj:1: "));
}

TEST(ReadObj, OddCharactersAreNotPrinted) {
  const auto soup = obj(kPoints + "f 1 2 \x1b[31m" + std::string(100, 'x') + "\n");
  EXPECT_THAT(soup, FailsAt(Reason::kSyntaxError, "part.obj:5: '?[31mxxx"));
  EXPECT_LT(soup.status().message().size(), 100U);
}

}  // namespace
}  // namespace moduli
