#include <algorithm>
#include <bit>
#include <cstring>

#include "tests/core/mesh/read_helpers.h"

namespace moduli {
namespace {

using testing::ElementsAre;

Result<TriangleSoup> ply(const std::string& bytes) {
  return parse(bytes, "part.ply");
}

// Values in either byte order.
class Bytes {
 public:
  explicit Bytes(bool big) : big_(big) {}
  template <typename T>
  Bytes& add(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (big_ == (std::endian::native == std::endian::little))
      std::reverse(bytes, bytes + sizeof(T));
    text_.append(bytes, sizeof(T));
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  bool big_;
  std::string text_;
};

std::string binaryHeader(bool big) {
  return std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
         " 1.0\n";
}

const std::string kTextHeader =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";  // Nine lines.

TEST(ReadPly, ReadsText) {
  const auto soup = ply(kTextHeader + "0 0 0\n0.1 0 1e-310\n0 1 -inf\n3 2 1 0\n");
  ASSERT_OK(soup);
  EXPECT_THAT(soup->vertices, ElementsAre(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.1, 0, 1e-310),
                                          Eigen::Vector3d(0, 1, -INFINITY)));
  EXPECT_THAT(soup->faces, ElementsAre(Triangle{2, 1, 0}));
}

TEST(ReadPly, EveryTypeInBothByteOrdersAndSpellings) {
  for (const bool big : {false, true}) {
    const auto soup = ply(
        binaryHeader(big) +
        "comment x\nobj_info y z\nelement vertex 3\nproperty char a\nproperty double z\n"
        "property int16 b\nproperty list uint8 float64 c\nproperty uint32 x\nproperty float32 y\n"
        "element extra 2\nproperty list ushort short v\nproperty int8 w\nelement nothing 5\n"
        "element face 2\nproperty uchar k\nproperty list int uint16 vertex_index\n"
        "property list char double d\nend_header\n" +
        [&] {
          Bytes b(big);
          for (std::uint32_t v = 0; v < 3; ++v) {
            b.add<std::int8_t>(-1).add<double>(0.1 + v).add<std::int16_t>(-5).add<std::uint8_t>(1);
            b.add<double>(9).add<std::uint32_t>(4000000000U + v).add<float>(0.5F);
          }
          b.add<std::uint16_t>(2).add<std::int16_t>(1).add<std::int16_t>(2).add<std::int8_t>(3);
          b.add<std::uint16_t>(0).add<std::int8_t>(3);
          b.add<std::uint8_t>(7).add<std::int32_t>(3);
          b.add<std::uint16_t>(0).add<std::uint16_t>(1).add<std::uint16_t>(2);
          b.add<std::int8_t>(0);
          b.add<std::uint8_t>(7).add<std::int32_t>(4);
          b.add<std::uint16_t>(2).add<std::uint16_t>(1);
          b.add<std::uint16_t>(0).add<std::uint16_t>(2);
          b.add<std::int8_t>(1).add<double>(1);
          return b.text();
        }());
    ASSERT_OK(soup);
    EXPECT_THAT(soup->vertices, ElementsAre(Eigen::Vector3d(4000000000.0, 0.5, 0.1),
                                            Eigen::Vector3d(4000000001.0, 0.5, 1.1),
                                            Eigen::Vector3d(4000000002.0, 0.5, 2.1)));
    EXPECT_THAT(soup->faces, ElementsAre(Triangle{0, 1, 2}, Triangle{2, 1, 0}, Triangle{2, 0, 2}));
  }
}

std::string usualBinary(bool big, const std::vector<std::vector<std::int32_t>>& faces) {
  Bytes b(big);
  for (int i = 0; i < 12; ++i) b.add<float>(static_cast<float>(i));
  for (const auto& face : faces) {
    b.add(static_cast<std::uint8_t>(face.size()));
    for (const std::int32_t v : face) b.add(v);
  }
  return binaryHeader(big) +
         "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(faces.size()) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         b.text();
}

TEST(ReadPly, TrianglesAndPolygonsMayMix) {
  for (const bool big : {false, true}) {
    const auto soup = ply(usualBinary(big, {{0, 1, 2}, {0, 1, 2, 3}, {3, 2, 1}}));
    ASSERT_OK(soup);
    EXPECT_THAT(soup->faces, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 1, 2}, Triangle{0, 2, 3},
                                         Triangle{3, 2, 1}));
  }
}

TEST(ReadPly, TheHeadersLineEndDecidesWhereDataBegin) {
  // The first coordinate's first byte is a line feed, in both byte orders.
  for (const std::string line_end : {"\n", "\r\n", "\r"}) {
    std::string header =
        "ply|format binary_little_endian 1.0|element vertex 3|property int x|"
        "property int y|property int z|element face 1|"
        "property list uchar uchar vertex_indices|end_header|";
    for (std::size_t at; (at = header.find('|')) != std::string::npos;)
      header.replace(at, 1, line_end);
    Bytes b(false);
    for (int i = 0; i < 9; ++i) b.add<std::int32_t>(i == 0 ? '\n' : i);
    const auto soup = ply(header + b.text() + std::string("\3\0\1\2", 4));
    ASSERT_OK(soup);
    EXPECT_EQ(soup->vertices[0], Eigen::Vector3d('\n', 1, 2));
  }
}

TEST(ReadPly, TextDefectsNameTheirLine) {
  const auto fails = [](const std::string& text, Reason reason, const std::string& start) {
    EXPECT_THAT(ply(text), FailsAt(reason, "part.ply:" + start)) << text;
  };
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  fails(kTextHeader + "0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n", Reason::kSyntaxError,
        "11: 'x' is not a coordinate");
  fails(kTextHeader + points + "3 0 1 3\n", Reason::kIndexOutOfRange,
        "13: a face uses vertex 3, but the file has 3 vertices");
  fails(kTextHeader + points + "3 0 1 -1\n", Reason::kIndexOutOfRange, "13: a face uses vertex -1");
  fails(kTextHeader + points + "3 0 1 1.0\n", Reason::kSyntaxError,
        "13: '1.0' is not a whole number");
  fails(kTextHeader + points + "2 0 1    \n", Reason::kSyntaxError, "13: a face with 2 corners");
  fails(kTextHeader + points + "-2 0 1 2\n", Reason::kSyntaxError, "13: a list of -2 values");
  fails(kTextHeader + points + "3 0 1 2\n7\n", Reason::kSyntaxError,
        "14: content stands behind the last element");
  fails(kTextHeader + points + "3 0 1", Reason::kTruncatedFile, "13: declares 3 values");
  fails(kTextHeader + "0 0 0\n1 0 0.0000\n0 1", Reason::kTruncatedFile,
        "12: the file ends where a coordinate should be");
  fails(kTextHeader + points + "2000000000 0 1 2\n", Reason::kCountTooLarge,
        "13: declares 2000000000 values");
}

TEST(ReadPly, BinaryDefectsNameTheirByte) {
  const std::string good = usualBinary(false, {{0, 1, 2}});
  const std::size_t data = good.find("end_header\n") + 11;
  const auto at = [](std::size_t byte) { return "part.ply: byte " + std::to_string(byte) + ": "; };
  EXPECT_THAT(ply(usualBinary(false, {{0, 1, 4}})),
              FailsAt(Reason::kIndexOutOfRange, at(data + 48 + 9) + "a face uses vertex 4"));
  EXPECT_THAT(ply(usualBinary(true, {{0, 1, -2}})),
              FailsAt(Reason::kIndexOutOfRange, at(data - 3 + 48 + 9) + "a face uses vertex -2"));
  EXPECT_THAT(ply(usualBinary(false, {{0, 1, 2, -2}})),
              FailsAt(Reason::kIndexOutOfRange, at(data + 48 + 13) + "a face uses vertex -2"));
  EXPECT_THAT(ply(usualBinary(false, {{0, 1}, {0, 1, 2, 3, 0, 0, 0}})),
              FailsAt(Reason::kSyntaxError, at(data + 48) + "a face with 2 corners"));
  EXPECT_THAT(ply(good + "x"),
              FailsAt(Reason::kSyntaxError, at(good.size()) + "content stands behind"));
  EXPECT_OK(ply(good + "\n"));
  EXPECT_THAT(
      ply(good.substr(0, good.size() - 1)),
      FailsAt(Reason::kTruncatedFile, at(data + 48) + "declares 3 values of 'vertex_indices'"));
}

TEST(ReadPly, HeaderDefectsNameTheirLine) {
  const auto fails = [](std::string from, std::string to, Reason reason, const std::string& start) {
    std::string header = kTextHeader;
    header.replace(header.find(from), from.size(), to);
    EXPECT_THAT(ply(header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
                FailsAt(reason, "part.ply:" + start))
        << to;
  };
  const auto syntax = [&](const std::string& from, const std::string& to,
                          const std::string& start) {
    fails(from, to, Reason::kSyntaxError, start);
  };
  syntax("ply\n", "ply x\n", "1: 'x' stands where the end of the line should be");
  syntax("ascii 1.0", "ascii 2.0", "2: '2.0' stands where the version 1.0 should be");
  syntax("ascii", "utf8", "2: 'utf8' stands where 'ascii'");
  syntax("format ascii 1.0\n", "", "8: the header has no line 'format'");
  syntax("element vertex 3", "element vertex", "3: the end of the line stands where a count");
  syntax("element vertex 3", "element vertex -3", "3: '-3' stands where a count");
  syntax("element vertex 3", "element point 3", "9: the header declares no vertices");
  syntax("element face 1", "element vertex 1", "7: the element 'vertex' is declared twice");
  syntax("float y", "float x", "5: the property 'x' is declared twice");
  syntax("float y", "float q", "3: the vertices have no number 'y'");
  syntax("property float y", "property list uchar int y", "3: the vertices have no number 'y'");
  syntax("float y", "real y", "5: 'real' stands where a type");
  syntax("property float y", "propertyfloat y", "5: 'propertyfloat' stands where 'element'");
  syntax("list uchar int", "list float int", "8: a list whose count is not an integer");
  syntax("list uchar int", "list uchar float", "7: the faces have no list of integers");
  syntax("vertex_indices", "vertices", "7: the faces have no list of integers 'vertex_indices'");
  syntax("element vertex 3\n", "", "3: 'property' stands where 'element' should be");
  fails("element face 1", "element face 0", Reason::kEmpty, "7: the file has no faces");
  fails("element face 1", "element edge 1", Reason::kEmpty, "9: the file has no faces");
  fails("element face 1", "element tristrips 1", Reason::kUnsupportedContent,
        "7: triangle strips are not supported");
  fails("element vertex 3", "element vertex 2000000000", Reason::kCountTooLarge,
        "3: declares 2000000000 elements 'vertex'");
  fails("element face 1", "element face 2000000000", Reason::kCountTooLarge,
        "7: declares 2000000000 elements 'face'");
  fails("element face 1", "element junk 99999999999\nproperty int a\nelement face 1",
        Reason::kCountTooLarge, "7: declares 99999999999 elements 'junk'");
  fails("element vertex 3", "element vertex 9", Reason::kTruncatedFile,
        "3: declares 9 elements 'vertex'");
  EXPECT_THAT(ply("ply\nformat ascii 1.0\nelement ver"),
              FailsAt(Reason::kTruncatedFile, "part.ply:3: the end of the file stands where"));
}

TEST(ReadPly, ElementsWithoutPropertiesTakeNoTime) {
  std::string header = kTextHeader;
  header.replace(header.find("element face"), 0, "element nothing 9000000000000000000\n");
  EXPECT_OK(ply(header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
}

}  // namespace
}  // namespace moduli
