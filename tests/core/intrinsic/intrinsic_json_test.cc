#include "core/intrinsic/intrinsic_json.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/intrinsic/intrinsic_samples.h"
#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using testing::HasSubstr;

Result<IntrinsicSurface> read(const std::string& text, std::size_t max_faces = 100'000) {
  Context context;
  return readIntrinsicJson(context, text, {"input", max_faces});
}

/// A file from its parts; each can be replaced to plant a defect. Without more it is the flat torus
/// made of two triangles on one vertex.
struct Parts {
  std::string format = "\"moduli-intrinsic-triangulation\"";
  std::string version = "1";
  std::string geometry = "\"euclidean\"";
  std::string vertices = "1";
  std::string faces = "[[0, 0, 0], [0, 0, 0]]";
  std::string gluing = "[[4, 5, 3], [2, 0, 1]]";
  std::string lengths = "[[1, 1, 1.25], [1.25, 1, 1]]";
  std::string more;

  std::string text() const {
    std::string all = "{\"format\": " + format + ", \"version\": " + version +
                      ", \"geometry\": " + geometry + ", \"vertices\": " + vertices +
                      ", \"faces\": " + faces;
    if (!gluing.empty()) all += ", \"gluing\": " + gluing;
    return all + ", \"lengths\": " + lengths + more + "}\n";
  }
};

/// A tetrahedron without a gluing.
Parts tetrahedron() {
  Parts parts;
  parts.vertices = "4";
  parts.faces = "[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]";
  parts.gluing = "";
  parts.lengths = "[[1, 1, 1], [1, 1, 1], [1, 1, 1], [1, 1, 1]]";
  return parts;
}

void expectRefused(const std::string& text, Reason reason, const std::string& words) {
  SCOPED_TRACE(text.substr(0, 400));
  const auto surface = read(text);
  ASSERT_THAT(surface, FailsWith(reason));
  const Status status = surface.status();
  EXPECT_TRUE(status.message().starts_with("input: ")) << status.message();
  EXPECT_THAT(status.message(), HasSubstr(words));
  EXPECT_FALSE(status.hint().empty());
  EXPECT_EQ(status.message().find('\n'), std::string::npos);
}

void expectSame(const IntrinsicSurface& a, const IntrinsicSurface& b) {
  EXPECT_EQ(a.geometry, b.geometry);
  EXPECT_EQ(a.connectivity.faces(), b.connectivity.faces());
  ASSERT_EQ(a.connectivity.halfedgeCount(), b.connectivity.halfedgeCount());
  for (Index h = 0; h < a.connectivity.halfedgeCount(); ++h) {
    EXPECT_EQ(a.connectivity.twin(h), b.connectivity.twin(h));
  }
  ASSERT_EQ(a.lengths.size(), b.lengths.size());
  for (std::size_t e = 0; e < a.lengths.size(); ++e) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a.lengths[e]),
              std::bit_cast<std::uint64_t>(b.lengths[e]));
  }
}

TEST(IntrinsicJson, ReadsTheGluingAndLengthsThatTheFileStates) {
  const auto torus = read(Parts().text());
  ASSERT_OK(torus);
  EXPECT_EQ(torus->geometry, Geometry::kEuclidean);
  EXPECT_EQ(torus->connectivity.eulerCharacteristic(), 0);
  EXPECT_EQ(torus->connectivity.twin(0), 4);
  EXPECT_EQ(torus->lengths, (std::vector<double>{1, 1, 1.25}));
}

TEST(IntrinsicJson, WithoutAGluingFacesMeetWhereTheyShareTwoVertices) {
  const auto surface = read(tetrahedron().text());
  ASSERT_OK(surface);
  EXPECT_EQ(surface->connectivity.edgeCount(), 6);
  EXPECT_EQ(surface->connectivity.eulerCharacteristic(), 2);
}

TEST(IntrinsicJson, KeysMayComeInAnyOrder) {
  const auto surface = read(
      R"({"lengths":[[1,1,1]],"faces":[[2,0,1]],"version":1,"geometry":"spherical","vertices":3,)"
      R"("gluing":[[-1,-1,-1]],"format":"moduli-intrinsic-triangulation"})");
  ASSERT_OK(surface);
  EXPECT_EQ(surface->geometry, Geometry::kSpherical);
  EXPECT_TRUE(surface->connectivity.isBoundaryEdge(0));
}

TEST(IntrinsicJson, WhatIsWrittenReadsBackToTheLastBit) {
  for (const SampleKind& kind : intrinsicSampleKinds()) {
    const auto surface = makeIntrinsicSample(kind.name);
    ASSERT_OK(surface);
    const auto back = read(writeIntrinsicJson(*surface));
    ASSERT_OK(back);
    expectSame(*surface, *back);
  }
  for (const char* kind : {"torus", "annulus", "genus"}) {
    const auto soup = makeSample(kind, {{"resolution", 4}, {"seed", 7}});
    ASSERT_OK(soup);
    const auto mesh = TriangleMesh::fromSoup(*soup);
    ASSERT_OK(mesh);
    const IntrinsicSurface surface = forgetPositions(*mesh);
    const auto back = read(writeIntrinsicJson(surface));
    ASSERT_OK(back);
    expectSame(surface, *back);
  }
}

TEST(IntrinsicJson, ExtremeLengthsKeepEveryBit) {
  Parts parts;
  for (const double length :
       {5e-324, 2.2250738585072014e-308, 0.1, 1.7976931348623157e308, std::nextafter(1.0, 2.0)}) {
    auto surface = read(Parts().text());
    ASSERT_OK(surface);
    surface->lengths.assign(3, length);
    const auto back = read(writeIntrinsicJson(*surface));
    ASSERT_OK(back);
    expectSame(*surface, *back);
  }
}

TEST(IntrinsicJson, OfTwoNearlyEqualStatementsTheLowerHalfedgeCounts) {
  Parts parts;
  parts.lengths = "[[1, 1.0000000000001, 1.25], [1.25, 1, 1]]";
  const auto surface = read(parts.text());
  ASSERT_OK(surface);
  EXPECT_EQ(surface->lengths[1], 1.0000000000001);
  parts.lengths = "[[1, 1.00000000001, 1.25], [1.25, 1, 1]]";
  expectRefused(parts.text(), Reason::kInvalidMetric,
                "halfedge 1 (face 0, corner 1) and halfedge 5 (face 1, corner 2) are one edge, but "
                "have the lengths 1.00000000001 and 1");
}

TEST(IntrinsicJson, TextThatIsNoJsonIsRefusedWithItsByte) {
  expectRefused("", Reason::kEmpty, "byte 0: the file is empty");
  expectRefused("{", Reason::kTruncatedFile, "byte 1: ");
  expectRefused(" \n\t", Reason::kTruncatedFile, "byte 3: ");
  expectRefused("{\"format\": \"moduli", Reason::kTruncatedFile, "missing closing quote");
  expectRefused("{\"version\" 1}", Reason::kSyntaxError, "byte 11: ");
  expectRefused("{\"version\": 01}", Reason::kSyntaxError, "byte 13: ");
  expectRefused("{\"format\": \"\xFF\"}", Reason::kSyntaxError, "ill-formed UTF-8");
  expectRefused(Parts().text() + "{}", Reason::kSyntaxError, "expected end of input");
  expectRefused(Parts().text() + '\0' + "more", Reason::kSyntaxError, ": a zero byte");
  expectRefused("// a comment\n" + Parts().text(), Reason::kSyntaxError, "byte 0: ");
  Parts huge;
  huge.lengths = "[[1e999, 1, 1], [1, 1, 1]]";
  expectRefused(huge.text(), Reason::kSyntaxError, "number overflow");
}

TEST(IntrinsicJson, AFileCutOffAnywhereIsRefused) {
  const std::string text = Parts().text();
  for (std::size_t length = 0; length + 2 < text.size(); ++length) {
    const auto surface = read(text.substr(0, length));
    ASSERT_FALSE(surface.ok()) << length;
    EXPECT_TRUE(surface.status().reason() == Reason::kTruncatedFile ||
                surface.status().reason() == Reason::kSyntaxError ||
                surface.status().reason() == Reason::kEmpty)
        << surface.status().toString();
  }
}

TEST(IntrinsicJson, KeysAreThoseOfTheFormOnceEach) {
  for (const char* key : {"format", "version", "geometry", "vertices", "faces", "lengths"}) {
    std::string text = Parts().text();
    const std::string quoted = "\"" + std::string(key) + "\"";
    text.replace(text.find(quoted), quoted.size(), "\"\"");
    expectRefused(text, Reason::kSyntaxError, "no key ''");
  }
  Parts parts;
  parts.more = ", \"colour\": [1, 2]";
  expectRefused(parts.text(), Reason::kSyntaxError, "has no key 'colour'");
  parts.more = ", \"vertices\": 1";
  expectRefused(parts.text(), Reason::kSyntaxError, "the key 'vertices' comes twice");
  expectRefused(R"({"format":"moduli-intrinsic-triangulation","version":1,"vertices":1})",
                Reason::kSyntaxError, "the key 'geometry' is missing");
  expectRefused("{}", Reason::kSyntaxError, "the key 'format' is missing");
}

TEST(IntrinsicJson, ValuesOfAWrongTypeAreNamed) {
  const auto refused = [](std::string Parts::*part, const char* value, const char* words) {
    Parts parts;
    parts.*part = value;
    expectRefused(parts.text(), Reason::kSyntaxError, words);
  };
  expectRefused("[1]", Reason::kSyntaxError, "the document is a list instead of an object");
  expectRefused("1", Reason::kSyntaxError, "the document is a number instead of an object");
  expectRefused("\"a\"", Reason::kSyntaxError, "the document is a text instead of an object");
  refused(&Parts::format, "1", "format is a number instead of a text");
  refused(&Parts::format, "18446744073709551615", "format is a number instead of a text");
  refused(&Parts::geometry, "{}", "geometry is an object instead of a text");
  refused(&Parts::version, "\"1\"", "version is a text instead of a whole number");
  refused(&Parts::version, "1.5", "version is the number '1.5' instead of a whole number");
  refused(&Parts::vertices, "[1]", "vertices is a list instead of a whole number");
  refused(&Parts::faces, "true", "faces is a truth value instead of a list");
  refused(&Parts::faces, "[0, 0, 0]", "faces[0] is a number instead of a list of three numbers");
  refused(&Parts::faces, "[[0, 0, 0], [0, null, 0]]", "faces[1][1] is null instead of a whole");
  refused(&Parts::faces, "[[0, 0, 0], [0, 0, 0.5]]", "faces[1][2] is the number '0.5' instead");
  refused(&Parts::gluing, "[[[4], 5, 3], [2, 0, 1]]", "gluing[0][0] is a list instead of a whole");
  refused(&Parts::lengths, "[[1, \"1\", 1]]", "lengths[0][1] is a text instead of a number");
}

TEST(IntrinsicJson, CountsMustFit) {
  Parts parts;
  parts.faces = "[[0, 0, 0], [0, 0]]";
  expectRefused(parts.text(), Reason::kSyntaxError, "faces[1] has 2 entries instead of 3");
  parts.faces = "[[0, 0, 0, 0], [0, 0, 0]]";
  expectRefused(parts.text(), Reason::kSyntaxError, "faces[0] has more than 3 entries");
  parts = {};
  parts.lengths = "[[1, 1, 1]]";
  expectRefused(parts.text(), Reason::kSyntaxError, "lengths has 1 rows for 2 faces");
  parts = {};
  parts.gluing = "[]";
  expectRefused(parts.text(), Reason::kSyntaxError, "gluing has 0 rows for 2 faces");
  parts = {};
  parts.faces = parts.gluing = parts.lengths = "[]";
  expectRefused(parts.text(), Reason::kEmpty, "the surface has no faces");
}

TEST(IntrinsicJson, OtherFormatsVersionsAndGeometriesAreRefusedByName) {
  Parts parts;
  parts.format = "\"glTF\"";
  expectRefused(parts.text(), Reason::kUnsupportedContent, "the format is 'glTF'");
  parts = {};
  parts.version = "2";
  expectRefused(parts.text(), Reason::kUnsupportedContent, "version 2 of the format is not known");
  parts = {};
  parts.geometry = "\"minkowski\"";
  expectRefused(parts.text(), Reason::kSyntaxError, "there is no geometry 'minkowski'");
}

TEST(IntrinsicJson, IndicesOutOfRangeAreNamed) {
  Parts parts;
  parts.faces = "[[0, 0, 0], [0, 1, 0]]";
  expectRefused(parts.text(), Reason::kIndexOutOfRange, "corner 1 of face 1 is vertex 1, but");
  parts.faces = "[[0, 0, 0], [0, 0, -1]]";
  expectRefused(parts.text(), Reason::kIndexOutOfRange, "corner 2 of face 1 is vertex -1, but");
  for (const char* huge : {"4294967296", "18446744073709551615", "-99999999999999999999999"}) {
    parts.faces = "[[0, 0, 0], [0, 0, " + std::string(huge) + "]]";
    expectRefused(parts.text(), Reason::kIndexOutOfRange, "faces[1][2] is beyond 32 bits");
  }
  parts = {};
  parts.gluing = "[[4, 5, 6], [2, 0, 1]]";
  expectRefused(parts.text(), Reason::kIndexOutOfRange,
                "halfedge 2 (face 0, corner 2) is glued to halfedge 6 of 6");
  parts = {};
  parts.vertices = "0";
  expectRefused(parts.text(), Reason::kIndexOutOfRange, "the number of vertices is 0");
  parts.vertices = "99999999999";
  expectRefused(parts.text(), Reason::kIndexOutOfRange, "the number of vertices is 99999999999");
  parts.vertices = "2147483647";
  expectRefused(parts.text(), Reason::kCountTooLarge,
                "there are 2147483647 vertices, but the 2 faces have 6 corners");
}

TEST(IntrinsicJson, LengthsThatMakeNoTriangleAreRefusedWithTheirFace) {
  Parts parts;
  parts.lengths = "[[1, 1, 2], [2, 1, 1]]";
  expectRefused(parts.text(), Reason::kInvalidMetric,
                "face 0 has the sides 1, 1 and 2, which make no triangle");
  parts.lengths = "[[0, 1, 1], [1, 0, 1]]";
  expectRefused(parts.text(), Reason::kInvalidMetric,
                "halfedge 0 (face 0, corner 0) has the length 0");
  parts.lengths = "[[1, 1, 1], [-1, 1, 1]]";
  expectRefused(parts.text(), Reason::kInvalidMetric,
                "halfedge 3 (face 1, corner 0) has the length -1");
  parts.lengths = "[[1, 1e-400, 1], [1, 1, 1e-400]]";
  expectRefused(parts.text(), Reason::kInvalidMetric,
                "halfedge 1 (face 0, corner 1) has the length 0");
}

TEST(IntrinsicJson, SphericalTrianglesStayBelowAFullTurn) {
  Parts parts;
  parts.geometry = "\"spherical\"";
  parts.lengths = "[[2, 2, 2], [2, 2, 2]]";
  EXPECT_OK(read(parts.text()));
  parts.lengths = "[[2.1, 2.1, 2.1], [2.1, 2.1, 2.1]]";
  expectRefused(parts.text(), Reason::kInvalidMetric,
                "face 0 has the sides 2.1, 2.1 and 2.1, which go all round the unit sphere");
}

TEST(IntrinsicJson, AGluingIsAnInvolutionThatMatchesEnds) {
  Parts parts;
  parts.gluing = "[[0, 5, 3], [2, 4, 1]]";
  expectRefused(parts.text(), Reason::kInvalidGluing,
                "halfedge 0 (face 0, corner 0) is glued to itself");
  parts.gluing = "[[4, 5, 3], [2, 2, 1]]";
  expectRefused(parts.text(), Reason::kInvalidGluing,
                "halfedge 0 (face 0, corner 0) is glued to halfedge 4 (face 1, corner 1), but that "
                "one to halfedge 2");
  parts.gluing = "[[4, 5, 3], [2, -1, 1]]";
  expectRefused(parts.text(), Reason::kInvalidGluing, "but that one to none");
  Parts solid = tetrahedron();
  solid.gluing = "[[5, 8, 11], [10, 6, 0], [4, 9, 1], [7, 3, 2]]";
  EXPECT_OK(read(solid.text()));
  solid.gluing = "[[8, 5, 11], [10, 6, 1], [4, 9, 0], [7, 3, 2]]";
  expectRefused(
      solid.text(), Reason::kInvalidGluing,
      "halfedge 0 (face 0, corner 0) runs from vertex 0 to vertex 1, but halfedge 8 (face "
      "2, corner 2) to which it is glued from vertex 2 to vertex 1");
}

TEST(IntrinsicJson, FacesThatDisagreeAndOneSidedSurfacesAreToldApart) {
  Parts turned = tetrahedron();
  turned.faces = "[[0, 1, 2], [0, 3, 1], [1, 2, 3], [2, 3, 0]]";
  expectRefused(turned.text(), Reason::kInconsistentOrientation, "in the same direction");
  // Six triangles around a Moebius band.
  Parts band;
  band.vertices = "6";
  band.faces = "[[0,1,2],[2,1,3],[2,3,4],[4,3,5],[4,5,1],[1,5,0]]";
  band.gluing = "";
  band.lengths = "[[1,1,1],[1,1,1],[1,1,1],[1,1,1],[1,1,1],[1,1,1]]";
  expectRefused(band.text(), Reason::kNonOrientable, "the surface is one-sided: it holds face 0");
  // The same two with a gluing.
  Parts pair;
  pair.vertices = "4";
  pair.faces = "[[0, 1, 2], [0, 1, 3]]";
  pair.gluing = "[[3, -1, -1], [0, -1, -1]]";
  expectRefused(pair.text(), Reason::kInconsistentOrientation,
                "halfedge 0 (face 0, corner 0) and halfedge 3 (face 1, corner 0) are glued in the "
                "same direction");
  band.gluing = "[[17,3,-1],[1,-1,6],[5,9,-1],[7,-1,12],[11,15,-1],[13,-1,0]]";
  const auto verdict = read(band.text());
  EXPECT_THAT(verdict, FailsWith(Reason::kNonOrientable));
}

TEST(IntrinsicJson, WhatIsNoManifoldIsRefusedWithItsElement) {
  Parts loop;
  loop.gluing = "";
  expectRefused(loop.text(), Reason::kDegenerateFace, "face 0 repeats a vertex");
  Parts crowded = tetrahedron();
  crowded.vertices = "5";
  crowded.faces = "[[0, 1, 2], [1, 0, 3], [0, 1, 4], [2, 3, 0]]";
  expectRefused(crowded.text(), Reason::kNonManifoldEdge, "edge (0, 1) has 3 faces");
  Parts pinched;
  pinched.vertices = "5";
  pinched.faces = "[[0, 1, 2], [0, 3, 4]]";
  pinched.gluing = "[[-1, -1, -1], [-1, -1, -1]]";
  pinched.lengths = "[[1, 1, 1], [1, 1, 1]]";
  expectRefused(pinched.text(), Reason::kNonManifoldVertex, "vertex 0 pinches the surface");
  pinched.vertices = "6";
  pinched.faces = "[[0, 1, 2], [5, 3, 4]]";
  expectRefused(pinched.text(), Reason::kMultipleComponents,
                "the surface has 2 components: face 1 is not connected with face 0");
  pinched.faces = "[[0, 1, 2], [1, 3, 4]]";
  expectRefused(pinched.text(), Reason::kNonManifoldVertex, "");
  Parts gap = tetrahedron();
  gap.vertices = "5";
  expectRefused(gap.text(), Reason::kNonManifoldVertex, "vertex 4 has no faces");
}

TEST(IntrinsicJson, TooManyFacesAreRefusedWhereverTheyAre) {
  EXPECT_OK(read(Parts().text(), 2));
  const auto surface = read(Parts().text(), 1);
  EXPECT_THAT(surface, FailsWith(Reason::kMeshTooLarge));
  EXPECT_THAT(surface.status().hint(), HasSubstr("--max-faces"));
}

TEST(IntrinsicJson, DeepNestingTakesNoStack) {
  const std::string deep(10'000'000, '[');
  expectRefused(deep, Reason::kSyntaxError, "the document is a list");
  expectRefused("{\"faces\": " + deep, Reason::kSyntaxError, "faces[0][0] is a list");
  std::string objects;
  for (int i = 0; i < 1'000'000; ++i) objects += "{\"a\":";
  expectRefused(objects, Reason::kSyntaxError, "no key 'a'");
}

TEST(IntrinsicJson, LongTextsAreNotRepeatedInMessages) {
  const std::string text = "{\"" + std::string(100'000, 'k') + "\": 1}";
  const auto by_key = read(text);
  ASSERT_THAT(by_key, FailsWith(Reason::kSyntaxError));
  EXPECT_LT(by_key.status().message().size(), 500U);
  const auto by_token = read("{\"format\": \"" + std::string(100'000, 'k') + "\n\"}");
  ASSERT_THAT(by_token, FailsWith(Reason::kSyntaxError));
  EXPECT_LT(by_token.status().message().size(), 500U);
  const auto by_number = read("{\"version\": 1" + std::string(100'000, '0') + "e9999}");
  ASSERT_THAT(by_number, FailsWith(Reason::kSyntaxError));
  EXPECT_LT(by_number.status().message().size(), 500U);
}

TEST(IntrinsicJson, ACancelledReadingStops) {
  CancelToken token;
  Context context;
  context.setCancelToken(token);
  token.cancel();
  EXPECT_THAT(readIntrinsicJson(context, Parts().text()), FailsWith(Reason::kCancelled));
}

TEST(IntrinsicJson, ItIsToldByItsContentAndIsNoMesh) {
  EXPECT_EQ(detectFormat(Parts().text(), "a.off"), MeshFormat::kJson);
  EXPECT_EQ(detectFormat("\xEF\xBB\xBF \n\t{", ""), MeshFormat::kJson);
  EXPECT_EQ(detectFormat("nothing", "a.JSON"), MeshFormat::kJson);
  EXPECT_EQ(formatName(MeshFormat::kJson), "json");
  Context context;
  const auto soup = readMesh(context, Parts().text(), {});
  ASSERT_THAT(soup, FailsWith(Reason::kUnsupportedContent));
  EXPECT_THAT(soup.status().message(), HasSubstr("has no positions in space"));
}

TEST(IntrinsicJson, AnyJsonFileIsToldFromOneOfThisKind) {
  EXPECT_TRUE(looksLikeIntrinsicJson(Parts().text()));
  EXPECT_FALSE(looksLikeIntrinsicJson("{\"labels\": [1, 2]}"));
}

}  // namespace
}  // namespace moduli
