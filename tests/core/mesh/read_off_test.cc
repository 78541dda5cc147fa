#include "tests/core/mesh/read_helpers.h"

namespace moduli {
namespace {

using testing::ElementsAre;

Result<TriangleSoup> off(const std::string& text) {
  return parse(text, "part.off");
}

void expectTriangle(const std::string& text) {
  const auto soup = off(text);
  ASSERT_OK(soup) << text;
  EXPECT_THAT(soup->vertices, ElementsAre(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0),
                                          Eigen::Vector3d(0, 1, 0)));
  EXPECT_THAT(soup->faces, ElementsAre(Triangle{0, 1, 2}));
}

TEST(ReadOff, HeadersSayWhatFollowsEachVertex) {
  expectTriangle("OFF\n3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  expectTriangle("COFF\n3 1 3\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n");
  expectTriangle("COFF\n3 1 3\n0 0 0 255 9 1\n1 0 0 255 9 1\n0 1 0 255 9 1\n3 0 1 2\n");
  expectTriangle("NOFF\n3 1 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 nan 0 1\n3 0 1 2\n");
  expectTriangle(
      "CNOFF\n3 1 0\n0 0 0 0 0 1 1 1 1 1\n1 0 0 0 0 1 1 1 1 1\n0 1 0 0 0 1 1 1 1 1\n3 0 1 2\n");
  expectTriangle(
      "NCOFF\n3 1 0\n0 0 0 0 0 1 9 9 9\n1 0 0 0 0 1 9 9 9\n0 1 0 0 0 1 9 9 9\n3 0 1 2\n");
  expectTriangle("STOFF\n3 1 0\n0 0 0 .5 .5\n1 0 0 .5 .5\n0 1 0 .5 .5\n3 0 1 2\n");
  expectTriangle(
      "STCOFF\n3 1 0\n0 0 0 1 1 1 1 .5 .5\n1 0 0 1 1 1 1 .5 .5\n0 1 0 1 1 1 1 .5 .5\n3 0 1 2\n");
  expectTriangle(
      "STCNOFF\n3 1 0\n0 0 0 0 0 1 1 1 1 0 0\n1 0 0 0 0 1 1 1 1 0 0\n0 1 0 0 0 1 1 1 1 0 0\n"
      "3 0 1 2\n");
}

TEST(ReadOff, CommentsBlankLinesAndLineEndsAreAllowedEverywhere) {
  expectTriangle(
      "# made by hand\n\nOFF # header\n# more\n3 1 0# counts\n0 0 0\n# x\n1 0 0 # y\n\n"
      "0 1 0\n3 0 1 2 # face\n# end");
  expectTriangle("OFF\r\n3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n");
  expectTriangle("\xEF\xBB\xBFOFF 3 1 0\r0 0 0\r1 0 0\r0 1 0\r3 0 1 2");
  expectTriangle("OFF 3 1 0\n0 0 0 1 0\n0 0\n1 0 3 0\n1 2");
  expectTriangle("OFF 3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2");
}

TEST(ReadOff, SeveralFacesMayStandOnALine) {
  const auto soup = off("OFF 4 3 0 0 0 0 1 0 0 0 1 0 0 0 1 3 0 1 2 4 0 1 2 3 3 0 2 3");
  ASSERT_OK(soup);
  EXPECT_THAT(soup->faces, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 1, 2}, Triangle{0, 2, 3},
                                       Triangle{0, 2, 3}));
}

TEST(ReadOff, ColoursOfFacesAreSteppedOver) {
  for (const std::string color : {"", "7", "255 0 0", "0.1 0.2 0.3 1", " 1 0 0 # red"}) {
    expectTriangle("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 " + color + "\n");
  }
}

TEST(ReadOff, EveryDefectNamesItsLine) {
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  const auto fails = [](const std::string& text, Reason reason, const std::string& start) {
    EXPECT_THAT(off(text), FailsAt(reason, "part.off:" + start)) << text;
  };
  fails("3 1 0\n" + points + "3 0 1 2\n", Reason::kSyntaxError,
        "1: '3' stands where 'OFF' should be");
  fails("4OFF\n3 1 0\n", Reason::kUnsupportedContent, "1: '4OFF' files have points of another");
  fails("nOFF\n5\n3 1 0\n", Reason::kUnsupportedContent, "1: 'nOFF' files");
  fails("C4nOFF\n5\n3 1 0\n", Reason::kUnsupportedContent, "1: 'C4nOFF' files");
  fails("OFF BINARY\n\1\2", Reason::kUnsupportedContent, "1: binary OFF is not supported");
  fails("OFF\n3 1\n" + points + "3 0 1 2\n", Reason::kSyntaxError,
        "2: the end of the line is not the number of edges");
  fails("OFF\n-3 1 0\n", Reason::kSyntaxError, "2: '-3' is not the number of vertices");
  fails("OFF\n3 1.5 0\n", Reason::kSyntaxError, "2: '1.5' is not the number of faces");
  fails("OFF\n3 0 0\n" + points, Reason::kEmpty, "2: the file has no faces");
  fails("OFF\n3 1 0\n0 0 0\n1 0,0 0\n0 1 0\n3 0 1 2\n", Reason::kSyntaxError,
        "4: '0,0' is not a coordinate");
  fails("OFF\n3 1 0\n" + points + "2 0 1      \n", Reason::kSyntaxError,
        "6: a face with 2 corners");
  fails("OFF\n3 1 0\n" + points + "3 0 1 3\n", Reason::kIndexOutOfRange,
        "6: a face uses vertex 3, but the file has 3 vertices");
  fails("OFF\n3 1 0\n" + points + "3 0 1 -1\n", Reason::kIndexOutOfRange,
        "6: a face uses vertex -1");
  fails("OFF\n3 1 0\n" + points + "3 0 1 x\n", Reason::kSyntaxError,
        "6: 'x' is not a vertex number");
  fails("OFF\n3 1 0\n" + points + "3 0 1 2 1 2\n", Reason::kSyntaxError,
        "6: 2 numbers stand behind the corners of a face");
  fails("OFF\n3 1 0\n" + points + "3 0 1 2 red\n", Reason::kSyntaxError,
        "6: 'red' is not a part of a face's colour");
  fails("OFF\n3 1 0\n" + points + "3 0 1 2\n3 0 1 2\n", Reason::kSyntaxError,
        "7: '3' stands behind the last face");
  fails("OFF\n3 1 0\n" + points + "3 0 1", Reason::kTruncatedFile,
        "6: declares 3 corners, which the 4 bytes that follow cannot hold");
  fails("OFF\n3 2 0\n0 0 0\n1.000 0 0\n0 1.0000 0\n3 0 1 2\n", Reason::kTruncatedFile,
        "7: the file ends where the number of corners");
  fails("OFF", Reason::kTruncatedFile, "1: the file ends where the number of vertices");
  fails("OFF\n4 2 0\n" + points, Reason::kTruncatedFile, "2: declares 4 vertices");
  fails("OFF\n2000000000 1 0\n" + points + "3 0 1 2\n", Reason::kCountTooLarge,
        "2: declares 2000000000 vertices");
  fails("OFF\n3 2000000000 0\n" + points + "3 0 1 2\n", Reason::kCountTooLarge,
        "2: declares 2000000000 faces");
  fails("OFF\n3 1 0\n" + points + "2000000000 0 1 2\n", Reason::kCountTooLarge,
        "6: declares 2000000000 corners");
}

TEST(ReadOff, ColouredVerticesUnderAPlainHeaderAreNotMisread) {
  EXPECT_FALSE(off("OFF\n3 1 0\n0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 255 0 0\n3 0 1 2\n").ok());
}

}  // namespace
}  // namespace moduli
