#include "core/mesh/gifti.h"
#include "tests/core/mesh/gifti_text.h"
#include "tests/core/mesh/read_helpers.h"

namespace moduli {
namespace {

Result<TriangleSoup> gii(const std::string& bytes) {
  return parse(bytes, "a.gii");
}

Result<GiftiSurface> surfaceOf(const std::string& bytes) {
  Context context;
  return readGiftiSurface(context, bytes, {});
}

void expectTetrahedron(const Result<TriangleSoup>& soup) {
  ASSERT_OK(soup);
  EXPECT_EQ(soup->vertices, tetrahedronSoup().vertices);
  EXPECT_EQ(soup->faces, tetrahedronSoup().faces);
}

// The entries of an n x 3 table, column by column.
template <typename Number>
std::vector<Number> byColumns(const std::vector<Number>& rows) {
  std::vector<Number> columns;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = c; i < rows.size(); i += 3) columns.push_back(rows[i]);
  }
  return columns;
}

template <typename Number>
void encode(ArrayText& array, std::vector<Number> numbers, const std::string& encoding,
            bool big_endian, bool columns) {
  if (columns) numbers = byColumns(numbers);
  array.order = columns ? "ColumnMajorOrder" : "RowMajorOrder";
  array.encoding = encoding;
  array.endian = big_endian ? "BigEndian" : "LittleEndian";
  array.data.clear();
  if (encoding == "ASCII") {
    for (const Number x : numbers) array.data += " " + std::to_string(x);
    return;
  }
  const std::string bytes = bytesOf(numbers, big_endian);
  array.data = encodeBase64(encoding == "Base64Binary" ? bytes : deflateBytes(bytes));
}

const std::vector<float> kCoordinates = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
const std::vector<std::int32_t> kCorners = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};

TEST(ReadGifti, EveryEncodingByteOrderAndIndexingOrderGivesTheSameSurface) {
  for (const std::string encoding : {"ASCII", "Base64Binary", "GZipBase64Binary"}) {
    for (const bool big_endian : {false, true}) {
      for (const bool columns : {false, true}) {
        ArrayText points = tetrahedronPoints();
        ArrayText triangles = tetrahedronTriangles();
        encode(points, kCoordinates, encoding, big_endian, columns);
        encode(triangles, kCorners, encoding, !big_endian, !columns);
        expectTetrahedron(gii(tetrahedronGifti(points, triangles)));
        points.type = "FLOAT64";
        const std::vector<double> doubles(kCoordinates.begin(), kCoordinates.end());
        encode(points, doubles, encoding, big_endian, columns);
        expectTetrahedron(gii(tetrahedronGifti(points, triangles)));
      }
    }
  }
}

TEST(ReadGifti, DataWrittenByAnotherProgramIsRead) {
  struct Case {
    std::string encoding, order, points, triangles;
  };
  for (const Case& c : {
           Case{"Base64Binary", "RowMajorOrder",
                "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/",
                "AAAAAAIAAAABAAAAAAAAAAEAAAADAAAAAQAAAAIAAAADAAAAAgAAAAAAAAADAAAA"},
           Case{"Base64Binary", "ColumnMajorOrder",
                "AAAAAAAAgD8AAAAAAAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAAAAAIA/",
                "AAAAAAAAAAABAAAAAgAAAAIAAAABAAAAAgAAAAAAAAABAAAAAwAAAAMAAAADAAAA"},
           Case{"GZipBase64Binary", "RowMajorOrder",
                "eJxjYEAGDfYMBPgAJ70CPg==", "eJxjYGBgYAJiRgYIANHMUJoJymaCyoHYAAG4ABM="},
           Case{"GZipBase64Binary", "ColumnMajorOrder", "eJxjYACBBnsGDIBdDAAwsQI+",
                "eJxjYIAARiBmgmIYGybOjIQBAYQAEw=="},
       }) {
    ArrayText points = tetrahedronPoints();
    ArrayText triangles = tetrahedronTriangles();
    points.data = c.points;
    triangles.data = c.triangles;
    points.encoding = triangles.encoding = c.encoding;
    points.order = triangles.order = c.order;
    expectTetrahedron(gii(tetrahedronGifti(points, triangles)));
  }
}

TEST(ReadGifti, AGzippedFileIsReadWhateverItsName) {
  const std::string packed = gzipBytes(tetrahedronGifti());
  expectTetrahedron(parse(packed, "a.gii.gz"));
  expectTetrahedron(parse(packed, "-"));
  // A gzip file may have several members.
  const std::string text = tetrahedronGifti();
  expectTetrahedron(
      parse(gzipBytes(text.substr(0, 300)) + gzipBytes(text.substr(300)), "a.gii.gz"));
}

TEST(ReadGifti, WhiteSpaceMayStandWithinData) {
  ArrayText points = tetrahedronPoints();
  points.encoding = "Base64Binary";
  points.data = "\n  AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAA\r\n\tAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/ \n";
  expectTetrahedron(gii(tetrahedronGifti(points)));
}

TEST(ReadGifti, AsciiNumbersAreRoundedToTheDeclaredType) {
  ArrayText points = tetrahedronPoints();
  points.data = "0.1 0 nan 1 0 -inf 0 1 0 0 0 1e-60";
  auto soup = gii(tetrahedronGifti(points));
  ASSERT_OK(soup);
  EXPECT_EQ(soup->vertices[0][0], double{0.1F});
  EXPECT_TRUE(std::isnan(soup->vertices[0][2]));
  EXPECT_EQ(soup->vertices[1][2], -std::numeric_limits<double>::infinity());
  EXPECT_EQ(soup->vertices[3][2], 0);
  points.type = "FLOAT64";
  soup = gii(tetrahedronGifti(points));
  ASSERT_OK(soup);
  EXPECT_EQ(soup->vertices[0][0], 0.1);
  EXPECT_EQ(soup->vertices[3][2], 1e-60);
  points.type = "FLOAT32";
  points.data = "1e39 0 0 1 0 0 0 1 0 0 0 1";
  EXPECT_THAT(gii(tetrahedronGifti(points)),
              FailsAt(Reason::kSyntaxError,
                      "a.gii:4: array 'NIFTI_INTENT_POINTSET': '1e39' is no NIFTI_TYPE_FLOAT32"));
}

TEST(ReadGifti, TagsAreKeptAndTheMatrixIsNotApplied) {
  ArrayText points = tetrahedronPoints();
  points.inside =
      "<MetaData><MD><Name><![CDATA[AnatomicalStructurePrimary]]></Name>"
      "<Value> <![CDATA[CortexLeft]]>\n</Value></MD>"
      "<MD><Name>GeometricType</Name><Value>Pial &amp; more</Value></MD></MetaData>"
      "<CoordinateSystemTransformMatrix><DataSpace>NIFTI_XFORM_SCANNER_ANAT</DataSpace>"
      "<TransformedSpace>NIFTI_XFORM_TALAIRACH</TransformedSpace>"
      "<MatrixData>2 0 0 5\n0 2 0 6\n0 0 2 7\n0 0 0 1</MatrixData>"
      "</CoordinateSystemTransformMatrix>";
  ArrayText triangles = tetrahedronTriangles();
  triangles.inside =
      "<MetaData><MD><Name>TopologicalType</Name><Value>Closed</Value></MD></MetaData>";
  const auto surface =
      surfaceOf(giftiFile(points.text() + triangles.text(),
                          "<MetaData><MD><Name>Date</Name><Value/></MD></MetaData><LabelTable>"
                          "<Label Key=\"0\">Unknown</Label></LabelTable>"));
  ASSERT_OK(surface);
  EXPECT_EQ(surface->soup.vertices, tetrahedronSoup().vertices);
  const GiftiTags expected{
      {{"Date", ""}},
      {{"AnatomicalStructurePrimary", "CortexLeft"}, {"GeometricType", "Pial & more"}},
      {{"TopologicalType", "Closed"}},
      {{"NIFTI_XFORM_SCANNER_ANAT",
        "NIFTI_XFORM_TALAIRACH",
        {2, 0, 0, 5, 0, 2, 0, 6, 0, 0, 2, 7, 0, 0, 0, 1}}}};
  EXPECT_EQ(surface->tags, expected);
}

TEST(ReadGifti, ArraysOfOtherMeaningsArePassedOver) {
  ArrayText other{"RGB_VECTOR", "RGB24", "4 3", "?", "ExternalFileBinary"};
  expectTetrahedron(
      gii(giftiFile(other.text() + tetrahedronPoints().text() + tetrahedronTriangles().text())));
}

TEST(ReadGifti, WhatIsNoSurfaceIsRefusedByName) {
  const auto with = [](auto change) {
    ArrayText points = tetrahedronPoints();
    ArrayText triangles = tetrahedronTriangles();
    change(points, triangles);
    return gii(tetrahedronGifti(points, triangles));
  };
  using A = ArrayText&;
  const std::string points = "a.gii:4: array 'NIFTI_INTENT_POINTSET': ";
  const std::string triangles = "a.gii:5: array 'NIFTI_INTENT_TRIANGLE': ";
  EXPECT_THAT(with([](A p, A) { p.encoding = "ExternalFileBinary"; }),
              FailsAt(Reason::kUnsupportedContent, points + "the encoding 'ExternalFileBinary'"));
  EXPECT_THAT(with([](A p, A) { p.type = "INT32"; }),
              FailsAt(Reason::kUnsupportedContent, points + "coordinates are of type"));
  EXPECT_THAT(
      with([](A p, A) { p.type = "FLOAT16"; }),
      FailsAt(Reason::kUnsupportedContent, points + "numbers of type 'NIFTI_TYPE_FLOAT16'"));
  EXPECT_THAT(with([](A, A t) { t.type = "FLOAT32"; }),
              FailsAt(Reason::kUnsupportedContent, triangles + "vertex numbers are of type"));
  EXPECT_THAT(with([](A p, A) { p.dimensions = "12"; }),
              FailsAt(Reason::kSyntaxError, points + "is no table with 3 columns"));
  EXPECT_THAT(with([](A p, A) { p.dimensions = "3 4"; }),
              FailsAt(Reason::kSyntaxError, points + "is no table with 3 columns"));
  EXPECT_THAT(
      with([](A, A t) { t.intent = "SHAPE"; }),
      FailsAt(Reason::kUnsupportedContent, "a.gii:1: the file has no NIFTI_INTENT_TRIANGLE"));
  EXPECT_THAT(with([](A, A t) { t.intent = "POINTSET"; }),
              FailsAt(Reason::kUnsupportedContent,
                      "a.gii:5: array 'NIFTI_INTENT_POINTSET': the "
                      "file has a second one"));
  EXPECT_THAT(with([](A, A t) { t.dimensions = "0 3", t.data = ""; }),
              FailsAt(Reason::kEmpty, triangles + "the file has no triangles"));
  EXPECT_THAT(with([](A, A t) { t.data = "0 2 1 0 1 3 1 2 3 2 0 4"; }),
              FailsAt(Reason::kIndexOutOfRange,
                      triangles + "a face uses vertex 4, but the file has 4 vertices"));
  EXPECT_THAT(with([](A, A t) { t.data = "0 2 1 0 1 3 1 2 3 2 0 -1"; }),
              FailsAt(Reason::kIndexOutOfRange, triangles + "a face uses vertex -1"));
  EXPECT_THAT(with([](A, A t) { t.data = "0 2 1 0 1 3 1 2 3 2 0 0.5"; }),
              FailsAt(Reason::kSyntaxError, triangles + "'0.5' is no NIFTI_TYPE_INT32"));
}

TEST(ReadGifti, DataThatDoNotFitTheirDimensionsAreRefused) {
  const auto points = [](const std::string& encoding, const std::string& data,
                         const std::string& dimensions = "4 3") {
    ArrayText array = tetrahedronPoints();
    array.encoding = encoding;
    array.data = data;
    array.dimensions = dimensions;
    return gii(tetrahedronGifti(array));
  };
  const std::string place = "a.gii:4: array 'NIFTI_INTENT_POINTSET': ";
  const std::string bytes = bytesOf(kCoordinates, false);
  EXPECT_THAT(points("ASCII", "0 0 0 1 0 0 0 1 0 0 0"),
              FailsAt(Reason::kTruncatedFile, place + "declares 12 numbers, but the data have"));
  EXPECT_THAT(points("ASCII", "0 0 0 1 0 0 0 1 0 0 0 1 2"),
              FailsAt(Reason::kSyntaxError, place + "declares 12 numbers, but the data have more"));
  EXPECT_THAT(points("Base64Binary", encodeBase64(bytes.substr(1))),
              FailsAt(Reason::kTruncatedFile, place + "declares 12 numbers, but the data have 47"));
  EXPECT_THAT(points("Base64Binary", encodeBase64(bytes + "1234")),
              FailsAt(Reason::kSyntaxError, place + "declares 12 numbers, but the data have 52"));
  EXPECT_THAT(points("Base64Binary", encodeBase64(bytes).substr(1)),
              FailsAt(Reason::kTruncatedFile, place + "base64 text ends within a group"));
  EXPECT_THAT(points("Base64Binary", "*" + encodeBase64(bytes)),
              FailsAt(Reason::kSyntaxError, place + "'*' stands where base64 text should be"));
  EXPECT_THAT(
      points("GZipBase64Binary", encodeBase64(deflateBytes(bytes + "1"))),
      FailsAt(Reason::kCountTooLarge, place + "the compressed bytes expand to more than 48"));
  EXPECT_THAT(points("GZipBase64Binary", encodeBase64(deflateBytes(bytes.substr(4)))),
              FailsAt(Reason::kTruncatedFile, place + "declares 12 numbers, but the data have 44"));
  EXPECT_THAT(points("GZipBase64Binary", encodeBase64(deflateBytes(bytes) + "x")),
              FailsAt(Reason::kSyntaxError, place + "the compressed bytes are damaged: 1 bytes"));
  for (const std::string rows : {"4000000000", "9223372036854775807"}) {
    for (const std::string encoding : {"ASCII", "Base64Binary", "GZipBase64Binary"}) {
      EXPECT_THAT(points(encoding, "AAAA", rows + " 3"), FailsAt(Reason::kCountTooLarge, place));
    }
  }
}

TEST(ReadGifti, TheOutlineOfTheFileIsChecked) {
  const std::string good = tetrahedronGifti();
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return gii(text.replace(at, from.size(), to));
  };
  EXPECT_THAT(changed("<GIFTI V", "<GIFTI NumberOfDataArrays=\"3\" V"),
              FailsAt(Reason::kSyntaxError, "a.gii:6: NumberOfDataArrays is 3, but there are 2"));
  EXPECT_THAT(changed("</Data>", "</Data><Data/>"),
              FailsAt(Reason::kSyntaxError, "a.gii:4: a DataArray has a second Data element"));
  EXPECT_THAT(changed("<Data>", "<Extra/><Data>"),
              FailsAt(Reason::kSyntaxError, "a.gii:4: an element 'Extra' has no place here"));
  EXPECT_THAT(changed("<DataArray", "stray<DataArray"),
              FailsAt(Reason::kSyntaxError, "a.gii:4: 'stray' stands between elements"));
  EXPECT_THAT(changed("<Data>", "<MetaData><MD><Value>x</Value></MD></MetaData><Data>"),
              FailsAt(Reason::kSyntaxError, "a.gii:4: an MD element has no Name"));
  EXPECT_THAT(changed("Dimensionality=\"2\"", "Dimensionality=\"1\""),
              FailsAt(Reason::kSyntaxError, "a.gii:4: a DataArray's Dimensionality"));
  EXPECT_THAT(changed("Dim0=\"4\"", "Dim0=\"-4\""),
              FailsAt(Reason::kSyntaxError, "a.gii:4: Dim0='-4' is not a count"));
  EXPECT_THAT(changed("RowMajorOrder", "AnyOrder"),
              FailsAt(Reason::kSyntaxError, "a.gii:4: ArrayIndexingOrder='AnyOrder' is neither"));
  EXPECT_THAT(changed("</GIFTI>", "</GIFTY>"),
              FailsAt(Reason::kSyntaxError, "a.gii:6: is no well-formed XML: mismatched tag"));
  Context context;
  ReadOptions options;
  options.format = MeshFormat::kGifti;
  EXPECT_THAT(readMesh(context, "<svg/>", options),
              FailsAt(Reason::kSyntaxError, "mesh:1: the outermost element is 'svg', not GIFTI"));
}

TEST(ReadGifti, BinaryDataNeedTheirByteOrder) {
  ArrayText points = tetrahedronPoints();
  points.encoding = "Base64Binary";
  points.data = encodeBase64(bytesOf(kCoordinates, false));
  points.endian = "Whatever";
  EXPECT_THAT(gii(tetrahedronGifti(points)),
              FailsAt(Reason::kSyntaxError,
                      "a.gii:4: array 'NIFTI_INTENT_POINTSET': Endian='Whatever' is neither"));
}

TEST(ReadGifti, EntitiesAreRefusedBeforeTheyExpand) {
  std::string bomb = "<!DOCTYPE GIFTI [<!ENTITY a \"aaaaaaaaaa\">";
  for (char c = 'b'; c < 'k'; ++c) {
    const std::string use = std::string("&") + static_cast<char>(c - 1) + ";";
    bomb += std::string("\n<!ENTITY ") + c + " \"" + use + use + use + use + use + use + "\">";
  }
  EXPECT_THAT(gii(bomb + "]><GIFTI>&j;</GIFTI>"),
              FailsAt(Reason::kUnsupportedContent, "a.gii:1: uses an entity of its own, 'a'"));
  // With an external document type an unknown entity is no error of XML: it would be passed over.
  std::string text = tetrahedronGifti();
  text.replace(text.find("0 0 0 1"), 1, "&zero;");
  EXPECT_THAT(gii(text),
              FailsAt(Reason::kUnsupportedContent, "a.gii:4: uses an entity of its own, 'zero'"));
}

TEST(ReadGifti, MoreFacesThanAllowedAreRefusedBeforeTheyAreDecoded) {
  ArrayText triangles = tetrahedronTriangles();
  triangles.data = "nonsense";
  Context context;
  ReadOptions options;
  options.max_faces = 3;
  EXPECT_THAT(readMesh(context, tetrahedronGifti(tetrahedronPoints(), triangles), options),
              FailsWith(Reason::kMeshTooLarge));
  options.max_faces = 4;
  EXPECT_OK(readMesh(context, tetrahedronGifti(), options));
}

TEST(ReadGifti, ACancelledCallerGetsNoSurface) {
  Context context;
  CancelToken token;
  context.setCancelToken(token);
  token.cancel();
  EXPECT_THAT(readGiftiSurface(context, tetrahedronGifti(), {}), FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
