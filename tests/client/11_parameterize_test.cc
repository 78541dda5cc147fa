#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "tests/client/cli_test.h"
#include "tests/client/obj.h"

/// parameterize: the map that it writes, judged by the file alone, and what it refuses.
namespace moduli {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAre;

constexpr double kPi = std::numbers::pi;

class Parameterize : public CliTest {
 protected:
  ProcessResult flat(const std::string& mesh, std::vector<std::string> words = {}) const {
    words.insert(words.begin(), {"parameterize", mesh, "--to", "flat"});
    return run(words);
  }

  /// Maps a mesh to out.obj and returns it; `report_` is the JSON document.
  Obj map(const std::string& mesh, std::vector<std::string> words = {}) {
    words.insert(words.end(), {"-o", "out.obj", "--json"});
    const ProcessResult result = flat(mesh, words);
    EXPECT_THAT(result, Succeeds());
    report_ = Json::parse(result.out.empty() ? "null\n" : result.out);
    return Obj::parse(read("out.obj"));
  }

  double certificate(const std::string& key) const {
    return (*report_)["certificate"][key].number();
  }

  void expectGoodCertificate() const {
    EXPECT_LT(certificate("curvature_residual"), 1e-10);
    EXPECT_LT(certificate("gauss_bonnet_residual"), 1e-8);
    EXPECT_EQ(certificate("flipped_faces"), 0);
    EXPECT_LT(certificate("layout_closure"), 1e-6);
  }

  std::optional<Json> report_;
};

// The surface is the same, in the same order, and every corner has a point.
void expectSameSurface(const Obj& out, const Obj& in) {
  EXPECT_EQ(out.vertices, in.vertices);
  EXPECT_EQ(out.faces, in.faces);
  ASSERT_EQ(out.corners.size(), in.faces.size());
  for (const auto& corners : out.corners) {
    for (const int corner : corners) {
      ASSERT_GE(corner, 0);
      ASSERT_LT(corner, static_cast<int>(out.points.size()));
    }
  }
}

// Faces do not fold, and the two sides of every edge have one length: the plane is glued to the
// surface by motions.
void expectGluedWithoutFolds(const Obj& out) {
  int folded = 0, torn = 0;
  for (std::size_t f = 0; f < out.faces.size(); ++f) folded += out.doubledArea(f) > 0 ? 0 : 1;
  for (const auto& [edge, lengths] : out.edgeLengths()) {
    if (lengths.size() != 2) continue;
    torn += std::abs(lengths[0] - lengths[1]) <= 1e-6 * lengths[0] ? 0 : 1;
  }
  EXPECT_EQ(folded, 0) << "faces";
  EXPECT_EQ(torn, 0) << "edges";
}

std::vector<bool> boundaryVertices(const Obj& obj) {
  std::vector<bool> on_boundary(obj.positions.size(), false);
  for (const auto& [edge, lengths] : obj.edgeLengths()) {
    if (lengths.size() == 1) on_boundary[edge.first] = on_boundary[edge.second] = true;
  }
  return on_boundary;
}

int nearestVertex(const Obj& obj, const std::array<double, 3>& place) {
  const auto squaredDistance = [&](const std::array<double, 3>& p) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += (p[i] - place[i]) * (p[i] - place[i]);
    return sum;
  };
  const auto nearest = std::min_element(
      obj.positions.begin(), obj.positions.end(),
      [&](const auto& a, const auto& b) { return squaredDistance(a) < squaredDistance(b); });
  return static_cast<int>(nearest - obj.positions.begin());
}

// How far the angles around a vertex are from what they should sum to, where they are farthest.
double worstSum(const Obj& out, const std::function<double(int)>& wanted) {
  double worst = 0;
  const std::vector<double> sums = out.angleSums();
  for (std::size_t v = 0; v < sums.size(); ++v) {
    worst = std::max(worst, std::abs(sums[v] - wanted(static_cast<int>(v))));
  }
  return worst;
}

double worstFlatSum(const Obj& out) {
  return worstSum(out, [](int) { return 2 * kPi; });
}

TEST_F(Parameterize, ATorusNeedsNoCones) {
  sample("torus.obj", {"torus", "resolution=20"});
  const Obj out = map("torus.obj");
  EXPECT_THAT(report_->keys(), UnorderedElementsAre("target", "refined", "certificate", "timing",
                                                    "circles", "layout", "cone_metric"));
  EXPECT_EQ((*report_)["layout"]["faces"].number(), 1600);
  EXPECT_EQ((*report_)["layout"]["mapped_faces"].number(), 1600);
  EXPECT_EQ((*report_)["layout"]["islands"].number(), 1);
  EXPECT_GT((*report_)["layout"]["seam_length"].number(), 0);
  EXPECT_EQ((*report_)["target"].string(), "FLAT");
  EXPECT_FALSE((*report_)["refined"].boolean());
  EXPECT_THAT((*report_)["certificate"].keys(),
              testing::IsSupersetOf({"curvature_residual", "gauss_bonnet_residual",
                                     "layout_closure", "flipped_faces", "max_dilatation",
                                     "mean_dilatation", "newton_iterations", "flips",
                                     "smallest_angle", "mollification", "warnings"}));
  EXPECT_TRUE((*report_)["certificate"]["warnings"].isList());
  EXPECT_GT((*report_)["timing"].keys().size(), 1U);
  expectGoodCertificate();
  EXPECT_GE(certificate("max_dilatation"), certificate("mean_dilatation"));
  EXPECT_GE(certificate("mean_dilatation"), 1);

  const Obj in = Obj::parse(read("torus.obj"));
  expectSameSurface(out, in);
  EXPECT_GT(out.points.size(), in.vertices.size()) << "a torus does not lie in the plane uncut";
  expectGluedWithoutFolds(out);
  EXPECT_LT(worstFlatSum(out), 1e-6);
  double area = 0;
  for (std::size_t f = 0; f < out.faces.size(); ++f) area += out.doubledArea(f) / 2;
  const Json inspected = Json::parse(run({"inspect", "torus.obj", "--json"}).out);
  EXPECT_NEAR(area, inspected["topology"]["area"].number(), 1e-6 * area);
}

TEST_F(Parameterize, ASphereBecomesACubeByEightCones) {
  sample("sphere.obj", {"sphere", "resolution=10"});
  const Obj in = Obj::parse(read("sphere.obj"));
  std::vector<double> wanted(in.positions.size(), 2 * kPi);
  std::string cones = "# corners of a cube\n";
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [corner](int bit) { return (corner >> bit & 1) == 1 ? 0.577 : -0.577; };
    const int v = nearestVertex(in, {side(0), side(1), side(2)});
    wanted[v] -= kPi / 2;
    cones += std::to_string(v) + (corner % 2 == 0 ? ", " : "\t") + "1.5707963267948966 # right\r\n";
  }
  write("cones.txt", cones);
  const Obj out = map("sphere.obj", {"--cones", "cones.txt"});
  expectGoodCertificate();
  expectSameSurface(out, in);
  expectGluedWithoutFolds(out);
  EXPECT_LT(worstSum(out, [&](int v) { return wanted[v]; }), 1e-6);
}

TEST_F(Parameterize, ConesThatBreakGaussAndBonnetAreAnErrorThatNamesTheirSum) {
  sample("sphere.off", {"sphere", "resolution=4"});
  write("cones.txt", "0 1\n1 1\n2 1\n3 1\n4 1.0625\n5 2\n");
  write("out.obj", "precious");
  const ProcessResult result = flat("sphere.off", {"--cones", "cones.txt", "-o", "out.obj"});
  EXPECT_THAT(result, FailsWithOneLine());
  EXPECT_THAT(result.err, HasSubstr("7.0625"));
  EXPECT_THAT(result.err, HasSubstr("INVALID_OPTION"));
  EXPECT_EQ(read("out.obj"), "precious");
  EXPECT_THAT(flat("sphere.off"), FailsWithOneLine()) << "a sphere without cones";
}

TEST_F(Parameterize, ABoundaryTurnsWhereItsFileSays) {
  sample("disk.obj", {"disk", "resolution=8"});
  const Obj in = Obj::parse(read("disk.obj"));
  std::vector<int> corners;
  for (const double turn : {0.0, 0.5, 1.0, 1.5}) {
    corners.push_back(nearestVertex(in, {2 * std::cos(turn * kPi), 2 * std::sin(turn * kPi), 0}));
  }
  std::string file;
  for (const int v : corners) file += std::to_string(v) + " 1.5707963267948966\n";
  write("corners.txt", file);
  const Obj out = map("disk.obj", {"--boundary", "corners.txt"});
  expectGoodCertificate();
  expectSameSurface(out, in);
  expectGluedWithoutFolds(out);
  EXPECT_EQ(out.points.size(), in.vertices.size()) << "a disk needs no cut";
  const std::vector<bool> on_boundary = boundaryVertices(out);
  const auto wanted = [&](int v) {
    const bool is_corner = std::find(corners.begin(), corners.end(), v) != corners.end();
    return is_corner ? kPi / 2 : on_boundary[v] ? kPi : 2 * kPi;
  };
  EXPECT_LT(worstSum(out, wanted), 1e-6);
  // The same cones by --cones, on a boundary of which nothing else is said.
  const std::string as_boundary = read("out.obj");
  map("disk.obj", {"--cones", "corners.txt"});
  EXPECT_TRUE(read("out.obj") == as_boundary);
}

TEST_F(Parameterize, ACircleTurnsAllAlong) {
  sample("disk.obj", {"disk", "resolution=6", "seed=3"});
  const Obj out = map("disk.obj", {"--boundary", "circle"});
  expectGoodCertificate();
  expectGluedWithoutFolds(out);
  std::vector<double> around(out.positions.size(), 0.0);  // Of the boundary, at its vertices.
  double length = 0;
  for (const auto& [edge, lengths] : out.edgeLengths()) {
    if (lengths.size() != 1) continue;
    around[edge.first] += lengths[0] / 2;
    around[edge.second] += lengths[0] / 2;
    length += lengths[0];
  }
  const std::vector<double> sums = out.angleSums();
  double turned = 0;
  for (std::size_t v = 0; v < sums.size(); ++v) {
    if (around[v] == 0) continue;
    EXPECT_NEAR((kPi - sums[v]) / around[v], 2 * kPi / length, 0.02 * 2 * kPi / length) << v;
    turned += kPi - sums[v];
  }
  EXPECT_NEAR(turned, 2 * kPi, 1e-6);
}

TEST_F(Parameterize, ABoundaryIsFreeUnlessSaidOtherwiseAndKeepsItsLengths) {
  // A cap of a sphere: what is flat would show nothing.
  std::string text;
  sample("sphere.obj", {"sphere", "resolution=8"});
  const Obj sphere = Obj::parse(read("sphere.obj"));
  for (const std::string& line : sphere.vertices) text += line + "\n";
  for (const auto& face : sphere.faces) {
    const bool above =
        std::all_of(face.begin(), face.end(), [&](int v) { return sphere.positions[v][2] > 0.25; });
    if (!above) continue;
    text += "f";
    for (const int v : face) text += " " + std::to_string(v + 1);
    text += "\n";
  }
  write("cap.obj", text);
  const Obj out = map("cap.obj", {"--boundary", "free"});
  expectGoodCertificate();
  double least = 1e300, most = 0;
  for (const auto& [edge, lengths] : out.edgeLengths()) {
    if (lengths.size() != 1) continue;
    const double ratio = lengths[0] / out.spaceLength(edge);
    least = std::min(least, ratio);
    most = std::max(most, ratio);
  }
  EXPECT_NEAR(most / least, 1, 1e-6);
  const std::string free = read("out.obj");
  map("cap.obj");
  EXPECT_TRUE(read("out.obj") == free);
}

TEST_F(Parameterize, EverySchemeAndSolverFlattensATorus) {
  sample("torus.obj", {"torus", "resolution=10"});
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--scheme", "thurston"},
        {"--scheme", "tangential"},
        {"--scheme", "inversive-distance"},
        {"--scheme", "vertex-scaling", "--solver", "flow"},
        {"--scheme", "vertex-scaling", "--solver", "newton", "--initial-delaunay", "off"},
        {"--initial-delaunay", "on"}}) {
    SCOPED_TRACE(testing::PrintToString(words));
    const Obj out = map("torus.obj", words);
    EXPECT_LT(certificate("curvature_residual"), 1e-8);
    EXPECT_LT(worstFlatSum(out), 1e-6);
  }
}

TEST_F(Parameterize, WithoutOutputThereIsOnlyTheCertificate) {
  sample("torus.off", {"torus", "resolution=8"});
  const ProcessResult result = flat("torus.off");
  ASSERT_THAT(result, Succeeds());
  EXPECT_THAT(result.out, testing::StartsWith("torus.off\n  target        FLAT\n"));
  EXPECT_THAT(result.out, HasSubstr("0 flipped faces"));
  const ProcessResult quiet = flat("torus.off", {"-o", "Torus.OBJ", "--quiet"});
  ASSERT_THAT(quiet, Succeeds());
  EXPECT_EQ(quiet.out, "");
  EXPECT_TRUE(exists("Torus.OBJ"));
}

TEST_F(Parameterize, TheResultIsTheSameFromEverySourceAndInEveryRun) {
  sample("torus.off", {"torus", "resolution=8"});
  map("torus.off");
  const std::string wanted = read("out.obj");
  map("torus.off");
  EXPECT_TRUE(read("out.obj") == wanted);
  ASSERT_THAT(run({"add", "-c", "demo", "torus.off"}), Succeeds());
  map("demo/torus");
  EXPECT_TRUE(read("out.obj") == wanted);
  Process::Options options;
  options.input = read("torus.off");
  ASSERT_THAT(run({"parameterize", "-", "--to", "flat", "-o", "out.obj"}, options), Succeeds());
  EXPECT_TRUE(read("out.obj") == wanted);
  Daemon daemon(path("served"), path("."));
  ASSERT_NE(daemon.address(), "");
  map("torus.off", {"--server", daemon.address()});
  EXPECT_TRUE(read("out.obj") == wanted);
}

}  // namespace
}  // namespace moduli
