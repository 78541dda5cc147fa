#include <cmath>
#include <set>

#include "tests/client/cli_test.h"

/// Bad input: each file fails by name, place, defect and remedy, and takes no more memory than its
/// size warrants.
namespace moduli {
namespace {

using testing::HasSubstr;

class BadFiles : public CliTest {
 protected:
  // One line that names the file, has `place` and the reason, and says what to do.
  void expectRefused(const std::string& name, const std::string& content, const std::string& place,
                     const std::string& reason) const {
    SCOPED_TRACE(name);
    write(name, content);
    for (const char* command : {"inspect", "signature"}) {
      const ProcessResult result = run({command, name});
      EXPECT_THAT(result, FailsWithOneLine());
      EXPECT_TRUE(result.err.starts_with("moduli: error: " + name + ":")) << result.err;
      EXPECT_THAT(result.err, HasSubstr(name + place));
      EXPECT_THAT(result.err, HasSubstr("(" + reason + "); "));
    }
  }

  // Peak memory of reading the file beyond what the program takes for next to nothing, in bytes.
  double memoryOf(const std::string& name) const {
    write("tiny.off", icosahedronOff());
    const long least = run({"inspect", "tiny.off"}).peak_kib;
    return 1024.0 * static_cast<double>(run({"inspect", name}).peak_kib - least);
  }
};

TEST_F(BadFiles, AreRefusedWithPlaceDefectAndRemedy) {
  const std::string good = icosahedronOff();
  expectRefused("empty.obj", "", ": byte 0", "EMPTY");
  expectRefused("blank.off", "\n\n# nothing\n", ":4", "SYNTAX_ERROR");
  expectRefused("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", ":4", "EMPTY");
  expectRefused("truncated.off", good.substr(0, good.size() / 2), ":", "TRUNCATED_FILE");
  expectRefused("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", ":4", "INDEX_OUT_OF_RANGE");
  expectRefused("words.off", "OFF\n3 1 0\n0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n", ":4", "SYNTAX_ERROR");
  expectRefused("short.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", ":3", "SYNTAX_ERROR");
}

TEST_F(BadFiles, AHugeCountIsRefusedBeforeMemoryIsTaken) {
  expectRefused("huge.off", "OFF\n2000000000 2000000000 0\n0 0 0\n", ":2", "COUNT_TOO_LARGE");
  expectRefused("huge.ply",
                "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n"
                "property double x\nproperty double y\nproperty double z\n"
                "element face 4000000000\nproperty list uchar int vertex_indices\nend_header\nxyz",
                ":", "COUNT_TOO_LARGE");
  // The files have a few hundred bytes; the noise of a run is some megabytes.
  EXPECT_LT(memoryOf("huge.off"), 32e6);
  EXPECT_LT(memoryOf("huge.ply"), 32e6);
}

TEST_F(BadFiles, NanIsADefectThatInspectReportsAndSignatureRefuses) {
  write("nan.off",
        "OFF\n4 4 0\n0 0 0\nnan 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  const ProcessResult inspected = run({"inspect", "--json", "nan.off"});
  ASSERT_THAT(inspected, Succeeds());
  const Json defect = Json::parse(inspected.out)["defects"].at(0);
  EXPECT_EQ(defect["kind"].string(), "NON_FINITE_COORDINATE");
  EXPECT_EQ(defect["elements"].at(0).number(), 1);
  const ProcessResult signed_result = run({"signature", "nan.off"});
  EXPECT_THAT(signed_result, FailsWithOneLine());
  EXPECT_THAT(signed_result.err, HasSubstr("NON_FINITE_COORDINATE"));
}

TEST_F(BadFiles, PolygonsOfAllSizesMayBeMixed) {
  // A cube with four quadrilaterals and two pairs of triangles.
  write("mixed.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
        "f 4 3 2 1\nf 5 6 7\nf 5 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5\nf 4 5 8\n");
  const ProcessResult result = run({"inspect", "--json", "mixed.obj"});
  ASSERT_THAT(result, Succeeds());
  EXPECT_TRUE(Json::parse(result.out)["valid"].boolean());
  EXPECT_EQ(Json::parse(result.out)["topology"]["faces"].number(), 12);
}

TEST_F(BadFiles, ContentCountsForMoreThanAWrongExtension) {
  write("actually_off.obj", icosahedronOff());
  EXPECT_THAT(run({"inspect", "actually_off.obj"}), Succeeds());
  expectRefused("letter.ply", "This is a letter, not a mesh.\n", ": byte 0", "UNKNOWN_FORMAT");
  expectRefused("letter.txt", "This is a letter, not a mesh.\n", ":", "UNKNOWN_FORMAT");
}

TEST_F(BadFiles, RandomBytesAreRefusedWhateverTheyAreCalled) {
  std::string noise(4096, '\0');
  unsigned int state = 12345;
  for (char& c : noise) {
    state = state * 1664525U + 1013904223U;
    c = static_cast<char>(state >> 24);
  }
  for (const char* name : {"noise.obj", "noise.off", "noise.ply", "noise.stl", "noise"}) {
    write(name, noise);
    const ProcessResult result = run({"inspect", name});
    EXPECT_THAT(result, FailsWithOneLine());
    EXPECT_TRUE(result.err.starts_with(std::string("moduli: error: ") + name)) << result.err;
  }
}

TEST_F(BadFiles, AFolderAMissingFileAndAnUnreadableOneAreNamed) {
  write("folder/a.off", icosahedronOff());
  EXPECT_THAT(run({"inspect", "folder"}).err, HasSubstr("folder: is a folder"));
  const ProcessResult missing = run({"inspect", "none.off"});
  EXPECT_THAT(missing, FailsWithOneLine());
  EXPECT_THAT(missing.err, HasSubstr("none.off: no such file (FILE_NOT_FOUND)"));
}

TEST_F(BadFiles, MemoryStaysWithinASmallMultipleOfTheFile) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer keeps freed memory: its figures are not the program's";
#endif
  // 12 MB of vertices and an index out of range in the last line.
  std::string text;
  while (text.size() < 12'000'000) text += "v 0.123456 0.234567 0.345678\n";
  write("late.obj", text + "f 1 2 999999999\n");
  const ProcessResult result = run({"inspect", "late.obj"});
  EXPECT_THAT(result, FailsWithOneLine());
  EXPECT_THAT(result.err, HasSubstr("INDEX_OUT_OF_RANGE"));
  // The bytes, as many of vertices (growing by doubling), and pieces on their way.
  EXPECT_LT(memoryOf("late.obj"), 8 * 12e6);
}

TEST_F(BadFiles, SeveralComponentsAreNamedUnlessOneIsChosen) {
  const std::string one = icosahedronOff();
  std::string vertices, faces;
  for (const int offset : {0, 12}) {
    std::istringstream in(one);
    std::string line;
    std::getline(in, line);
    std::getline(in, line);
    for (int i = 0; i < 12; ++i) {
      double x = 0, y = 0, z = 0;
      in >> x >> y >> z;
      vertices +=
          std::to_string(x + 5 * offset) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    }
    for (int i = 0; i < 20; ++i) {
      int n = 0, a = 0, b = 0, c = 0;
      in >> n >> a >> b >> c;
      faces += "3 " + std::to_string(a + offset) + " " + std::to_string(b + offset) + " " +
               std::to_string(c + offset) + "\n";
    }
  }
  write("two.off", "OFF\n24 40 0\n" + vertices + faces);
  const ProcessResult result = run({"signature", "two.off"});
  EXPECT_THAT(result, FailsWithOneLine());
  EXPECT_THAT(result.err, HasSubstr("MULTIPLE_COMPONENTS"));
  EXPECT_THAT(result.err, HasSubstr("--component"));
  EXPECT_EQ(run({"signature", "two.off", "--component", "largest"}).exit_code, 0);
  EXPECT_EQ(run({"signature", "two.off", "--component", "1"}).exit_code, 0);
  EXPECT_THAT(run({"signature", "two.off", "--component", "2"}), FailsWithOneLine());
}

// What the collection of broken files must be found to be.
struct Verdict {
  const char* file;
  const char* error;  // Reason of an unreadable file, or "".
  bool valid;
  int genus;              // -1: has none.
  int loops, components;  // -1: depends on how edges with three faces are split; not judged.
  std::set<std::string> defects;
};

TEST_F(BadFiles, EveryKnownBadFileGetsItsVerdict) {
  const std::vector<Verdict> verdicts = {
      {"alec__beetle.obj", "", false, -1, -1, -1, {"NON_MANIFOLD_EDGE"}},
      {"alec__cow.obj", "", false, 0, 0, 1, {"NON_MANIFOLD_VERTEX"}},
      {"alec__suzanne.obj", "", false, -1, -1, -1, {"NON_MANIFOLD_EDGE", "DUPLICATE_FACE"}},
      {"alec__teapot.obj", "", false, 0, 25, -1, {"NON_MANIFOLD_VERTEX"}},
      {"bff__inverted_triangles.obj", "", false, 0, 6, 1, {"INCONSISTENT_ORIENTATION"}},
      {"bff__triple_vierbein.obj", "", false, -1, -1, -1, {"NON_MANIFOLD_EDGE"}},
      {"cfwen__eight.open.off", "", true, 0, 4, 1, {}},
      {"geomcentral__fan3.obj", "", false, -1, -1, -1, {"NON_MANIFOLD_EDGE"}},
      {"geomcentral__hourglass_ico.obj", "", false, 0, 0, 2, {"NON_MANIFOLD_VERTEX"}},
      {"geomcentral__moebius.obj", "", false, -1, 1, 1, {"NON_ORIENTABLE"}},
      {"geomcentral__platonic_shelf.obj", "", true, 0, 0, 5, {}},
      {"geomcentral__stl_box_ascii.stl", "", true, 0, 0, 1, {}},
      {"geomcentral__stl_box_binary.stl", "", true, 0, 0, 1, {}},
      {"gpeyre__hole_sphere3.off", "SYNTAX_ERROR", false, 0, 0, 0, {}},
      {"gpeyre__hypersheet.off", "", true, 1, 3, 1, {}},
      {"libigl-data__truck.obj", "", false, -1, -1, -1, {"NON_MANIFOLD_EDGE"}},
      {"trimesh__capsule.obj", "", true, 0, 1, 1, {}},
      {"trimesh__comments.off", "", true, 0, 0, 1, {}},
      {"trimesh__empty.obj", "EMPTY", false, 0, 0, 0, {}},
      {"trimesh__joined_tetrahedra.obj",
       "",
       false,
       -1,
       -1,
       -1,
       {"NON_MANIFOLD_EDGE", "DUPLICATE_FACE"}},
      {"trimesh__nancolor.obj", "", true, 0, 0, 1, {}},
      {"trimesh__negative_indices.obj", "", true, 0, 0, 1, {}},
      {"trimesh__soup.stl", "", true, 0, 100, 100, {}}};
  MODULI_NEED_SHARED_MESH(first, "bad/alec__beetle.obj");
  ASSERT_EQ(sharedMeshes("bad").size(), verdicts.size()) << "a file has no verdict: " << first;
  for (const Verdict& verdict : verdicts) {
    SCOPED_TRACE(verdict.file);
    const std::string file = sharedMesh(std::string("bad/") + verdict.file).value();
    const ProcessResult result = run({"inspect", "--json", file});
    if (*verdict.error != '\0') {
      EXPECT_THAT(result, FailsWithOneLine());
      EXPECT_THAT(result.err, HasSubstr(verdict.error));
      continue;
    }
    ASSERT_THAT(result, Succeeds());
    const Json json = Json::parse(result.out);
    EXPECT_EQ(json["valid"].boolean(), verdict.valid);
    EXPECT_EQ(json["topology"].has("genus"), verdict.genus >= 0);
    if (verdict.genus >= 0) {
      EXPECT_EQ(json["topology"]["genus"].number(), verdict.genus);
    }
    if (verdict.loops >= 0) {
      EXPECT_EQ(json["topology"]["boundary_loops"].number(), verdict.loops);
    }
    if (verdict.components >= 0) {
      EXPECT_EQ(json["topology"]["components"].number(), verdict.components);
    }
    std::set<std::string> blocking;
    for (int i = 0; i < json["defects"].size(); ++i) {
      const Json defect = json["defects"].at(i);
      if (defect["severity"].string() == "BLOCKING") blocking.insert(defect["kind"].string());
    }
    EXPECT_THAT(blocking, testing::IsSupersetOf(verdict.defects));
    EXPECT_EQ(blocking.empty(), verdict.valid);
  }
}

}  // namespace
}  // namespace moduli
