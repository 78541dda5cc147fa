#include "tests/client/cli_test.h"

/// The road through the embedded store: add, list, show, get, search, remove; and the lock.
namespace moduli {
namespace {

using testing::HasSubstr;

class Catalogue : public CliTest {};

// A sample in OFF, with all coordinates times `scale`, written to the last bit.
std::string scaled(const std::string& off, double scale) {
  std::istringstream in(off);
  std::ostringstream out;
  out.precision(17);
  std::string word;
  int vertices = 0, faces = 0, edges = 0;
  in >> word >> vertices >> faces >> edges;
  out << "OFF\n" << vertices << ' ' << faces << " 0\n";
  for (int i = 0; i < 3 * vertices; ++i) {
    double coordinate = 0;
    in >> coordinate;
    out << scale * coordinate << (i % 3 == 2 ? '\n' : ' ');
  }
  for (int i = 0; i < faces; ++i) {
    int n = 0, a = 0, b = 0, c = 0;
    in >> n >> a >> b >> c;
    out << "3 " << a << ' ' << b << ' ' << c << '\n';
  }
  return out.str();
}

TEST_F(Catalogue, AMeshFindsItselfFirstAndItsRescaledCopyAtNoDistance) {
  sample("torus.off", {"torus", "resolution=16", "seed=3"});
  sample("other.off", {"torus", "R=3", "resolution=16"});
  sample("sphere.off", {"ellipsoid", "resolution=6"});
  write("large.off", scaled(read("torus.off"), 1000));
  EXPECT_EQ(
      json({"add", "-c", "demo", "torus.off", "other.off", "sphere.off", "large.off"})["added"]
          .number(),
      4);
  for (const char* space : {"shape", "metric", "conformal"}) {
    SCOPED_TRACE(space);
    const Json hits = json({"search", "-c", "demo", "torus.off", "--space", space})["hits"];
    ASSERT_GE(hits.size(), 3);
    // Rounding of the scaled coordinates, 1e-16 relative, times the conditioning of the operators.
    EXPECT_NEAR(hits.at(0)["distance"].number(), 0, 1e-9);
    EXPECT_NEAR(hits.at(1)["distance"].number(), 0, 1e-9);
    EXPECT_THAT(
        (std::vector<std::string>{hits.at(0)["name"].string(), hits.at(1)["name"].string()}),
        testing::UnorderedElementsAre("torus", "large"));
    EXPECT_GT(hits.at(2)["distance"].number(), 1e-3);
  }
  EXPECT_EQ(json({"search", "-c", "demo", "demo/torus", "-k", "1"})["hits"].size(), 1);
  EXPECT_EQ(json({"search", "-c", "demo", "--id", "torus", "--filter", "genus = 0"})["hits"]
                .at(0)["name"]
                .string(),
            "sphere");
}

TEST_F(Catalogue, GetWritesTheVeryBytesAndOverwritesOnlyByForce) {
  const std::string bytes = "# made by hand\r\n" + [] {
    std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    return obj + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  }();
  write("in/t.obj", bytes);
  ASSERT_THAT(run({"add", "-c", "demo", "in/t.obj"}), Succeeds());
  ASSERT_THAT(run({"get", "-c", "demo", "t"}), Succeeds());
  EXPECT_EQ(read("t.obj"), bytes);
  EXPECT_EQ(run({"get", "-c", "demo", "t", "-o", "-"}).out, bytes);
  write("t.obj", "mine");
  const ProcessResult refused = run({"get", "-c", "demo", "t"});
  EXPECT_THAT(refused, FailsWithOneLine());
  EXPECT_THAT(refused.err, HasSubstr("--force"));
  EXPECT_EQ(read("t.obj"), "mine");
  EXPECT_THAT(run({"get", "-c", "demo", "t", "--force"}), Succeeds());
  EXPECT_EQ(read("t.obj"), bytes);
}

TEST_F(Catalogue, AFileWinsOverAShapeAndAPrefixForcesTheStore) {
  sample("torus.off", {"torus", "resolution=8"});
  ASSERT_THAT(run({"add", "-c", "demo", "torus.off"}), Succeeds());
  EXPECT_EQ(json({"inspect", "demo/torus"})["topology"]["genus"].number(), 1);
  write("demo/torus", icosahedronOff());
  EXPECT_EQ(json({"inspect", "demo/torus"})["topology"]["genus"].number(), 0);
  EXPECT_EQ(json({"inspect", "store:demo/torus"})["topology"]["genus"].number(), 1);
}

TEST_F(Catalogue, WhatIsNotThereIsNamed) {
  EXPECT_THAT(run({"list", "-c", "demo"}), FailsWithOneLine());
  EXPECT_FALSE(exists("xdg")) << "reading made a store";
  write("a.off", icosahedronOff());
  ASSERT_THAT(run({"add", "-c", "demo", "a.off"}), Succeeds());
  EXPECT_THAT(run({"list", "-c", "none"}).err, HasSubstr("COLLECTION_NOT_FOUND"));
  EXPECT_THAT(run({"show", "-c", "demo", "none"}).err, HasSubstr("SHAPE_NOT_FOUND"));
  EXPECT_THAT(run({"search", "-c", "demo", "--id", "none"}).err, HasSubstr("SHAPE_NOT_FOUND"));
  EXPECT_THAT(run({"list", "-c", "demo", "--filter", "genus >"}).err, HasSubstr("INVALID_FILTER"));
  EXPECT_THAT(run({"collection", "create", "demo"}).err, HasSubstr("COLLECTION_EXISTS"));
  EXPECT_THAT(run({"collection", "create", ".."}).err, HasSubstr("INVALID_NAME"));
  EXPECT_THAT(run({"collection", "delete", "demo"}).err, HasSubstr("COLLECTION_NOT_EMPTY"));
}

TEST_F(Catalogue, ComputingNeitherMakesNorLocksAStore) {
  write("a.off", icosahedronOff());
  for (const std::vector<std::string>& words : {std::vector<std::string>{"inspect", "a.off"},
                                                {"signature", "a.off"},
                                                {"distance", "a.off", "a.off"},
                                                {"sample", "sphere", "-o", "s.off"},
                                                {"version"}}) {
    EXPECT_THAT(run(words), Succeeds());
  }
  EXPECT_FALSE(exists("xdg"));
}

TEST_F(Catalogue, AStoreInUseNamesItsHolderAndComputingGoesOnBesideIt) {
  write("a.off", icosahedronOff());
  Daemon daemon(store(), path("."));
  ASSERT_NE(daemon.address(), "");
  const ProcessResult locked = run({"add", "-c", "demo", "a.off"});
  EXPECT_THAT(locked, FailsWithOneLine());
  EXPECT_THAT(locked.err, HasSubstr("STORE_LOCKED"));
  EXPECT_THAT(locked.err, HasSubstr(std::to_string(daemon.process().id())));
  const auto one = start({"signature", "a.off"});
  const auto two = start({"signature", "a.off"});
  EXPECT_THAT(one->wait(), Succeeds());
  EXPECT_THAT(two->wait(), Succeeds());
  daemon.process().signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait().exit_code, 0);
  EXPECT_THAT(run({"add", "-c", "demo", "a.off"}), Succeeds());
}

}  // namespace
}  // namespace moduli
