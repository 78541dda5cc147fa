#include <bit>
#include <cmath>
#include <cstdint>

#include "tests/core/mesh/read_helpers.h"

namespace moduli {
namespace {

using testing::ElementsAre;

Result<TriangleSoup> stl(const std::string& bytes) {
  return parse(bytes, "part.stl");
}

std::string facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 1\nouter loop\nvertex " + a + "\nvertex " + b + "\nvertex " + c +
         "\nendloop\nendfacet\n";
}

void add32(std::string& bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFFU);
}

std::string binaryStl(const std::vector<float>& coordinates, std::string header = "") {
  header.resize(80, '\0');
  add32(header, static_cast<std::uint32_t>(coordinates.size() / 9));
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    if (i % 9 == 0) header.append(12, '\0');
    add32(header, std::bit_cast<std::uint32_t>(coordinates[i]));
    if (i % 9 == 8) header.append(2, '\0');
  }
  return header;
}

TEST(ReadStl, EqualCornersBecomeOneVertexNumberedByFirstUse) {
  const auto soup = stl("solid two\n" + facet("1 0 0", "0 0 0", "0 1 0") + "endsolid two\nsolid\n" +
                        facet("0 1 0", "0 0 -0.0", "0.1 0 5e-324") + "endsolid\n");
  ASSERT_OK(soup);
  EXPECT_THAT(soup->vertices,
              ElementsAre(Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 0),
                          Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0.1, 0, 5e-324)));
  EXPECT_THAT(soup->faces, ElementsAre(Triangle{0, 1, 2}, Triangle{2, 1, 3}));
}

TEST(ReadStl, CoordinatesThatDifferInTheLastBitStayApart) {
  const auto soup = stl("solid\n" + facet("1 0 0", "1.0000000000000002 0 0", "0 1 0") + "endsolid");
  ASSERT_OK(soup);
  EXPECT_EQ(soup->vertices.size(), 3U);
}

TEST(ReadStl, NotANumberEqualsNothing) {
  const auto soup = stl("solid\n" + facet("nan 0 0", "nan 0 0", "0 1 0") + "endsolid");
  ASSERT_OK(soup);
  EXPECT_EQ(soup->vertices.size(), 3U);
  const auto binary = stl(binaryStl({NAN, 0, 0, NAN, 0, 0, 0, 1, 0}));
  ASSERT_OK(binary);
  EXPECT_EQ(binary->vertices.size(), 3U);
}

TEST(ReadStl, CaseIndentationAndOddNormalsDoNotMatter) {
  EXPECT_OK(
      stl("\r\n SOLID x y\r\n  Facet Normal nan -nan(ind) -1.#IND\r\n OUTER LOOP\r\n"
          "VERTEX 0 0 0\r\nvertex 1 0 0\r\nvertex 0 1 0\r\nEndLoop\r\nENDFACET\r\nendsolid x\r\n"));
}

TEST(ReadStl, SizeDecidesWhatABinaryFileIs) {
  const std::vector<float> corner = {0.5F, -0.0F, 0, 1, 0, 0, 0, 1, 0.1F};
  for (const std::string header : {"", "solid facet", "binary"}) {
    for (const std::string name : {"part.stl", "part", "part.obj"}) {
      const auto soup = parse(binaryStl(corner, header), name);
      ASSERT_OK(soup) << header << name;
      EXPECT_EQ(soup->vertices[2], Eigen::Vector3d(0, 1, 0.1F));
      EXPECT_TRUE(std::signbit(soup->vertices[0][1]));
    }
  }
}

TEST(ReadStl, TextDefectsNameTheirLine) {
  const auto fails = [](const std::string& text, Reason reason, const std::string& start) {
    EXPECT_THAT(stl(text), FailsAt(reason, "part.stl:" + start)) << text;
  };
  const std::string good = facet("1 0 0", "0 0 0", "0 1 0");
  fails("solid\n" + facet("1 0 0", "0 0 x", "0 1 0"), Reason::kSyntaxError,
        "5: 'x' stands where a coordinate should be");
  fails("solid\n" + facet("1 0 0", "0 0", "0 1 0"), Reason::kSyntaxError,
        "6: 'vertex' stands where a coordinate");
  fails("solid\n" + facet("1 0 0", "0 0 0\nvertex 1 1 1", "0 1 0"), Reason::kSyntaxError,
        "7: 'vertex' stands where 'endloop' should be");
  fails("solid\n" + good, Reason::kTruncatedFile, "9: the end of the file stands where 'endsolid'");
  fails("solid\n" + good + "endsolid\n" + good, Reason::kSyntaxError,
        "10: 'facet' stands where 'solid'");
  fails("solid\nfacet normal 1 0\nouter loop\n", Reason::kSyntaxError,
        "3: 'outer' stands where a number of");
  fails("solid\nendsolid\n", Reason::kEmpty, "3: the file has no facets");
}

TEST(ReadStl, BinaryDefectsNameTheirByte) {
  const std::string good = binaryStl({0, 0, 0, 1, 0, 0, 0, 1, 0});
  EXPECT_THAT(stl(good.substr(0, 133)),
              FailsAt(Reason::kTruncatedFile, "part.stl: byte 80: declares 1"));
  EXPECT_THAT(stl(good.substr(0, 60)),
              FailsAt(Reason::kTruncatedFile, "part.stl: byte 60: the file ends"));
  EXPECT_THAT(
      stl(good + "xyz"),
      FailsAt(Reason::kSyntaxError, "part.stl: byte 134: 3 bytes stand behind the last triangle"));
  EXPECT_THAT(stl(binaryStl({})),
              FailsAt(Reason::kEmpty, "part.stl: byte 80: the file has no triangles"));
  std::string huge = good;
  huge.replace(80, 4, "\xFF\xFF\xFF\xFF");
  EXPECT_THAT(stl(huge),
              FailsAt(Reason::kCountTooLarge, "part.stl: byte 80: declares 4294967295 triangles"));
}

}  // namespace
}  // namespace moduli
