#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "tests/client/cli_test.h"
#include "tests/client/obj.h"

/// parameterize --to torus, flat with chosen cones, polycube, atlas and quads: the files that it
/// writes, judged by themselves, and what it refuses.
namespace moduli {
namespace {

using testing::HasSubstr;
using testing::IsSupersetOf;
using Complex = std::complex<double>;

constexpr double kPi = std::numbers::pi;
/// Of sums of some hundred angles and lengths of a layout that closes to about 1e-12.
constexpr double kRounding = 1e-8;

class PlaneTargets : public CliTest {
 protected:
  /// Maps a mesh to out.obj; returns the JSON document.
  Json map(const std::string& mesh, std::vector<std::string> words) const {
    words.insert(words.begin(), {"parameterize", mesh, "-o", "out.obj", "--to"});
    return json(words);
  }
  Obj out() const { return Obj::parse(read("out.obj")); }

  /// --to polycube and so on, which fails with a line that has a word in it.
  void expectFailure(const std::vector<std::string>& words, const std::string& why) const {
    const ProcessResult result = run(words);
    EXPECT_THAT(result, FailsWithOneLine());
    EXPECT_THAT(result.err, HasSubstr(why));
  }
};

Complex complexOf(const Json& json) {
  return {json["re"].number(), json["im"].number()};
}

int foldedFaces(const Obj& out) {
  int folded = 0;
  for (std::size_t f = 0; f < out.faces.size(); ++f) folded += out.doubledArea(f) > 0 ? 0 : 1;
  return folded;
}

double areaOf(const Obj& out) {
  double area = 0;
  for (std::size_t f = 0; f < out.faces.size(); ++f) area += out.doubledArea(f) / 2;
  return area;
}

/// By what each edge that has two images is moved from the first to the second one, checked to be
/// the same at both ends.
std::vector<Complex> seamShifts(const Obj& out) {
  std::map<Obj::Edge, std::array<Complex, 2>> seen;
  std::vector<Complex> shifts;
  for (std::size_t f = 0; f < out.faces.size(); ++f) {
    for (int c = 0; c < 3; ++c) {
      int v = out.faces[f][c], w = out.faces[f][(c + 1) % 3];
      Complex p = out.points[out.corners[f][c]], q = out.points[out.corners[f][(c + 1) % 3]];
      if (v > w) {
        std::swap(v, w);
        std::swap(p, q);
      }
      const auto [it, is_new] = seen.try_emplace({v, w}, std::array{p, q});
      if (is_new) continue;
      EXPECT_LT(std::abs((p - it->second[0]) - (q - it->second[1])), kRounding);
      if (std::abs(p - it->second[0]) > kRounding) shifts.push_back(p - it->second[0]);
    }
  }
  return shifts;
}

/// The largest difference of the angles around vertices from 2 pi less what cones have there.
double worstCurvature(const Obj& out, const Json& cones) {
  std::vector<double> wanted(out.positions.size(), 0.0);
  for (int n = 0; n < cones.size(); ++n) {
    wanted[static_cast<std::size_t>(cones.at(n)["vertex"].number())] =
        cones.at(n)["curvature"].number();
  }
  const std::vector<double> sums = out.angleSums();
  double worst = 0;
  for (std::size_t v = 0; v < sums.size(); ++v) {
    worst = std::max(worst, std::abs(2 * kPi - sums[v] - wanted[v]));
  }
  return worst;
}

double sumOf(const Json& cones) {
  double sum = 0;
  for (int n = 0; n < cones.size(); ++n) sum += cones.at(n)["curvature"].number();
  return sum;
}

double fromMultiple(double x, double unit) {
  return std::abs(std::remainder(x, unit));
}

TEST_F(PlaneTargets, ATorusIsCutIntoOneCellOfItsLattice) {
  sample("torus.obj", {"torus", "R=2", "r=1", "resolution=24"});
  const Json report = map("torus.obj", {"torus", "--picture", "tiles.png"});
  EXPECT_EQ(report["target"].string(), "TORUS");
  EXPECT_FALSE(report.has("method"));
  const Json torus = report["torus"];
  EXPECT_THAT(torus.keys(), testing::UnorderedElementsAre("generators", "tau", "parallelogram"));
  ASSERT_EQ(torus["generators"].size(), 2);
  const Complex a = complexOf(torus["generators"].at(0)), b = complexOf(torus["generators"].at(1));
  EXPECT_EQ(a.imag(), 0);
  EXPECT_NEAR((std::conj(a) * b).imag(), 1, 1e-12);
  EXPECT_LT(std::abs(b / a - complexOf(torus["tau"])), 1e-12);
  // Of the smooth torus; the polyhedron has it up to 1 % at this resolution.
  EXPECT_LT(std::abs(complexOf(torus["tau"]) - Complex(0, std::sqrt(3.0))), 0.02);
  EXPECT_LT(report["certificate"]["holonomy_residual"].number(), 1e-9);
  EXPECT_EQ(report["layout"]["islands"].number(), 1);

  const Obj in = Obj::parse(read("torus.obj")), image = out();
  EXPECT_EQ(image.vertices, in.vertices);
  EXPECT_EQ(image.faces, in.faces);
  EXPECT_EQ(foldedFaces(image), 0);
  EXPECT_NEAR(areaOf(image), 1, 1e-9);
  const std::vector<Complex> shifts = seamShifts(image);
  EXPECT_FALSE(shifts.empty());
  for (const Complex& shift : shifts) {
    const double n = shift.imag() / b.imag(), m = (shift - n * b).real() / a.real();
    EXPECT_LT(fromMultiple(n, 1) + fromMultiple(m, 1), kRounding) << shift;
  }
  EXPECT_THAT(read("tiles.png"), HasSubstr("PNG"));
}

TEST_F(PlaneTargets, ATorusSaysItsLatticeInWords) {
  sample("torus.off", {"torus", "resolution=12"});
  const ProcessResult result = run({"parameterize", "torus.off", "--to", "torus"});
  ASSERT_THAT(result, Succeeds());
  EXPECT_THAT(result.out, HasSubstr("  tau "));
  EXPECT_THAT(result.out, HasSubstr("  lattice "));
  EXPECT_THAT(result.out, HasSubstr("1 island"));
}

TEST_F(PlaneTargets, ChosenConesTakeStretchingOutAndAreTold) {
  sample("egg.obj", {"spheroid", "a=1", "c=3", "resolution=12"});
  const Json report = map("egg.obj", {"flat", "--cones", "auto", "--cone-spread", "0.8"});
  const Json metric = report["cone_metric"];
  EXPECT_THAT(metric.keys(), IsSupersetOf({"cones", "handle_turns", "spread", "spread_before"}));
  EXPECT_GE(metric["cones"].size(), 3);
  EXPECT_NEAR(sumOf(metric["cones"]), 4 * kPi, 1e-9);
  EXPECT_LT(metric["spread"].number(), metric["spread_before"].number());
  EXPECT_LE(metric["spread"].number(), 0.8);
  const Obj image = out();
  EXPECT_EQ(foldedFaces(image), 0);
  EXPECT_LT(worstCurvature(image, metric["cones"]), kRounding);
  const Json fewer = map("egg.obj", {"flat", "--cones", "auto", "--most-cones", "4"});
  EXPECT_LE(fewer["cone_metric"]["cones"].size(), 4);
  EXPECT_GT(fewer["cone_metric"]["spread"].number(), 1);
  EXPECT_THAT(fewer["certificate"]["warnings"].at(0).string(), HasSubstr("CONE_SPREAD"));
  const ProcessResult words = run({"parameterize", "egg.obj", "--to", "flat", "--cones", "auto"});
  ASSERT_THAT(words, Succeeds());
  EXPECT_THAT(words.out, HasSubstr("  cones "));
}

TEST_F(PlaneTargets, SeamlessConesHaveQuarterTurns) {
  sample("egg.obj", {"spheroid", "a=1", "c=2", "resolution=10"});
  const Json report = map("egg.obj", {"flat", "--cones", "auto", "--seamless"});
  const Json cones = report["cone_metric"]["cones"];
  EXPECT_NEAR(sumOf(cones), 4 * kPi, 1e-9);
  for (int n = 0; n < cones.size(); ++n) {
    EXPECT_LT(fromMultiple(cones.at(n)["curvature"].number(), kPi / 2), 1e-12);
  }
  const Obj image = out();
  EXPECT_LT(worstCurvature(image, cones), kRounding);
  EXPECT_EQ(foldedFaces(image), 0);
}

TEST_F(PlaneTargets, APolycubeHasCornersOfCubes) {
  sample("egg.obj", {"spheroid", "a=1", "c=2", "resolution=10"});
  const Json report = map("egg.obj", {"polycube", "--picture", "cubes.svg"});
  EXPECT_EQ(report["target"].string(), "POLYCUBE");
  const Json cones = report["cone_metric"]["cones"];
  int signs = 0;
  for (int n = 0; n < cones.size(); ++n) {
    const double curvature = cones.at(n)["curvature"].number();
    EXPECT_NEAR(std::abs(curvature), kPi / 2, 1e-9);
    signs += curvature > 0 ? 1 : -1;
  }
  EXPECT_EQ(signs, 8);
  EXPECT_LT(worstCurvature(out(), cones), kRounding);
  EXPECT_EQ(foldedFaces(out()), 0);
  // As many dots on the picture as the image has corners at cones.
  const std::string picture = read("cubes.svg");
  std::size_t dots = 0;
  for (auto at = picture.find("<circle"); at != std::string::npos;
       at = picture.find("<circle", at + 1)) {
    ++dots;
  }
  EXPECT_GE(dots, static_cast<std::size_t>(cones.size()));

  std::string file;
  for (int n = 0; n < cones.size(); ++n) {
    file += std::to_string(static_cast<int>(cones.at(n)["vertex"].number())) +
            (cones.at(n)["curvature"].number() > 0 ? " 1.57080\n" : " -1.57080\n");
  }
  write("corners.txt", file);
  const std::string found = read("out.obj");
  map("egg.obj", {"polycube", "--cones", "corners.txt"});
  EXPECT_TRUE(read("out.obj") == found) << "the same corners, given";
}

TEST_F(PlaneTargets, WrongCornersNameTheTheorem) {
  sample("egg.obj", {"sphere", "resolution=5"});
  write("seven.txt", "0 1.5708\n1 1.5708\n2 1.5708\n3 1.5708\n4 1.5708\n5 1.5708\n6 1.5708\n");
  expectFailure({"parameterize", "egg.obj", "--to", "polycube", "--cones", "seven.txt"},
                "Gauss and Bonnet");
  write("third.txt", "3 1.0472\n");
  expectFailure({"parameterize", "egg.obj", "--to", "polycube", "--cones", "third.txt"},
                "vertex 3");
  write("one.txt", "0 12.566370614359172\n");
  expectFailure({"parameterize", "egg.obj", "--to", "flat", "--cones", "one.txt"}, "2 pi");
}

TEST_F(PlaneTargets, AnAtlasHasAChartAroundEveryVertexButOne) {
  sample("pretzel.obj", {"genus", "genus=2", "resolution=6"});
  const Json report = map("pretzel.obj", {"atlas", "--atlas", "charts.json"});
  const Obj in = Obj::parse(read("pretzel.obj")), image = out();
  const Json cones = report["cone_metric"]["cones"];
  ASSERT_EQ(cones.size(), 1);
  EXPECT_NEAR(cones.at(0)["curvature"].number(), -4 * kPi, 1e-9);
  EXPECT_LT(report["atlas"]["overlap_residual"].number(), 1e-9);
  EXPECT_LT(report["atlas"]["cocycle_residual"].number(), 1e-9);
  const Json atlas = Json::parse(read("charts.json"));
  EXPECT_EQ(atlas["format"].string(), "moduli-affine-atlas");
  const auto vertices = static_cast<int>(image.positions.size());
  EXPECT_EQ(atlas["vertices"].number(), vertices);
  EXPECT_EQ(atlas["charts"].size(), vertices - 1);
  EXPECT_EQ(report["atlas"]["charts"].number(), vertices - 1);
  EXPECT_EQ(report["atlas"]["transitions"].number(), atlas["transitions"].size());
  EXPECT_EQ(atlas["extraordinary"].at(0)["vertex"].number(), cones.at(0)["vertex"].number());
  ASSERT_EQ(atlas["faces"].size(), static_cast<int>(image.faces.size()));

  // A transition carries the far end of its edge to the middle of that one's chart.
  std::map<int, std::map<int, Complex>> charts;
  const Json listed = atlas["charts"], transitions = atlas["transitions"];
  for (int n = 0; n < listed.size(); ++n) {
    const Json chart = listed.at(n);
    for (int k = 0; k < chart["neighbours"].size(); ++k) {
      const Json point = chart["points"].at(k);
      charts[static_cast<int>(chart["vertex"].number())][static_cast<int>(
          chart["neighbours"].at(k).number())] = {point.at(0).number(), point.at(1).number()};
    }
  }
  // The edges are those of the file's faces.
  for (const auto& face : image.faces) {
    if (!charts.contains(face[0])) continue;
    EXPECT_TRUE(charts[face[0]].contains(face[1]) && charts[face[0]].contains(face[2]));
  }
  for (int n = 0; n < transitions.size(); n += 97) {
    const Json t = transitions.at(n);
    const int from = static_cast<int>(t["from"].number()), to = static_cast<int>(t["to"].number());
    const Complex shift(t["translation"].at(0).number(), t["translation"].at(1).number());
    const Complex turn = std::polar(1.0, t["angle"].number());
    EXPECT_LT(std::abs(turn * charts[from][to] + shift), 1e-9 * std::abs(charts[from][to]));
    EXPECT_LT(std::abs(shift - charts[to][from]), 1e-9 * std::abs(shift));
  }
}

TEST_F(PlaneTargets, AnAtlasIsInTheNumbersOfTheFile) {
  // The torus behind a vertex of nobody and a face of another component.
  sample("torus.obj", {"torus", "resolution=6"});
  const Obj torus = Obj::parse(read("torus.obj"));
  std::string text = "v 9 9 9\nv 9 8 9\nv 9 9 7\nv 5 5 5\n";
  for (const std::string& line : torus.vertices) text += line + "\n";
  text += "f 1 2 3\n";
  for (const auto& face : torus.faces) {
    text += "f";
    for (const int v : face) text += " " + std::to_string(v + 5);
    text += "\n";
  }
  write("both.obj", text);
  map("both.obj", {"atlas", "--component", "largest", "--atlas", "charts.json"});
  const Json atlas = Json::parse(read("charts.json"));
  EXPECT_EQ(atlas["vertices"].number(), static_cast<double>(torus.positions.size()) + 4);
  EXPECT_EQ(atlas["charts"].size(), static_cast<int>(torus.positions.size()));
  const Json charts = atlas["charts"], faces = atlas["faces"];
  const Obj image = out();
  for (int n = 0; n < charts.size(); ++n) {
    EXPECT_GE(charts.at(n)["vertex"].number(), 4);
  }
  for (int n = 0; n < faces.size(); ++n) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(faces.at(n).at(c).number(), image.faces[n + 1][c]) << n;
    }
  }
}

TEST_F(PlaneTargets, ExtraordinaryPointsAreThoseOfTheFile) {
  sample("pretzel.obj", {"genus", "genus=2", "resolution=6"});
  const Json report = map("pretzel.obj", {"atlas", "--extraordinary", "5,100"});
  const Json cones = report["cone_metric"]["cones"];
  ASSERT_EQ(cones.size(), 2);
  EXPECT_EQ(cones.at(0)["vertex"].number(), 5);
  EXPECT_EQ(cones.at(1)["vertex"].number(), 100);
  EXPECT_NEAR(cones.at(1)["curvature"].number(), -2 * kPi, 1e-9);
  expectFailure({"parameterize", "pretzel.obj", "--to", "atlas", "--extraordinary", "99999"},
                "vertex 99999");
  sample("ball.off", {"sphere", "resolution=4"});
  expectFailure({"parameterize", "ball.off", "--to", "atlas", "--extraordinary", "0"},
                "Gauss and Bonnet");
}

TEST_F(PlaneTargets, QuadsHaveWholePeriodsAcrossAllCuts) {
  sample("torus.obj", {"torus", "R=2", "resolution=16"});
  const Json report =
      map("torus.obj", {"quads", "--most-squares", "300", "--picture", "squares.png"});
  const Json quads = report["quads"];
  EXPECT_THAT(quads.keys(), testing::UnorderedElementsAre("zeros", "periods", "squares", "misfit"));
  EXPECT_LE(quads["squares"].number(), 450);
  EXPECT_LT(fromMultiple(quads["squares"].number(), 1), 1e-6);
  EXPECT_LT(quads["misfit"].number(), 0.5);
  ASSERT_EQ(quads["periods"].size(), 2);
  for (int n = 0; n < 2; ++n) {
    EXPECT_LT(fromMultiple(quads["periods"].at(n)["re"].number(), 1), 1e-12);
    EXPECT_LT(fromMultiple(quads["periods"].at(n)["im"].number(), 1), 1e-12);
  }
  const std::vector<Complex> shifts = seamShifts(out());
  EXPECT_FALSE(shifts.empty());
  for (const Complex& shift : shifts) {
    EXPECT_LT(fromMultiple(shift.real(), 1) + fromMultiple(shift.imag(), 1), kRounding) << shift;
  }
  EXPECT_THAT(read("squares.png"), HasSubstr("PNG"));
}

TEST_F(PlaneTargets, ZerosOfTheFormSumToTheEulerCharacteristic) {
  sample("pretzel.obj", {"genus", "genus=2", "resolution=8"});
  const Json zeros = map("pretzel.obj", {"quads"})["quads"]["zeros"];
  double sum = 0;
  for (int n = 0; n < zeros.size(); ++n) sum += zeros.at(n)["index"].number();
  EXPECT_EQ(sum, -2);
}

TEST_F(PlaneTargets, SeamsOfAFileAreCut) {
  sample("egg.obj", {"spheroid", "a=1", "c=2", "resolution=10"});
  map("egg.obj", {"flat", "--cones", "auto"});
  const Obj before = out();
  const auto isCut = [](const Obj& image, int a, int b) {
    std::set<std::pair<int, int>> sides;
    for (std::size_t f = 0; f < image.faces.size(); ++f) {
      for (int c = 0; c < 3; ++c) {
        const int d = (c + 1) % 3;
        if (std::minmax(image.faces[f][c], image.faces[f][d]) != std::minmax(a, b)) continue;
        sides.insert(std::minmax(image.corners[f][c], image.corners[f][d]));
      }
    }
    return sides.size() == 2;
  };
  // A way of some edges where nothing was cut.
  std::string way;
  std::vector<int> vertices = {before.faces.back()[0]};
  for (const std::array<int, 3>& face : before.faces) {
    for (int c = 0; c < 3 && vertices.size() < 5; ++c) {
      const int next = face[(c + 1) % 3];
      if (face[c] != vertices.back() || isCut(before, face[c], next)) continue;
      if (std::find(vertices.begin(), vertices.end(), next) != vertices.end()) continue;
      vertices.push_back(next);
    }
  }
  ASSERT_GE(vertices.size(), 2U);
  for (const int v : vertices) way += std::to_string(v) + " ";
  write("seams.txt", "# along here\n" + way + "\n");
  for (const std::vector<std::string>& target : std::vector<std::vector<std::string>>{
           {"flat", "--cones", "auto"}, {"polycube"}, {"atlas"}}) {
    std::vector<std::string> words = target;
    words.insert(words.end(), {"--seams", "seams.txt"});
    map("egg.obj", words);
    const Obj image = out();
    for (std::size_t n = 1; n < vertices.size(); ++n) {
      EXPECT_TRUE(isCut(image, vertices[n - 1], vertices[n])) << target[0];
    }
    EXPECT_EQ(foldedFaces(image), 0);
  }
  write("far.txt", "0 1 0 400\n");
  expectFailure(
      {"parameterize", "egg.obj", "--to", "flat", "--cones", "auto", "--seams", "far.txt"},
      "which no edge joins");
  write("short.txt", "# nothing\n7\n");
  expectFailure(
      {"parameterize", "egg.obj", "--to", "flat", "--cones", "auto", "--seams", "short.txt"},
      "short.txt:2: a seam has two vertices at least");
  expectFailure(
      {"parameterize", "egg.obj", "--to", "flat", "--cones", "auto", "--seams", "none.txt"},
      "none.txt");
}

TEST_F(PlaneTargets, ComponentsLieSideBySideWithTheMarginAskedFor) {
  sample("egg.obj", {"spheroid", "a=1", "c=2", "resolution=6"});
  sample("ring.obj", {"torus", "resolution=6"});
  // Both in one file: the second one's numbers follow the first one's.
  const Obj egg = Obj::parse(read("egg.obj")), ring = Obj::parse(read("ring.obj"));
  std::string both;
  for (const Obj* part : {&egg, &ring}) {
    for (const std::string& line : part->vertices) both += line + "\n";
  }
  const auto first = static_cast<int>(egg.vertices.size());
  for (const Obj* part : {&egg, &ring}) {
    for (const std::array<int, 3>& face : part->faces) {
      both += "f";
      for (const int v : face) both += " " + std::to_string(v + 1 + (part == &ring ? first : 0));
      both += "\n";
    }
  }
  write("both.obj", both);
  const Json report =
      map("both.obj", {"flat", "--cones", "auto", "--component", "all", "--margin", "0.2"});
  const Obj image = out();
  EXPECT_EQ(report["layout"]["mapped_faces"].number(), static_cast<double>(image.faces.size()));
  EXPECT_EQ(foldedFaces(image), 0);
  for (const std::array<int, 3>& corners : image.corners) EXPECT_GE(corners[0], 0);
  // The boxes of both: apart by a fifth of the root of the area, at least.
  double area = 0;
  std::array<std::array<double, 4>, 2> box{
      {{1e300, 1e300, -1e300, -1e300}, {1e300, 1e300, -1e300, -1e300}}};
  for (std::size_t f = 0; f < image.faces.size(); ++f) {
    area += image.doubledArea(f) / 2;
    std::array<double, 4>& own = box[image.faces[f][0] < first ? 0 : 1];
    for (const int corner : image.corners[f]) {
      const Complex p = image.points[corner];
      own = {std::min(own[0], p.real()), std::min(own[1], p.imag()), std::max(own[2], p.real()),
             std::max(own[3], p.imag())};
    }
  }
  if (report["layout"]["islands"].number() == 2) {
    const double apart = std::max({box[0][0] - box[1][2], box[1][0] - box[0][2],
                                   box[0][1] - box[1][3], box[1][1] - box[0][3]});
    EXPECT_NEAR(apart / std::sqrt(area), 0.2, 1e-9);
  }
  expectFailure({"parameterize", "both.obj", "--to", "flat"}, "MULTIPLE_COMPONENTS");
  expectFailure({"signature", "both.obj", "--component", "all"}, "this takes one component");
}

TEST_F(PlaneTargets, SurfacesThatDoNotFitAreRefused) {
  sample("ball.off", {"sphere", "resolution=4"});
  sample("disk.off", {"disk", "resolution=4"});
  for (const std::string target : {"torus", "quads"}) {
    for (const std::string mesh : {"ball.off", "disk.off"}) {
      expectFailure({"parameterize", mesh, "--to", target}, "UNSUPPORTED_TOPOLOGY");
    }
  }
  for (const std::string target : {"polycube", "atlas"}) {
    expectFailure({"parameterize", "disk.off", "--to", target}, "UNSUPPORTED_TOPOLOGY");
  }
}

TEST_F(PlaneTargets, OptionsOfOtherTargetsAreWrongUsage) {
  sample("ball.off", {"sphere", "resolution=4"});
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"torus", "--cones", "auto"},
                                             {"torus", "--overlaps", "keep"},
                                             {"flat", "--seamless"},
                                             {"flat", "--cone-spread", "1"},
                                             {"polycube", "--seamless"},
                                             {"flat", "--cones", "auto", "--most-cones", "0"},
                                             {"flat", "--atlas", "a.json"},
                                             {"flat", "--extraordinary", "1"},
                                             {"atlas", "--extraordinary", "1,,2"},
                                             {"flat", "--most-squares", "9"},
                                             {"quads", "--most-squares", "-1"},
                                             {"torus", "--margin", "0.1"},
                                             {"atlas", "--margin", "-1"},
                                             {"sphere", "--component", "all"},
                                             {"disk", "--seams", "seams.txt"}}) {
    std::vector<std::string> command = {"parameterize", "ball.off", "--to"};
    command.insert(command.end(), words.begin(), words.end());
    EXPECT_THAT(run(command), IsUsageError()) << testing::PrintToString(words);
  }
}

}  // namespace
}  // namespace moduli
