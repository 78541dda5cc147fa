#include <cmath>
#include <limits>

#include "core/mesh/gifti.h"
#include "core/mesh/write.h"
#include "tests/core/mesh/gifti_text.h"
#include "tests/core/mesh/read_helpers.h"

namespace moduli {
namespace {

constexpr GiftiEncoding kEncodings[] = {GiftiEncoding::kAscii, GiftiEncoding::kBase64,
                                        GiftiEncoding::kGzipBase64};

Result<GiftiSurface> thereAndBack(const TriangleSoup& soup, const GiftiWriteOptions& options) {
  ASSIGN_OR_RETURN(const std::string bytes, writeGiftiSurface(soup, options));
  Context context;
  return readGiftiSurface(context, bytes, {});
}

// Numbers of every size that float32 has, from a generator of our own.
TriangleSoup manyNumbers() {
  TriangleSoup soup;
  std::uint64_t state = 3;
  for (int v = 0; v < 300; ++v) {
    Eigen::Vector3d p;
    for (double& x : p) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      const auto mantissa = static_cast<double>(state >> 11U) * 0x1p-53 - 0.5;
      x = std::ldexp(mantissa, static_cast<int>(state % 240) - 120);
    }
    soup.vertices.push_back(p);
  }
  for (Index i = 0; i + 2 < 300; ++i) soup.faces.push_back({i, i + 2, i + 1});
  return soup;
}

TEST(WriteGifti, DoublesComeBackToTheLastBitInEveryEncoding) {
  TriangleSoup soup = manyNumbers();
  soup.vertices[7] = {1e300, -0.0, 5e-324};
  soup.vertices[8] = {std::numeric_limits<double>::infinity(), 1, 2};
  for (const GiftiEncoding encoding : kEncodings) {
    GiftiWriteOptions options;
    options.encoding = encoding;
    options.doubles = true;
    const auto back = thereAndBack(soup, options);
    ASSERT_OK(back);
    EXPECT_EQ(back->soup.vertices, soup.vertices);
    EXPECT_TRUE(std::signbit(back->soup.vertices[7][1]));
    EXPECT_EQ(back->soup.faces, soup.faces);
  }
}

TEST(WriteGifti, Float32IsTheNearestAndTheSameInEveryEncoding) {
  const TriangleSoup soup = manyNumbers();
  for (const GiftiEncoding encoding : kEncodings) {
    GiftiWriteOptions options;
    options.encoding = encoding;
    const auto back = thereAndBack(soup, options);
    ASSERT_OK(back);
    for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
      for (int i = 0; i < 3; ++i) {
        const auto nearest = static_cast<float>(soup.vertices[v][i]);
        ASSERT_EQ(back->soup.vertices[v][i], double{nearest});
      }
    }
    EXPECT_EQ(back->soup.faces, soup.faces);
  }
}

TEST(WriteGifti, WritingWhatWasReadGivesTheSameBytes) {
  for (const GiftiEncoding encoding : kEncodings) {
    for (const bool doubles : {false, true}) {
      GiftiWriteOptions options;
      options.encoding = encoding;
      options.doubles = doubles;
      const auto bytes = writeGiftiSurface(manyNumbers(), options);
      ASSERT_OK(bytes);
      Context context;
      const auto back = readGiftiSurface(context, *bytes, {});
      ASSERT_OK(back);
      options.tags = back->tags;
      const auto again = writeGiftiSurface(back->soup, options);
      ASSERT_OK(again);
      EXPECT_EQ(*again, *bytes);
    }
  }
}

TEST(WriteGifti, TagsComeBack) {
  GiftiWriteOptions options;
  options.tags.file = {{"Comment", "a < b & c > \"d\"\nsecond line\r\tend"}, {"Empty", ""}};
  options.tags.points = {{"AnatomicalStructurePrimary", "CortexRight"}, {"Name", "größe 脳"}};
  options.tags.triangles = {{"TopologicalType", "Closed"}};
  options.tags.coordinates = {{"NIFTI_XFORM_SCANNER_ANAT",
                               "NIFTI_XFORM_MNI_152",
                               {0.1, 0, 0, -7.25, 0, 1e-9, 0, 3, 0, 0, -1, 0, 0, 0, 0, 1}},
                              {}};
  const auto back = thereAndBack(tetrahedronSoup(), options);
  ASSERT_OK(back);
  EXPECT_EQ(back->tags, options.tags);
}

TEST(WriteGifti, PointsWithoutACoordinateSystemGetTheNeutralOne) {
  const auto back = thereAndBack(tetrahedronSoup(), {});
  ASSERT_OK(back);
  EXPECT_EQ(back->tags.coordinates, std::vector<GiftiCoordinateSystem>(1));
}

TEST(WriteGifti, TagsThatXmlCannotHoldAreRefused) {
  for (const std::string& bad :
       {std::string("a\0b", 3), std::string("\x1B"), std::string("\xFF")}) {
    GiftiWriteOptions options;
    options.tags.points = {{"Name", bad}};
    EXPECT_THAT(writeGiftiSurface(tetrahedronSoup(), options),
                FailsAt(Reason::kInvalidOption, "a GIFTI tag has no name, or is no text"));
    options.tags.points = {{bad, "x"}};
    EXPECT_THAT(writeGiftiSurface(tetrahedronSoup(), options), FailsWith(Reason::kInvalidOption));
    options.tags = {};
    options.tags.coordinates = {{bad, "x", {}}};
    EXPECT_THAT(writeGiftiSurface(tetrahedronSoup(), options), FailsWith(Reason::kInvalidOption));
  }
  GiftiWriteOptions options;
  options.tags.file = {{"", "x"}};
  EXPECT_THAT(writeGiftiSurface(tetrahedronSoup(), options), FailsWith(Reason::kInvalidOption));
}

TEST(WriteGifti, CoordinatesBeyondFloat32AreRefusedUnlessDoublesAreWritten) {
  TriangleSoup soup = tetrahedronSoup();
  soup.vertices[2][1] = -1e39;
  EXPECT_THAT(writeGiftiSurface(soup), FailsAt(Reason::kInvalidOption, "vertex 2 lies beyond"));
  GiftiWriteOptions options;
  options.doubles = true;
  EXPECT_OK(writeGiftiSurface(soup, options));
}

TEST(WriteGifti, MeshWritingChoosesAsciiForTextAndCompressionForBinary) {
  const auto text = writeMesh(tetrahedronSoup(), MeshFormat::kGifti);
  const auto binary = writeMesh(tetrahedronSoup(), MeshFormat::kGifti, Encoding::kBinary);
  ASSERT_OK(text);
  ASSERT_OK(binary);
  EXPECT_NE(text->find("Encoding=\"ASCII\""), std::string::npos);
  EXPECT_NE(text->find("<Data>0 0 0\n1 0 0\n0 1 0\n0 0 1\n</Data>"), std::string::npos);
  EXPECT_NE(binary->find("Encoding=\"GZipBase64Binary\""), std::string::npos);
  for (const auto& bytes : {*text, *binary}) {
    const auto back = parse(bytes, "x");
    ASSERT_OK(back);
    EXPECT_EQ(back->vertices, tetrahedronSoup().vertices);
    EXPECT_EQ(back->faces, tetrahedronSoup().faces);
  }
  EXPECT_THAT(writeMesh(tetrahedronSoup(), MeshFormat::kFreeSurfer),
              FailsAt(Reason::kInvalidOption, "surfaces of FreeSurfer are read, not written"));
}

TEST(WriteGifti, BrainSurfacesComeBackUnchanged) {
  MODULI_NEED_SHARED_MESH(first, "brain/nilearn__pial_left.ply");
  for (const std::string& path : sharedMeshes("brain")) {
    Context context;
    const auto soup = readMeshFile(context, path);
    ASSERT_OK(soup) << first;
    for (const GiftiEncoding encoding : kEncodings) {
      GiftiWriteOptions options;
      options.encoding = encoding;
      options.doubles = true;
      const auto back = thereAndBack(*soup, options);
      ASSERT_OK(back);
      EXPECT_TRUE(back->soup.vertices == soup->vertices) << path;
      EXPECT_TRUE(back->soup.faces == soup->faces) << path;
    }
    const auto bytes = writeGiftiSurface(*soup);
    ASSERT_OK(bytes);
    EXPECT_OK(parse(gzipBytes(*bytes), "x.gii.gz"));
  }
}

}  // namespace
}  // namespace moduli
