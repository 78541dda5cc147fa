#include "core/mesh/vertex_data.h"

#include <cmath>

#include "tests/core/mesh/freesurfer_bytes.h"
#include "tests/core/mesh/read_helpers.h"

namespace moduli {
namespace {

const std::vector<double> kValues = {0.5, -1, 2, 3.25};

Result<VertexData> values(const std::string& bytes, std::size_t count = 4) {
  Context context;
  return readVertexData(context, bytes, "lh.sulc", count);
}

ArrayText shape(const std::string& intent = "SHAPE") {
  return {intent, "FLOAT32", "4", "0.5 -1 2 3.25"};
}

TEST(VertexData, EveryFormatGivesTheSameValues) {
  ArrayText packed = shape();
  packed.encoding = "GZipBase64Binary";
  packed.data = "eJxjYGCwZ2Bo2M/AwODAwBDgAAARGgJP";  // As another program wrote it.
  ArrayText column = shape("NONE");
  column.dimensions = "4 1";
  column.type = "FLOAT64";
  for (const std::string& bytes :
       {std::string("0.5\n-1\n2\n3.25\n"),
        std::string("\xEF\xBB\xBF# sulc\n 0.5\r\n\n-1 # x\n2\n3.25"),
        freeSurferValues({0.5F, -1, 2, 3.25F}), giftiFile(shape().text()), giftiFile(packed.text()),
        giftiFile(column.text()), gzipBytes(giftiFile(shape().text())),
        giftiFile(tetrahedronPoints().text() + shape().text())}) {
    const auto data = values(bytes);
    ASSERT_OK(data) << bytes;
    EXPECT_EQ(data->values, kValues) << bytes;
    EXPECT_EQ(data->name, "");
  }
}

TEST(VertexData, IntegersOfGiftiAreValues) {
  EXPECT_EQ(values(giftiFile(ArrayText{"NONE", "INT32", "2", "-5 7"}.text()), 2)->values,
            (std::vector<double>{-5, 7}));
  ArrayText bytes{"NONE", "UINT8", "3", encodeBase64("\x01\xFF\x10"), "Base64Binary"};
  EXPECT_EQ(values(giftiFile(bytes.text()), 3)->values, (std::vector<double>{1, 255, 16}));
  EXPECT_THAT(values(giftiFile(ArrayText{"NONE", "UINT8", "2", "1 256"}.text()), 2),
              FailsAt(Reason::kSyntaxError, "lh.sulc:4: array 'NIFTI_INTENT_NONE': '256' is no"));
}

TEST(VertexData, WhatIsNotFiniteIsReadAsSuch) {
  EXPECT_TRUE(std::isnan(values("nan\n", 1)->values[0]));
  EXPECT_TRUE(std::isnan(values(freeSurferValues({NAN}), 1)->values[0]));
  EXPECT_TRUE(std::isinf(values("-inf\n", 1)->values[0]));
}

TEST(VertexData, AnotherNumberOfVerticesIsRefused) {
  for (const std::string& bytes : {std::string("0.5\n-1\n2\n3.25\n"), giftiFile(shape().text()),
                                   freeSurferValues({0.5F, -1, 2, 3.25F})}) {
    for (const std::size_t count : {0U, 3U, 5U, 1000000000U}) {
      const auto data = values(bytes, count);
      EXPECT_THAT(data, FailsWith(Reason::kUnsupportedContent));
      EXPECT_NE(data.status().message().find("4 values, but the surface has " +
                                             std::to_string(count) + " vertices"),
                std::string::npos)
          << data.status().toString();
    }
  }
}

TEST(VertexData, WhatIsNotOneValueAVertexIsRefused) {
  ArrayText several = shape();
  several.dimensions = "2 2";
  EXPECT_THAT(values(giftiFile(several.text()), 2),
              FailsAt(Reason::kUnsupportedContent,
                      "lh.sulc:4: array 'NIFTI_INTENT_SHAPE': has several values a vertex"));
  several.dimensions = "4 4611686018427387905";  // 4 modulo 2^64.
  EXPECT_THAT(values(giftiFile(several.text())),
              FailsAt(Reason::kUnsupportedContent,
                      "lh.sulc:4: array 'NIFTI_INTENT_SHAPE': has several values a vertex"));
  EXPECT_THAT(values(giftiFile(shape().text() + shape("NONE").text())),
              FailsAt(Reason::kUnsupportedContent,
                      "lh.sulc:5: array 'NIFTI_INTENT_NONE': the file has a second array"));
  EXPECT_THAT(values(giftiFile(shape().text() + shape("NODE_INDEX").text())),
              FailsAt(Reason::kUnsupportedContent,
                      "lh.sulc:5: array 'NIFTI_INTENT_NODE_INDEX': the file has values for some"));
  EXPECT_THAT(values(tetrahedronGifti()), FailsAt(Reason::kUnsupportedContent,
                                                  "lh.sulc:1: the file has no NIFTI_INTENT_SHAPE"));
  EXPECT_THAT(values(freeSurferSurface(tetrahedronSoup())),
              FailsAt(Reason::kUnsupportedContent, "lh.sulc: byte 0: the file holds a surface"));
  EXPECT_THAT(values(freeSurferQuads({7, 7, 0, 0, 0, 1})),
              FailsAt(Reason::kUnsupportedContent, "lh.sulc: byte 0: the file holds a surface"));
  EXPECT_THAT(values("1 2\n"),
              FailsAt(Reason::kSyntaxError, "lh.sulc:1: '2' stands behind the number"));
  EXPECT_THAT(values("1\nx\n"), FailsAt(Reason::kSyntaxError, "lh.sulc:2: 'x' is not a number"));
  EXPECT_THAT(values(""), FailsAt(Reason::kEmpty, "lh.sulc: byte 0: the file is empty"));
  EXPECT_THAT(values(std::string("\0\1\2", 3)),
              FailsAt(Reason::kUnknownFormat, "lh.sulc: byte 0: the content is no GIFTI file"));
}

TEST(VertexData, DamagedFilesOfFreeSurferAreRefused) {
  const std::string good = freeSurferValues({0.5F, -1, 2, 3.25F});
  for (std::size_t size = 3; size < good.size(); ++size) {
    EXPECT_THAT(values(good.substr(0, size)), FailsAt(Reason::kTruncatedFile, "lh.sulc: byte "));
  }
  EXPECT_THAT(values(good + "x"),
              FailsAt(Reason::kSyntaxError, "lh.sulc: byte 31: bytes stand behind the last value"));
  std::string huge = good;
  huge[3] = '\x7F';
  EXPECT_THAT(values(huge), FailsAt(Reason::kCountTooLarge, "lh.sulc: byte 3: declares 213070"));
}

TEST(VertexData, ShapeFilesComeBackInEveryEncoding) {
  VertexData data;
  data.name = "sulc <deep>";
  for (int i = 0; i < 1000; ++i) data.values.push_back(std::sin(i) * std::exp(i * 0.05));
  data.values.push_back(NAN);
  for (const auto encoding :
       {GiftiEncoding::kAscii, GiftiEncoding::kBase64, GiftiEncoding::kGzipBase64}) {
    for (const bool doubles : {false, true}) {
      GiftiWriteOptions options;
      options.encoding = encoding;
      options.doubles = doubles;
      options.tags.file = {{"AnatomicalStructurePrimary", "CortexLeft"}};
      const auto bytes = writeGiftiShape(data, options);
      ASSERT_OK(bytes);
      EXPECT_NE(bytes->find("CortexLeft"), std::string::npos);
      const auto back = values(*bytes, data.values.size());
      ASSERT_OK(back);
      EXPECT_EQ(back->name, data.name);
      for (std::size_t v = 0; v < 1000; ++v) {
        const double expected = doubles ? data.values[v] : static_cast<float>(data.values[v]);
        ASSERT_EQ(back->values[v], expected);
      }
      EXPECT_TRUE(std::isnan(back->values[1000]));
    }
  }
}

TEST(VertexData, ShapeFilesHoldWhatFloat32Holds) {
  EXPECT_THAT(writeGiftiShape({{0, 1e39}, ""}),
              FailsAt(Reason::kInvalidOption, "the value of vertex 1 lies beyond the range"));
  EXPECT_THAT(writeGiftiShape({{0}, "\x01"}), FailsWith(Reason::kInvalidOption));
}

}  // namespace
}  // namespace moduli
