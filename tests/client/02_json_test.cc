#include "tests/client/cli_test.h"

/// --json: one document, the keys that programs read, and what does not apply is absent.
namespace moduli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

class JsonOutput : public CliTest {
 protected:
  Json json(std::vector<std::string> words, int exit_code = 0) const {
    words.push_back("--json");
    const ProcessResult result = run(words);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(result.err.empty(), exit_code == 0);
    return Json::parse(result.out);
  }
};

TEST_F(JsonOutput, InspectionOfAValidMesh) {
  write("a.off", icosahedronOff());
  const Json json = this->json({"inspect", "a.off"});
  EXPECT_THAT(json.keys(), UnorderedElementsAre("valid", "topology", "defects", "repair"));
  EXPECT_TRUE(json["valid"].boolean());
  const Json topology = json["topology"];
  EXPECT_EQ(topology["vertices"].number(), 12);
  EXPECT_EQ(topology["faces"].number(), 20);
  EXPECT_EQ(topology["components"].number(), 1);
  EXPECT_EQ(topology["genus"].number(), 0);
  EXPECT_EQ(topology["boundary_loops"].number(), 0);
  EXPECT_EQ(topology["euler_characteristic"].number(), 2);
  EXPECT_TRUE(topology["orientable"].boolean());
  EXPECT_TRUE(topology["area"].isNumber());
  EXPECT_TRUE(json["defects"].isList());
  EXPECT_EQ(json["defects"].size(), 0);
  EXPECT_TRUE(json["repair"].isList());
}

TEST_F(JsonOutput, InspectionNamesDefectsAndLeavesOutAGenusThatIsNone) {
  write("fan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n");
  const Json json = this->json({"inspect", "fan.obj"});
  EXPECT_FALSE(json["valid"].boolean());
  EXPECT_FALSE(json["topology"].has("genus"));
  const Json defect = json["defects"].at(0);
  EXPECT_THAT(defect.keys(),
              UnorderedElementsAre("kind", "severity", "count", "elements", "message"));
  EXPECT_EQ(defect["kind"].string(), "NON_MANIFOLD_EDGE");
  EXPECT_EQ(defect["severity"].string(), "BLOCKING");
  EXPECT_EQ(defect["count"].number(), 1);
  EXPECT_TRUE(defect["elements"].isList());
}

TEST_F(JsonOutput, SignatureOfATorus) {
  sample("t.off", {"torus", "resolution=16"});
  const Json json = this->json({"signature", "t.off"});
  EXPECT_THAT(json.keys(),
              UnorderedElementsAre("topology", "conformal", "metric", "shape", "vectors",
                                   "descriptor_version", "certificate", "timing"));
  EXPECT_EQ(json["conformal"]["type"].string(), "TORUS");
  EXPECT_TRUE(json["conformal"]["tau"]["re"].isNumber());
  // R = 2 r: tau = i sqrt(R^2 - r^2) / r = i sqrt 3, to the second order in the mesh's size.
  EXPECT_NEAR(json["conformal"]["tau"]["im"].number(), std::sqrt(3.0), 0.05);
  EXPECT_TRUE(json["vectors"]["shape"].isList());
  EXPECT_TRUE(json["descriptor_version"].isNumber());
  EXPECT_TRUE(json["certificate"]["warnings"].isList());
  EXPECT_GT(json["timing"].keys().size(), 1U);
}

TEST_F(JsonOutput, SignatureOfAPretzelHasItsPeriods) {
  sample("p.off", {"genus", "genus=2", "resolution=2"});
  const Json json = this->json({"signature", "p.off"});
  EXPECT_THAT(json.keys(),
              UnorderedElementsAre("topology", "conformal", "metric", "shape", "vectors",
                                   "descriptor_version", "certificate", "timing"));
  EXPECT_EQ(json["metric"]["laplace_spectrum"].size(), 50);
  const Json block = json["conformal"];
  EXPECT_THAT(block.keys(),
              UnorderedElementsAre("type", "period_matrix", "period_error", "energy_spectrum",
                                   "energy_spectrum_error", "circles", "length_spectrum",
                                   "generators", "fenchel_nielsen", "boundary_lengths"));
  EXPECT_EQ(block["boundary_lengths"].size(), 0);
  EXPECT_EQ(block["circles"].size(), 0);
  EXPECT_EQ(block["type"].string(), "HYPERBOLIC");
  EXPECT_EQ(block["period_matrix"]["size"].number(), 2);
  ASSERT_EQ(block["period_matrix"]["entries"].size(), 4);
  EXPECT_GT(block["period_matrix"]["entries"].at(0)["im"].number(), 0);
  EXPECT_EQ(block["period_matrix"]["entries"].at(1)["re"].number(),
            block["period_matrix"]["entries"].at(2)["re"].number());
  ASSERT_EQ(block["energy_spectrum"].size(), 32);
  EXPECT_LE(block["energy_spectrum"].at(0).number(), block["energy_spectrum"].at(31).number());
  EXPECT_TRUE(json["certificate"]["riemann_bilinear_residual"].isNumber());
  EXPECT_LT(json["certificate"]["period_symmetry_residual"].number(), 1e-12);
  EXPECT_EQ(json["certificate"]["mollification"].number(), 0);
}

TEST_F(JsonOutput, SignatureOfAPretzelCertifiesItsHyperbolicMetric) {
  sample("p.off", {"genus", "genus=2", "resolution=4"});
  for (const char* start : {"on", "off"}) {
    const Json json = this->json({"signature", "p.off", "--initial-delaunay", start});
    const Json certificate = json["certificate"];
    EXPECT_LE(certificate["curvature_residual"].number(), 1e-10);
    EXPECT_LE(certificate["gauss_bonnet_residual"].number(), 1e-9);
    EXPECT_LE(certificate["newton_iterations"].number(), 30);
    EXPECT_GE(certificate["flips"].number(), 0);
    EXPECT_GT(certificate["smallest_angle"].number(), 0);
  }
  sample("t.off", {"torus", "resolution=16"});
  EXPECT_FALSE(json({"signature", "t.off"})["certificate"].has("curvature_residual"));
}

TEST_F(JsonOutput, SignatureOfARingHasItsModulus) {
  sample("r.off", {"annulus", "resolution=8"});
  const Json block = this->json({"signature", "r.off"})["conformal"];
  EXPECT_EQ(block["type"].string(), "ANNULUS");
  EXPECT_NEAR(block["modulus"].number(), std::log(2) / (2 * std::acos(-1.0)), 1e-3);
  EXPECT_GT(block["modulus_error"].number(), 0);
  EXPECT_FALSE(block.has("period_matrix"));
  EXPECT_FALSE(block.has("tau"));
}

TEST_F(JsonOutput, SignatureOfAPlateHasItsCircles) {
  sample("p.off", {"plate", "holes=2", "resolution=2"});
  const Json circles = this->json({"signature", "p.off"})["conformal"]["circles"];
  ASSERT_EQ(circles.size(), 3);
  for (int k = 0; k < 3; ++k) {
    EXPECT_THAT(circles.at(k).keys(), UnorderedElementsAre("center", "radius"));
    EXPECT_THAT(circles.at(k)["center"].keys(), UnorderedElementsAre("re", "im"));
  }
  EXPECT_EQ(circles.at(0)["radius"].number(), 1);
  EXPECT_EQ(circles.at(1)["center"]["re"].number(), 0);
  EXPECT_GT(circles.at(2)["center"]["re"].number(), 0);
  EXPECT_EQ(circles.at(2)["center"]["im"].number(), 0);
  EXPECT_GT(circles.at(1)["radius"].number(), circles.at(2)["radius"].number());
  EXPECT_THAT(run({"signature", "p.off"}).out, HasSubstr("circles       radius 1 around 0 + 0 i"));
}

TEST_F(JsonOutput, SignatureOfOneSpaceHasNoOther) {
  write("a.off", icosahedronOff());
  const Json conformal = json({"signature", "a.off", "--space", "conformal"});
  EXPECT_TRUE(conformal.has("conformal"));
  EXPECT_FALSE(conformal["conformal"].has("tau"));
  EXPECT_FALSE(conformal.has("metric"));
  EXPECT_FALSE(conformal.has("shape"));
}

TEST_F(JsonOutput, DistanceLeavesOutASpaceWithoutOne) {
  write("a.off", icosahedronOff());
  sample("t.off", {"torus", "resolution=8"});
  EXPECT_THAT(json({"distance", "a.off", "a.off"}).keys(),
              UnorderedElementsAre("conformal", "metric", "shape"));
  EXPECT_EQ(json({"distance", "a.off", "a.off"})["shape"].number(), 0);
  EXPECT_THAT(json({"distance", "a.off", "t.off"}).keys(), UnorderedElementsAre("metric", "shape"));
}

TEST_F(JsonOutput, CollectionsAndShapes) {
  write("cups/a.off", icosahedronOff());
  write("cups/b.off", icosahedronOff(2));
  EXPECT_EQ(json({"collection", "list"})["collections"].size(), 0);
  EXPECT_EQ(json({"collection", "create", "demo"})["name"].string(), "collections/demo");

  const Json added = json({"add", "-c", "demo", "cups", "--label-from", "dir", "--tag", "year=2020",
                           "--tag", "maker=me"});
  EXPECT_EQ(added["added"].number(), 2);
  EXPECT_EQ(added["skipped"].number(), 0);
  EXPECT_EQ(added["failed"].number(), 0);
  ASSERT_EQ(added["results"].size(), 2);
  EXPECT_THAT(added["results"].at(0).keys(),
              testing::IsSupersetOf({"file", "name", "outcome", "reason", "message"}));
  EXPECT_EQ(added["results"].at(0)["file"].string(), "cups/a.off");
  EXPECT_EQ(added["results"].at(0)["outcome"].string(), "ADDED");

  EXPECT_EQ(json({"collection", "show", "demo"})["shape_count"].number(), 2);
  EXPECT_EQ(json({"collection", "list"})["collections"].size(), 1);
  const Json listed = json({"list", "-c", "demo", "--filter", "tags.year = \"2020\""});
  ASSERT_EQ(listed["shapes"].size(), 2);
  EXPECT_EQ(listed["shapes"].at(0)["name"].string(), "collections/demo/shapes/a");
  EXPECT_EQ(json({"list", "-c", "demo", "--filter", "genus = 1"})["shapes"].size(), 0);

  const Json shape = json({"show", "-c", "demo", "b"});
  EXPECT_EQ(shape["label"].string(), "cups");
  EXPECT_EQ(shape["tags"]["maker"].string(), "me");
  EXPECT_EQ(shape["file_name"].string(), "b.off");
  EXPECT_EQ(shape["digest"].string().size(), 64U);
  EXPECT_EQ(shape["signature"]["conformal"]["type"].string(), "SPHERE");

  const Json found = json({"search", "-c", "demo", "--id", "a", "-k", "1"});
  EXPECT_THAT(found.keys(), UnorderedElementsAre("hits", "exact"));
  ASSERT_EQ(found["hits"].size(), 1);
  EXPECT_THAT(found["hits"].at(0).keys(),
              UnorderedElementsAre("name", "label", "distance", "parts"));
  EXPECT_EQ(found["hits"].at(0)["name"].string(), "a");

  EXPECT_EQ(json({"get", "-c", "demo", "a", "-o", "back.off"})["file"].string(), "back.off");
  EXPECT_EQ(read("back.off"), read("cups/a.off"));
  const Json removed = json({"remove", "-c", "demo", "a", "none"}, 1);
  EXPECT_EQ(removed["removed"].number(), 1);
  EXPECT_EQ(removed["failed"].number(), 1);
  EXPECT_EQ(json({"collection", "delete", "demo", "--force"})["deleted_shapes"].number(), 1);
}

TEST_F(JsonOutput, VersionAndSample) {
  const Json version = json({"version"});
  EXPECT_FALSE(version["version"].string().empty());
  EXPECT_GE(version["descriptor_version"].number(), 1);
  EXPECT_TRUE(version["libraries"].has("grpc"));
  EXPECT_FALSE(version.has("server"));
  const Json sample = json({"sample", "torus", "-o", "t.off"});
  EXPECT_EQ(sample["file"].string(), "t.off");
  EXPECT_GT(sample["faces"].number(), 0);
  EXPECT_GT(json({"sample", "--list"})["kinds"].size(), 5);
}

TEST_F(JsonOutput, AFailureLeavesStandardOutputEmpty) {
  write("fan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n");
  EXPECT_THAT(run({"--json", "signature", "fan.obj"}), FailsWithOneLine());
  EXPECT_THAT(run({"--json", "list", "-c", "none"}), FailsWithOneLine());
  EXPECT_THAT(run({"--json", "frobnicate"}), IsUsageError());
}

TEST_F(JsonOutput, ABulkRunThatFailsStillPrintsItsSummary) {
  write("a.off", icosahedronOff());
  const Json summary = json({"add", "-c", "demo", "a.off", "none.off"}, 1);
  EXPECT_EQ(summary["added"].number(), 1);
  EXPECT_EQ(summary["failed"].number(), 1);
  EXPECT_EQ(summary["results"].at(1)["reason"].string(), "FILE_NOT_FOUND");
}

}  // namespace
}  // namespace moduli
