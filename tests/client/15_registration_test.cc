#include <cmath>
#include <filesystem>
#include <sstream>

#include "core/mesh/gifti.h"
#include "core/mesh/samples.h"
#include "core/mesh/vertex_data.h"
#include "core/mesh/write.h"
#include "tests/client/cli_test.h"
#include "tests/client/obj.h"

/// parameterize --to sphere: GIFTI files, and spheres laid onto other spheres.
namespace moduli {
namespace {

using testing::HasSubstr;

/// An ellipsoid with a lump: no symmetry. 252 vertices, 500 faces.
TriangleSoup lumpy(bool mirror = false) {
  TriangleSoup soup = *makeSample("sphere", {{"resolution", 5}, {"seed", 3}});
  for (Eigen::Vector3d& p : soup.vertices) {
    const double lump = std::exp(4 * (p.dot(Eigen::Vector3d(0.6, 0.48, 0.64)) - 1));
    p = Eigen::Vector3d(p.x(), 1.2 * p.y(), 0.9 * p.z()) * (1 + 0.4 * lump);
    if (mirror) p.x() = -p.x();
  }
  if (mirror) {
    for (Triangle& face : soup.faces) std::swap(face[1], face[2]);
  }
  return soup;
}

std::string heights(const TriangleSoup& soup) {
  std::string text;
  for (const Eigen::Vector3d& p : soup.vertices) text += std::to_string(p.z() + p.y()) + "\n";
  return text;
}

class Registration : public CliTest {
 protected:
  Registration() {
    write("a.off", *writeMesh(lumpy(), MeshFormat::kOff));
    write("b.off", *writeMesh(lumpy(true), MeshFormat::kOff));
    write("a.txt", heights(lumpy()));
    write("b.txt", heights(lumpy(true)));
  }

  ProcessResult sphere(std::vector<std::string> words, const std::string& mesh = "a.off") const {
    words.insert(words.begin(), {"parameterize", mesh, "--to", "sphere"});
    return run(words);
  }

  /// The JSON document of a run that succeeds.
  Json report(std::vector<std::string> words, const std::string& mesh = "a.off") const {
    words.emplace_back("--json");
    const ProcessResult result = sphere(words, mesh);
    EXPECT_THAT(result, Succeeds());
    return Json::parse(result.out.empty() ? "null\n" : result.out);
  }

  GiftiSurface gifti(const std::string& name) const {
    Context context;
    auto surface = readGiftiSurface(context, read(name), {});
    EXPECT_OK(surface);
    return surface.ok() ? *std::move(surface) : GiftiSurface();
  }

  std::string landmarkError(const std::string& lines) const {
    write("marks.txt", lines);
    const ProcessResult result =
        sphere({"--reference", "b.off", "--mirror", "--landmarks", "marks.txt", "-o", "out.obj"});
    EXPECT_THAT(result, FailsWithOneLine());
    EXPECT_FALSE(exists("out.obj"));
    return result.err;
  }
};

TEST_F(Registration, GiftiKeepsItsTagsAndBecomesRound) {
  GiftiWriteOptions options;
  options.doubles = true;
  options.tags.file = {{"UserName", "nobody"}};
  options.tags.points = {{"AnatomicalStructurePrimary", "CortexLeft"},
                         {"GeometricType", "Anatomical"},
                         {"Name", "a & b"}};
  options.tags.triangles = {{"TopologicalType", "Closed"}};
  options.tags.coordinates.resize(1);
  options.tags.coordinates[0].data_space = "NIFTI_XFORM_TALAIRACH";
  options.tags.coordinates[0].matrix[3] = 12.5;
  const auto bytes = writeGiftiSurface(lumpy(), options);
  ASSERT_OK(bytes);
  write("lh.pial.gii", *bytes);
  for (const std::string name : {"out.gii", "out.surf.GII.gz"}) {
    SCOPED_TRACE(name);
    ASSERT_THAT(sphere({"-o", name}, "lh.pial.gii"), Succeeds());
    EXPECT_EQ(read(name).starts_with("\x1f\x8b"), name.ends_with("gz"));
    const GiftiSurface out = gifti(name);
    GiftiTags wanted = options.tags;
    wanted.points[1].value = "Spherical";
    EXPECT_EQ(out.tags, wanted);
    EXPECT_EQ(out.soup.faces, lumpy().faces);
    ASSERT_EQ(out.soup.vertices.size(), lumpy().vertices.size());
    for (const Eigen::Vector3d& p : out.soup.vertices) EXPECT_NEAR(p.norm(), 1, 1e-7);
  }
  // The same points as in OBJ, to float32.
  ASSERT_THAT(sphere({"-o", "out.obj"}, "lh.pial.gii"), Succeeds());
  const Obj obj = Obj::parse(read("out.obj"));
  const GiftiSurface out = gifti("out.gii");
  for (std::size_t v = 0; v < out.soup.vertices.size(); ++v) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(out.soup.vertices[v][i], obj.positions[v][i], 1e-7);
  }
  // Other inputs have no tags but what a sphere is.
  ASSERT_THAT(sphere({"-o", "plain.gii"}), Succeeds());
  EXPECT_EQ(gifti("plain.gii").tags.points,
            (std::vector<GiftiMetaItem>{{"GeometricType", "Spherical"}}));
  // Of the store, too.
  ASSERT_THAT(run({"add", "-c", "brain", "lh.pial.gii"}), Succeeds());
  ASSERT_THAT(sphere({"-o", "stored.gii"}, "brain/lh.pial"), Succeeds());
  EXPECT_EQ(gifti("stored.gii").tags, gifti("out.gii").tags);
}

TEST_F(Registration, AMirroredCopyIsFoundInTheMirror) {
  const Json result = report({"--reference", "b.off", "--mirror", "-o", "out.obj"});
  EXPECT_THAT(
      result["registration"].keys(),
      testing::UnorderedElementsAre("landmarks", "field", "correlation_before", "correlation_after",
                                    "mean_absolute_difference", "reference_is_sphere"));
  EXPECT_EQ(result["registration"]["field"].string(), "AREA_DISTORTION");
  EXPECT_NEAR(result["registration"]["correlation_after"].number(), 1, 1e-9);
  EXPECT_EQ(result["certificate"]["flipped_faces"].number(), 0);
  const Json plain = report({"--reference", "b.off"});
  EXPECT_LT(plain["registration"]["correlation_after"].number(), 0.999);
  const ProcessResult text = sphere({"--reference", "b.off", "--mirror"});
  ASSERT_THAT(text, Succeeds());
  EXPECT_THAT(text.out, HasSubstr("\n  registration  by a rotation\n  area change   correlation "));
}

TEST_F(Registration, AFieldIsCarriedAsTextAndAsGifti) {
  const std::vector<std::string> words = {
      "--reference", "b.off", "--mirror", "--field", "a.txt", "--reference-field", "b.txt"};
  for (const std::string name : {"out.txt", "out.shape.gii", "out.gii.gz"}) {
    SCOPED_TRACE(name);
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--carried", name});
    EXPECT_THAT(sphere(all).out, testing::EndsWith("\n" + name + ": 252 values\n"));
    const Json result = report(all);
    EXPECT_EQ(result["registration"]["field"].string(), "GIVEN");
    EXPECT_NEAR(result["registration"]["correlation_after"].number(), 1, 1e-9);
    Context context;
    const auto carried = readVertexData(context, read(name), name, 252);
    ASSERT_OK(carried);
    const TriangleSoup soup = lumpy();
    // Six decimals in the text, and the slope times what the rotation misses.
    for (std::size_t v = 0; v < 252; ++v) {
      EXPECT_NEAR(carried->values[v], soup.vertices[v].y() + soup.vertices[v].z(), 1e-4);
    }
    EXPECT_EQ(carried->name, name == "out.txt" ? "" : "b.txt");
  }
}

TEST_F(Registration, LandmarksOfAllKindsAreMet) {
  const TriangleSoup a = lumpy(), b = lumpy(true);
  std::ostringstream lines;
  lines << "# vertices\n3 3\n40, 40\n100\t100\n\n";
  // Corners 1 and 2 of the mirrored face are exchanged.
  lines << "200 0.2 0.3 0.5 200 0.2 0.5 0.3\n";
  lines << "curve 4: " << a.faces[0][0] << " " << a.faces[0][1] << " : " << a.faces[0][0] << " "
        << a.faces[0][1] << "\n";
  lines << "curve 3 :" << a.faces[300][0] << "," << a.faces[300][1] << ": " << a.faces[300][0]
        << "," << a.faces[300][1] << " # to the end\r\n";
  write("marks.txt", lines.str());
  const Json result =
      report({"--reference", "b.off", "--mirror", "--landmarks", "marks.txt", "-o", "out.obj"});
  const Json registration = result["registration"];
  ASSERT_EQ(a.faces[300][0], 3);
  EXPECT_EQ(registration["landmarks"].number(), 4 + 4 + 2) << "vertex 3 comes once";
  EXPECT_LT(registration["landmark_distance"].number(), 1e-9);
  EXPECT_LT(registration["mean_beltrami"].number(), 1e-6) << "a copy has nothing to bend";
  EXPECT_LE(registration["mean_beltrami"].number(), registration["max_beltrami"].number());
  EXPECT_FALSE(registration.has("correlation_after"));
  EXPECT_FALSE(registration.has("field"));
  EXPECT_EQ(result["certificate"]["flipped_faces"].number(), 0);
  // With fields they are compared.
  const Json compared = report({"--reference", "b.off", "--mirror", "--landmarks", "marks.txt",
                                "--field", "a.txt", "--reference-field", "b.txt"});
  EXPECT_NEAR(compared["registration"]["correlation_after"].number(), 1, 1e-9);
}

TEST_F(Registration, WhatIsWrongWithLandmarksIsToldByLine) {
  EXPECT_THAT(landmarkError("\n1 2 3\n"),
              HasSubstr("marks.txt:2: has 3 words instead of two vertices, or two faces with "
                        "weights (SYNTAX_ERROR); write 'vertexA vertexB'"));
  EXPECT_THAT(landmarkError("1 x\n"), HasSubstr("marks.txt:1: 'x' is not a vertex's number"));
  EXPECT_THAT(landmarkError("1 -2\n"),
              HasSubstr("marks.txt:1: there is no vertex '-2' (INDEX_OUT_OF_RANGE)"));
  EXPECT_THAT(landmarkError("1 .5 .5 .5 1 .5 .5 0\n"),
              HasSubstr("marks.txt:1: the weights in face 1 sum to 1.5, not to 1"));
  EXPECT_THAT(landmarkError("1 1 1 -1 1 .5 .5 0\n"),
              HasSubstr("marks.txt:1: the weight '-1' lies outside of face 1 (INVALID_OPTION)"));
  EXPECT_THAT(landmarkError("1 1 nan 0 1 .5 .5 0\n"), HasSubstr("'nan' is not a weight"));
  EXPECT_THAT(landmarkError("1 1\ncurve 3 1 2 : 3 4\n"),
              HasSubstr("marks.txt:2: a curve has a count, and two lists behind colons"));
  EXPECT_THAT(landmarkError("curve 1: 1 2 : 3 4\n"), HasSubstr("marks.txt:1: a curve gives two"));
  EXPECT_THAT(landmarkError("curve 2000: 1 2 : 3 4\n"),
              HasSubstr("error: marks.txt:1: a curve of 2000 landmarks"));
  EXPECT_THAT(landmarkError("curve 4: 1 : 3 4\n"), HasSubstr("marks.txt:1: a curve has two"));
  EXPECT_THAT(landmarkError("# nothing\n"), HasSubstr("marks.txt: has no landmarks (EMPTY)"));
  // What only the surfaces tell.
  EXPECT_THAT(landmarkError("1 1\n252 3\n"),
              HasSubstr("error: marks.txt:2: a landmark at vertex 252, but the mesh has vertices 0 "
                        "to 251 (INVALID_OPTION)"));
  EXPECT_THAT(landmarkError("1 1\n3 252\n"),
              HasSubstr("error: marks.txt:2: on the reference: a landmark at vertex 252, but the"));
  EXPECT_THAT(
      landmarkError("1 1 0 0 500 1 0 0\n"),
      HasSubstr("error: marks.txt:1: on the reference: a landmark in face 500, but the mesh "
                "has faces 0 to 499"));
  EXPECT_THAT(landmarkError("1 1\n2 2\n1 3\n"),
              HasSubstr("error: marks.txt:1 and marks.txt:3 coincide on the surface"));
  EXPECT_THAT(landmarkError("curve 3: 0 251 : 0 251\n"),
              HasSubstr("error: marks.txt:1: no edge joins vertices 0 and 251 of the curve"));
}

TEST_F(Registration, FaultsNameTheirFile) {
  sample("torus.off", {"torus", "resolution=5"});
  EXPECT_THAT(sphere({"--reference", "torus.off"}).err, HasSubstr("error: torus.off: the map to"));
  EXPECT_THAT(sphere({"--reference", "none.off"}).err, HasSubstr("error: none.off: no such file"));
  write("short.txt", "1\n2\n");
  EXPECT_THAT(
      sphere({"--reference", "b.off", "--field", "a.txt", "--reference-field", "short.txt"}).err,
      HasSubstr("error: short.txt:1: the file has 2 values, but the surface has 252"));
  EXPECT_THAT(
      sphere({"--reference", "b.off", "--field", "no.txt", "--reference-field", "b.txt"}).err,
      HasSubstr("no.txt: no such file (FILE_NOT_FOUND); check the path given to --field"));
  EXPECT_THAT(sphere({"--reference", "b.off", "--landmarks", "no.txt"}), FailsWithOneLine());
}

TEST_F(Registration, WhatDoesNotGoTogetherIsAUsageError) {
  const auto usage = [&](std::vector<std::string> words, const std::string& to = "sphere") {
    words.insert(words.begin(), {"parameterize", "a.off", "--to", to});
    const ProcessResult result = run(words);
    EXPECT_THAT(result, IsUsageError()) << testing::PrintToString(words);
    return result.err;
  };
  EXPECT_THAT(usage({"--reference", "b.off"}, "disk"), HasSubstr("--reference is for --to sphere"));
  EXPECT_THAT(usage({"--mirror"}, "flat"),
              HasSubstr("--mirror is for --to sphere with --reference"));
  for (const std::string option : {"--landmarks", "--field", "--reference-field", "--carried"}) {
    EXPECT_THAT(usage({option, "a.txt"}), HasSubstr(option + " needs the surface to register to"));
    EXPECT_THAT(usage({option, "a.txt"}, "disk"), HasSubstr(option + " is for --to sphere"));
  }
  EXPECT_THAT(usage({"--reference", "b.off", "--field", "a.txt"}), HasSubstr("--reference-field"));
  EXPECT_THAT(usage({"--reference", "b.off", "--reference-field", "a.txt"}), HasSubstr("--field"));
  EXPECT_THAT(usage({"--reference", "b.off", "--mobius", "1,0,0,1"}), HasSubstr("--mobius"));
  EXPECT_THAT(usage({"--reference", "b.off", "--carried", "out.obj"}), HasSubstr("must end in"));
  EXPECT_THAT(usage({"--reference", "b.off", "--landmarks", "a", "--carried", "out.txt"}),
              HasSubstr("--reference-field"));
  EXPECT_THAT(usage({"--reference", "b.off", "--carried", "c.gii", "-o", "c.gii"}),
              HasSubstr("the same file"));
  EXPECT_THAT(usage({"-o", "out.gii"}, "disk"), HasSubstr(".gii is for --to sphere"));
}

TEST_F(Registration, IsTheSameByAServerAndFromTheStore) {
  const std::vector<std::string> words = {"--mirror", "--field",   "a.txt", "--reference-field",
                                          "b.txt",    "--carried", "c.txt", "-o",
                                          "out.obj"};
  std::vector<std::string> all = words;
  all.insert(all.end(), {"--reference", "b.off"});
  report(all);
  const std::string wanted = read("out.obj"), carried = read("c.txt");
  Daemon daemon(path("served"), path("."));
  ASSERT_NE(daemon.address(), "");
  all.insert(all.end(), {"--server", daemon.address()});
  report(all);
  EXPECT_TRUE(read("out.obj") == wanted);
  EXPECT_EQ(read("c.txt"), carried);
  ASSERT_THAT(run({"add", "-c", "demo", "b.off"}), Succeeds());
  all = words;
  all.insert(all.end(), {"--reference", "demo/b"});
  report(all);
  EXPECT_TRUE(read("out.obj") == wanted);
}

TEST_F(Registration, OfABrainTheHalvesAreMirrorImages) {
  MODULI_NEED_SHARED_MESH(left, "brain/nilearn__pial_left.ply");
  MODULI_NEED_SHARED_MESH(right, "brain/nilearn__pial_right.ply");
  const std::string a = std::filesystem::absolute(left), b = std::filesystem::absolute(right);
  const Json mirror = report({"--reference", b, "--mirror", "-o", "lh.sphere.gii"}, a);
  const Json plain = report({"--reference", b}, a);
  EXPECT_GT(mirror["registration"]["correlation_after"].number(), 0.9);
  EXPECT_GT(mirror["registration"]["correlation_after"].number(),
            plain["registration"]["correlation_after"].number());
  EXPECT_EQ(mirror["certificate"]["flipped_faces"].number(), 0);
  // The sphere that was written is one, and is taken as it is.
  const Json onto = report({"--reference", "lh.sphere.gii"}, a);
  EXPECT_TRUE(onto["registration"]["reference_is_sphere"].boolean());
}

}  // namespace
}  // namespace moduli
