#include "core/mesh/freesurfer.h"
#include "tests/core/mesh/freesurfer_bytes.h"
#include "tests/core/mesh/read_helpers.h"

namespace moduli {
namespace {

Result<TriangleSoup> pial(const std::string& bytes) {
  return parse(bytes, "lh.pial");
}

TEST(ReadFreeSurfer, TheSurfaceIsAsTheFileHasIt) {
  TriangleSoup soup = tetrahedronSoup();
  soup.vertices[3] = {-12.5, 0.25, 1e-3F};
  for (const std::string name : {"lh.pial", "lh.white", "x", "x.obj", "x.stl"}) {
    const auto read = parse(freeSurferSurface(soup), name);
    ASSERT_OK(read);
    EXPECT_EQ(read->vertices, soup.vertices);
    EXPECT_EQ(read->faces, soup.faces);
  }
}

TEST(ReadFreeSurfer, AFileOfAnotherProgramIsRead) {
  // A tetrahedron with the footer that tells the geometry of the volume.
  const auto text = decodeBase64(
      "///+Y3JlYXRlZCBieSB0CgoAAAAEAAAABAAAAAAAAAAAAAAAAD+AAAAAAAAAAAAAAAAAAAA/gAAAAAAAAAAAAAAA"
      "AAAAP4AAAAAAAAAAAAACAAAAAQAAAAAAAAABAAAAAwAAAAEAAAACAAAAAwAAAAIAAAAAAAAAAwAAAAIAAAAAAAAA"
      "FHZhbGlkID0gMQpmaWxlbmFtZSA9IHgKdm9sdW1lID0gMjU2IDI1NiAyNTYKdm94ZWxzaXplID0gMSAxIDEKeHJh"
      "cyAgID0gMSAxIDEKeXJhcyAgID0gMSAxIDEKenJhcyAgID0gMSAxIDEKY3JhcyAgID0gMSAxIDEK");
  ASSERT_OK(text);
  const auto read = pial(*text);
  ASSERT_OK(read);
  EXPECT_EQ(read->vertices, tetrahedronSoup().vertices);
  EXPECT_EQ(read->faces, tetrahedronSoup().faces);
}

TEST(ReadFreeSurfer, CommentsOfOneLineOrSeveralArePassedOver) {
  for (const std::string comment :
       {"\n", "created by x\n", "created by x\n\n", "one\ntwo\n\nthree\n\n",
        "gr\xC3\xB6\xC3\x9F"
        "e\r\n\n"}) {
    const auto read = pial(freeSurferSurface(tetrahedronSoup(), comment));
    ASSERT_OK(read) << comment;
    EXPECT_EQ(read->faces, tetrahedronSoup().faces);
  }
  EXPECT_THAT(pial(freeSurferSurface(tetrahedronSoup(), "no line end")),
              FailsAt(Reason::kSyntaxError, "lh.pial: byte 14: the comment does not end"));
  EXPECT_THAT(pial(freeSurferSurface(tetrahedronSoup(), "")),
              FailsAt(Reason::kSyntaxError, "lh.pial: byte 3: the comment does not end"));
}

TEST(ReadFreeSurfer, AnyFooterIsTolerated) {
  for (const std::size_t size : {1U, 3U, 4000U}) {
    EXPECT_OK(pial(freeSurferSurface(tetrahedronSoup()) + std::string(size, '\2')));
  }
}

TEST(ReadFreeSurfer, DamageIsNamedWithItsPlace) {
  const std::string good = freeSurferSurface(tetrahedronSoup());
  // Magic and comment end at 20, the counts at 28, the points at 76.
  for (std::size_t size = 3; size < good.size(); ++size) {
    EXPECT_THAT(pial(good.substr(0, size)), FailsAt(Reason::kTruncatedFile, "lh.pial: byte "));
  }
  std::string bad = good;
  bad[79] = 4;
  EXPECT_THAT(pial(bad), FailsAt(Reason::kIndexOutOfRange,
                                 "lh.pial: byte 76: a face uses vertex 4, but the file has 4"));
  bad[76] = '\xFF';
  EXPECT_THAT(pial(bad),
              FailsAt(Reason::kIndexOutOfRange, "lh.pial: byte 76: a face uses vertex -16777212"));
  bad = good;
  bad[21] = 1;
  EXPECT_THAT(pial(bad),
              FailsAt(Reason::kCountTooLarge, "lh.pial: byte 20: declares 65540 vertices"));
  bad = good;
  bad[25] = 1;
  EXPECT_THAT(pial(bad),
              FailsAt(Reason::kCountTooLarge, "lh.pial: byte 24: declares 65540 triangles"));
  TriangleSoup no_faces = tetrahedronSoup();
  no_faces.faces.clear();
  EXPECT_THAT(pial(freeSurferSurface(no_faces)),
              FailsAt(Reason::kEmpty, "lh.pial: byte 24: the file has no triangles"));
  Context context;
  ReadOptions options;
  options.max_faces = 3;
  EXPECT_THAT(readMesh(context, good, options), FailsWith(Reason::kMeshTooLarge));
  options.format = MeshFormat::kFreeSurfer;
  EXPECT_THAT(readMesh(context, "OFF\n", options),
              FailsAt(Reason::kSyntaxError, "mesh: byte 0: the file does not begin with FF FF FE"));
}

TEST(ReadFreeSurfer, FilesThatAreNoTriangleSurfaceAreRefusedByName) {
  EXPECT_THAT(pial(freeSurferQuads({1, 2, 3, 4, 5, 6})),
              FailsAt(Reason::kUnsupportedContent, "lh.pial: byte 0: surfaces of quadrangles"));
  EXPECT_THAT(pial("\xFF\xFF\xFD"),
              FailsAt(Reason::kUnsupportedContent, "lh.pial: byte 0: surfaces of quadrangles"));
  EXPECT_THAT(pial(freeSurferValues({1, 2, 3, 4})),
              FailsAt(Reason::kUnsupportedContent, "lh.pial: byte 0: the file holds values"));
}

TEST(FreeSurferFile, ValuesAndQuadranglesAreToldApart) {
  using enum FreeSurferFile;
  EXPECT_EQ(freeSurferFile(freeSurferValues({1, 2, 3, 4})), kValues);
  EXPECT_EQ(freeSurferFile(freeSurferValues({1, 2, 3, 4}).substr(0, 20)), kValues);  // Cut off.
  EXPECT_EQ(freeSurferFile(freeSurferValues({1, 2, 3, 4}, 4, 2)), kQuads);
  EXPECT_EQ(freeSurferFile(freeSurferQuads({0, 1, 2, 3, 4, 5})), kQuads);
  // The first point is where values would say that there is one a vertex; only the size tells.
  EXPECT_EQ(freeSurferFile(freeSurferQuads({7, 7, 0, 0, 0, 1})), kQuads);
  EXPECT_EQ(freeSurferFile(freeSurferSurface(tetrahedronSoup())), kTriangles);
  EXPECT_EQ(freeSurferFile("\xFF\xFF\xFD"), kQuads);
  EXPECT_EQ(freeSurferFile("\xFF\xFF"), std::nullopt);
  EXPECT_EQ(freeSurferFile("OFF\n"), std::nullopt);
}

}  // namespace
}  // namespace moduli
