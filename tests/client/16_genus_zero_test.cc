#include <algorithm>
#include <cmath>
#include <complex>

#include "tests/client/cli_test.h"
#include "tests/client/obj.h"

/// parameterize --to sphere, disk, rectangle and circle-domain: the files that it writes.
namespace moduli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// columns x rows cells, each cut along the diagonal from its lower left corner.
std::string grid(int columns, int rows) {
  std::string text;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      text += "v " + std::to_string(i) + " " + std::to_string(j) + " 0\n";
    }
  }
  const auto at = [&](int i, int j) { return std::to_string(j * (columns + 1) + i + 1); };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      text += "f " + at(i, j) + " " + at(i + 1, j) + " " + at(i + 1, j + 1) + "\n";
      text += "f " + at(i, j) + " " + at(i + 1, j + 1) + " " + at(i, j + 1) + "\n";
    }
  }
  return text;
}

class GenusZero : public CliTest {
 protected:
  /// Maps a mesh to out.obj and returns it; `report_` is the JSON document.
  Obj map(const std::string& mesh, std::vector<std::string> words) {
    words.insert(words.begin(), {"parameterize", mesh});
    words.insert(words.end(), {"-o", "out.obj", "--json"});
    const ProcessResult result = run(words);
    EXPECT_THAT(result, Succeeds());
    report_ = Json::parse(result.out.empty() ? "null\n" : result.out);
    return Obj::parse(read("out.obj"));
  }

  double certificate(const std::string& key) const {
    return (*report_)["certificate"][key].number();
  }

  std::optional<Json> report_;
};

TEST_F(GenusZero, ASphereKeepsItsFacesAndItsVerticesMove) {
  sample("s.obj", {"spheroid", "c=1.7", "resolution=6"});
  const Obj in = Obj::parse(read("s.obj"));
  for (const std::string method : {"auto", "robust", "linear", "heat-flow"}) {
    const Obj out = map("s.obj", {"--to", "sphere", "--method", method});
    EXPECT_EQ(out.faces, in.faces);
    ASSERT_EQ(out.positions.size(), in.positions.size());
    for (const auto& [x, y, z] : out.positions) EXPECT_NEAR(std::hypot(x, y, z), 1, 1e-14);
    EXPECT_TRUE(out.points.empty());
    EXPECT_EQ((*report_)["target"].string(), "SPHERE");
    EXPECT_EQ((*report_)["method"].string(), method == "linear"      ? "LINEAR"
                                             : method == "heat-flow" ? "HEAT_FLOW"
                                                                     : "ROBUST");
    EXPECT_FALSE((*report_)["refined"].boolean());
    EXPECT_EQ(certificate("flipped_faces"), 0);
    EXPECT_NEAR(certificate("covering_degree"), 1, 1e-12);
    EXPECT_LT(certificate("centering_residual"), 1e-12);
    EXPECT_GE(certificate("dilatation_95"), 1);
  }
}

TEST_F(GenusZero, ADiskHasItsBoundaryOnTheCircle) {
  write("d.obj", grid(8, 5));
  const Obj in = Obj::parse(read("d.obj"));
  for (const std::string method : {"auto", "linear", "heat-flow"}) {
    const Obj out =
        map("d.obj", {"--to", "disk", "--method", method, "--mobius", "1,0.3i,-0.3i,1"});
    EXPECT_EQ(out.vertices, in.vertices);
    EXPECT_EQ(out.faces, in.faces);
    ASSERT_EQ(out.points.size(), in.positions.size());
    for (std::size_t f = 0; f < out.faces.size(); ++f) {
      EXPECT_GT(out.doubledArea(f), 0);
      for (int c = 0; c < 3; ++c) {
        const auto& [x, y, z] = in.positions[in.faces[f][c]];
        const double radius = std::abs(out.points[out.corners[f][c]]);
        if (x == 0 || x == 8 || y == 0 || y == 5) {
          EXPECT_NEAR(radius, 1, 1e-14);
        } else {
          EXPECT_LT(radius, 1);
        }
      }
    }
  }
}

TEST_F(GenusZero, AFlatRectangleIsItsOwnImage) {
  write("r.obj", grid(8, 4));
  const Obj out = map("r.obj", {"--to", "rectangle", "--corners", "0,8,44,36"});
  EXPECT_NEAR((*report_)["modulus"].number(), 2, 1e-12);
  for (std::size_t f = 0; f < out.faces.size(); ++f) {
    for (int c = 0; c < 3; ++c) {
      const auto& [x, y, z] = out.positions[out.faces[f][c]];
      EXPECT_LT(std::abs(out.points[out.corners[f][c]] * 4.0 - std::complex<double>(x, y)), 1e-10);
    }
  }
}

TEST_F(GenusZero, FacesThatMustFoldAreCutAndNewVerticesFollow) {
  // Turned by a quarter of its boundary, the corner faces of the grid lie flat on a side.
  write("r.obj", grid(8, 4));
  const Obj in = Obj::parse(read("r.obj"));
  const std::vector<std::string> corners = {"--to", "rectangle", "--corners", "4,26,40,18"};
  const Obj out = map("r.obj", corners);
  EXPECT_TRUE((*report_)["refined"].boolean());
  const auto added = static_cast<std::size_t>((*report_)["added_vertices"].number());
  EXPECT_GT(added, 0U);
  ASSERT_EQ(out.positions.size(), in.positions.size() + added);
  EXPECT_TRUE(std::equal(in.vertices.begin(), in.vertices.end(), out.vertices.begin()));
  const auto added_faces = static_cast<std::size_t>((*report_)["added_faces"].number());
  EXPECT_EQ(out.faces.size(), in.faces.size() + added_faces);
  double area = 0;
  for (std::size_t f = 0; f < out.faces.size(); ++f) {
    EXPECT_GT(out.doubledArea(f), 0);
    area += out.doubledArea(f) / 2;
  }
  EXPECT_NEAR(area, (*report_)["modulus"].number(), 1e-9);
  std::vector<std::string> off = {"parameterize", "r.obj", "--refine", "off"};
  off.insert(off.end(), corners.begin(), corners.end());
  expectRefusal(off, "FOLDED_MAP");
}

TEST_F(GenusZero, ACircleDomainTellsItsCircles) {
  sample("p.obj", {"plate", "holes=2", "resolution=4"});
  const Obj out = map("p.obj", {"--to", "circle-domain"});
  EXPECT_EQ((*report_)["circles"].size(), 3);
  EXPECT_EQ((*report_)["circles"].at(0)["radius"].number(), 1);
  EXPECT_LT(certificate("boundary_deviation"), 1e-8);
  for (std::size_t f = 0; f < out.faces.size(); ++f) EXPECT_GT(out.doubledArea(f), 0);
}

TEST_F(GenusZero, PicturesAreWrittenBesideTheResultOrWithoutOne) {
  sample("s.obj", {"spheroid", "c=1.7", "resolution=4"});
  EXPECT_THAT(
      run({"parameterize", "s.obj", "--to", "sphere", "--picture", "s.png", "--size", "300x120"}),
      Succeeds());
  EXPECT_THAT(read("s.png"), StartsWith("\x89PNG"));
  map("s.obj", {"--to", "sphere", "--picture", "s.svg", "--view", "top"});
  EXPECT_THAT(read("s.svg"), HasSubstr("<svg"));
}

TEST_F(GenusZero, RefusalsNameTheTargetThatWorks) {
  sample("t.obj", {"torus", "resolution=8"});
  write("d.obj", grid(3, 3));
  expectRefusal({"parameterize", "t.obj", "--to", "sphere"}, "--to flat maps it");
  expectRefusal({"parameterize", "d.obj", "--to", "sphere"}, "--to disk");
  expectRefusal({"parameterize", "d.obj", "--to", "rectangle", "--corners", "0,3,15,5"},
                "a corner at vertex 5, which is not on the boundary");
  expectRefusal({"parameterize", "d.obj", "--to", "disk", "--mobius", "2,0,0,1"},
                "does not keep the unit disk");
}

}  // namespace
}  // namespace moduli
