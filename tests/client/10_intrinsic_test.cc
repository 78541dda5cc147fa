#include <cmath>

#include "tests/client/cli_test.h"

/// Intrinsic triangulations: JSON files of surfaces without positions, through every command.
namespace moduli {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAre;

/// The square torus from two triangles on one vertex.
const std::string kSquareTorus =
    R"({"format": "moduli-intrinsic-triangulation", "version": 1, "geometry": "euclidean",
 "vertices": 1, "faces": [[0, 0, 0], [0, 0, 0]], "gluing": [[4, 5, 3], [2, 0, 1]],
 "lengths": [[1, 1, 1.4142135623730951], [1.4142135623730951, 1, 1]]}
)";

class Intrinsic : public CliTest {};

TEST_F(Intrinsic, SamplesAreValidSurfacesOfTheirGenus) {
  for (const auto& [kind, genus] : {std::pair{"bolza", 2}, std::pair{"klein", 3}}) {
    const std::string file = std::string(kind) + ".json";
    sample(file, {kind});
    const Json inspected = json({"inspect", file});
    EXPECT_TRUE(inspected["valid"].boolean());
    EXPECT_EQ(inspected["topology"]["genus"].number(), genus);
    EXPECT_TRUE(inspected["topology"]["orientable"].boolean());
    // Hyperbolic: 4 pi (genus - 1), by Gauss and Bonnet.
    EXPECT_NEAR(inspected["topology"]["area"].number(), 4 * std::acos(-1.0) * (genus - 1), 1e-12);
    EXPECT_EQ(inspected["defects"].size(), 0);
    EXPECT_EQ(inspected["repair"].size(), 0);
  }
}

TEST_F(Intrinsic, SignatureOfKleinsQuarticHasItsEnergiesAndNoOtherSpace) {
  sample("klein.json", {"klein"});
  const Json signature = json({"signature", "klein.json"});
  EXPECT_THAT(signature.keys(),
              UnorderedElementsAre("topology", "conformal", "vectors", "descriptor_version",
                                   "certificate", "timing"));
  const Json block = signature["conformal"];
  EXPECT_EQ(block["type"].string(), "HYPERBOLIC");
  EXPECT_EQ(block["period_matrix"]["size"].number(), 3);
  for (int i = 0; i < 21; ++i) {
    EXPECT_NEAR(block["energy_spectrum"].at(i).number(), 4 / std::sqrt(7.0), 1e-12);
  }
  EXPECT_NEAR(block["energy_spectrum"].at(21).number(), 6 / std::sqrt(7.0), 1e-12);
  std::string warnings;
  for (int i = 0; i < signature["certificate"]["warnings"].size(); ++i) {
    warnings += signature["certificate"]["warnings"].at(i).string() + "\n";
  }
  EXPECT_THAT(warnings, HasSubstr("SPACES_OMITTED: "));
  EXPECT_THAT(warnings, HasSubstr("CHORDAL_METRIC: "));
}

TEST_F(Intrinsic, AFlatTorusOfTwoTrianglesHasItsLattice) {
  write("square.json", kSquareTorus);
  const Json block = json({"signature", "square.json", "--space", "conformal"})["conformal"];
  EXPECT_EQ(block["type"].string(), "TORUS");
  EXPECT_NEAR(block["tau"]["re"].number(), 0, 1e-14);
  EXPECT_NEAR(block["tau"]["im"].number(), 1, 1e-14);
}

TEST_F(Intrinsic, AMeshWrittenWithoutPositionsIsConformallyTheMesh) {
  sample("t.off", {"torus", "resolution=8", "seed=3"});
  sample("t.json", {"torus", "resolution=8", "seed=3"});
  const Json distance = json({"distance", "t.off", "t.json"});
  EXPECT_THAT(distance.keys(), UnorderedElementsAre("conformal"));
  EXPECT_EQ(distance["conformal"].number(), 0);
}

TEST_F(Intrinsic, AskingForASpaceThatNeedsPositionsIsAnError) {
  sample("bolza.json", {"bolza"});
  for (const char* space : {"metric", "shape"}) {
    const ProcessResult result = run({"signature", "bolza.json", "--space", space});
    EXPECT_THAT(result, FailsWithOneLine());
    EXPECT_THAT(result.err, HasSubstr("(UNSUPPORTED_CONTENT); "));
  }
}

TEST_F(Intrinsic, OptionsThatOnlyAMeshCanUndergoAreRefusedByName) {
  sample("bolza.json", {"bolza"});
  for (const char* option : {"--repair", "--fill-holes"}) {
    const ProcessResult result = run({"signature", "bolza.json", option});
    EXPECT_THAT(result, FailsWithOneLine());
    EXPECT_THAT(result.err, HasSubstr(std::string(option) + " needs positions"));
    EXPECT_THAT(result.err, HasSubstr("(INVALID_OPTION); "));
  }
  EXPECT_THAT(run({"signature", "bolza.json", "--component", "largest"}), Succeeds());
  EXPECT_THAT(run({"signature", "bolza.json", "--component", "1"}).err,
              HasSubstr("(COMPONENT_NOT_FOUND); "));
}

TEST_F(Intrinsic, AParameterizationStandsInThePlaceOfPositions) {
  write("square.json", kSquareTorus);
  const Json map = json({"parameterize", "square.json", "--to", "flat", "-o", "out.obj"});
  EXPECT_EQ(map["certificate"]["flipped_faces"].number(), 0);
  EXPECT_NEAR(map["certificate"]["max_dilatation"].number(), 1, 1e-14);
  // The two triangles, unfolded: a square.
  const Json unfolded = json({"inspect", "out.obj"});
  EXPECT_EQ(unfolded["topology"]["vertices"].number(), 4);
  EXPECT_NEAR(unfolded["topology"]["area"].number(), 1, 1e-14);
  const ProcessResult repaired =
      run({"parameterize", "square.json", "--to", "flat", "--repair", "-o", "again.obj"});
  EXPECT_THAT(repaired, FailsWithOneLine());
  EXPECT_THAT(repaired.err, HasSubstr("(INVALID_OPTION); "));
  EXPECT_FALSE(exists("again.obj"));
}

TEST_F(Intrinsic, ContentAndOptionTellTheFormat) {
  sample("bolza.json", {"bolza"});
  write("bolza.off", read("bolza.json"));
  EXPECT_THAT(run({"inspect", "bolza.off"}), Succeeds());
  EXPECT_THAT(run({"inspect", "bolza.off", "--format", "json"}), Succeeds());
  EXPECT_THAT(run({"inspect", "bolza.json", "--format", "off"}), FailsWithOneLine());
  write("mesh.json", icosahedronOff());
  EXPECT_THAT(run({"inspect", "mesh.json"}), Succeeds());
  Process::Options input;
  input.input = read("bolza.json");
  EXPECT_THAT(run({"inspect", "-"}, input), Succeeds());
}

TEST_F(Intrinsic, DefectsAreErrorsWithPlaceAndRemedy) {
  const auto refused = [this](const std::string& from, const std::string& to,
                              const std::string& reason) {
    std::string text = kSquareTorus;
    text.replace(text.find(from), from.size(), to);
    write("bad.json", text);
    for (const char* command : {"inspect", "signature"}) {
      const ProcessResult result = run({command, "bad.json"});
      EXPECT_THAT(result, FailsWithOneLine());
      EXPECT_TRUE(result.err.starts_with("moduli: error: bad.json: ")) << result.err;
      EXPECT_THAT(result.err, HasSubstr("(" + reason + "); "));
    }
  };
  refused("\"version\": 1,", "\"version\": 1", "SYNTAX_ERROR");
  refused("\"version\": 1", "\"version\": 9", "UNSUPPORTED_CONTENT");
  refused("\"vertices\"", "\"corners\"", "SYNTAX_ERROR");
  refused("\"vertices\": 1", "\"vertices\": 2", "NON_MANIFOLD_VERTEX");
  refused("[0, 0, 0]", "[0, 0, 7]", "INDEX_OUT_OF_RANGE");
  refused("[4, 5, 3]", "[4, 5, 99]", "INDEX_OUT_OF_RANGE");
  refused("[4, 5, 3]", "[4, 3, 3]", "INVALID_GLUING");
  refused("[4, 5, 3], [2, 0, 1]", "[-1, -1, -1], [-1, -1, -1]", "NON_MANIFOLD_VERTEX");
  refused("[[1, 1,", "[[2, 1,", "INVALID_METRIC");
  refused("]]}", "]]", "TRUNCATED_FILE");
  write("deep.json", std::string(1 << 20, '['));
  EXPECT_THAT(run({"inspect", "deep.json"}), FailsWithOneLine());
}

TEST_F(Intrinsic, CollectionsKeepAndFindThem) {
  sample("in/klein.json", {"klein"});
  sample("in/bolza.json", {"bolza"});
  sample("in/pretzel.off", {"genus", "genus=2", "resolution=2"});
  write("in/labels.json", "{\"bolza\": \"genus 2\"}\n");  // Of another kind: not taken.
  const Json added = json({"add", "-c", "c", "in"});
  EXPECT_EQ(added["added"].number(), 3);
  EXPECT_EQ(added["failed"].number(), 0);
  EXPECT_EQ(json({"add", "-c", "c", "in"})["skipped"].number(), 3);
  const Json hits =
      json({"search", "-c", "c", "in/bolza.json", "--space", "conformal", "--picture", "hits.png"});
  ASSERT_EQ(hits["hits"].size(), 2);
  EXPECT_EQ(hits["hits"].at(0)["name"].string(), "bolza");
  EXPECT_EQ(hits["hits"].at(0)["distance"].number(), 0);
  EXPECT_EQ(hits["hits"].at(1)["name"].string(), "pretzel");
  EXPECT_TRUE(read("hits.png").starts_with("\x89PNG"));
  EXPECT_EQ(json({"show", "-c", "c", "klein"})["format"].string(), "JSON");
  EXPECT_THAT(run({"get", "-c", "c", "klein", "-o", "back.json"}), Succeeds());
  EXPECT_EQ(read("back.json"), read("in/klein.json"));
  EXPECT_EQ(json({"inspect", "c/klein"})["topology"]["genus"].number(), 3);
}

TEST_F(Intrinsic, ANamedFileOfAnotherKindFailsAndDoesNotStopTheRest) {
  sample("bolza.json", {"bolza"});
  write("labels.json", "{\"bolza\": \"genus 2\"}\n");
  const ProcessResult result = run({"add", "-c", "c", "labels.json", "bolza.json", "--json"});
  EXPECT_EQ(result.exit_code, 1);
  const Json summary = Json::parse(result.out);
  EXPECT_EQ(summary["added"].number(), 1);
  EXPECT_EQ(summary["results"].at(0)["reason"].string(), "SYNTAX_ERROR");
}

TEST_F(Intrinsic, SamplesWithoutPositionsGoIntoJsonOnly) {
  EXPECT_THAT(run({"sample", "klein", "-o", "klein.off"}), IsUsageError());
  EXPECT_THAT(run({"sample", "klein", "a=1", "-o", "klein.json"}), IsUsageError());
  EXPECT_THAT(run({"sample", "torus", "--binary", "-o", "t.json"}), IsUsageError());
  EXPECT_TRUE(run({"sample", "klein", "-o", "-", "--format", "json"}).out.starts_with("{\n"));
}

}  // namespace
}  // namespace moduli
