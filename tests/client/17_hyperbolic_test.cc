#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "tests/client/cli_test.h"
#include "tests/client/obj.h"

/// parameterize --to hyperbolic and signature --spectrum-length.
namespace moduli {
namespace {

using testing::HasSubstr;
using Complex = std::complex<double>;

/// Of a regular octagon with its opposite sides glued.
const double kSystole = 2 * std::acosh(1 + std::numbers::sqrt2);

class Hyperbolic : public CliTest {};

Complex image(const Json& isometry, Complex z) {
  const Complex a(isometry["a"]["re"].number(), isometry["a"]["im"].number());
  const Complex b(isometry["b"]["re"].number(), isometry["b"]["im"].number());
  return (a * z + b) / (std::conj(b) * z + std::conj(a));
}

TEST_F(Hyperbolic, TheSurfaceIsCutOpenIntoTheDisk) {
  sample("g.obj", {"genus", "genus=2", "resolution=8"});
  const Json report = json({"parameterize", "g.obj", "--to", "hyperbolic", "-o", "out.obj"});
  const Obj in = Obj::parse(read("g.obj")), out = Obj::parse(read("out.obj"));
  EXPECT_EQ(out.vertices, in.vertices);
  EXPECT_EQ(out.faces, in.faces);
  for (const Complex& z : out.points) EXPECT_LT(std::abs(z), 1);
  for (std::size_t f = 0; f < out.faces.size(); ++f) EXPECT_GT(out.doubledArea(f), 0);

  EXPECT_EQ(report["target"].string(), "HYPERBOLIC");
  EXPECT_FALSE(report["refined"].boolean());
  EXPECT_FALSE(report.has("method"));
  const Json certificate = report["certificate"];
  EXPECT_EQ(certificate["flipped_faces"].number(), 0);
  EXPECT_LT(certificate["curvature_residual"].number(), 1e-10);
  EXPECT_LT(certificate["cycle_residual"].number(), 1e-8);
  EXPECT_LT(certificate["relation_residual"].number(), 1e-8);
  EXPECT_LT(certificate["layout_closure"].number(), 1e-8);
  const Json domain = report["hyperbolic"];
  EXPECT_EQ(domain["generators"].size(), 4);
  EXPECT_EQ(domain["boundary_lengths"].size(), 0);
  ASSERT_GT(domain["geodesics"].size(), 0);
  EXPECT_EQ(domain["geodesics"].at(0)["first_point"].number(), 0);
  EXPECT_GT(domain["geodesics"].at(0)["points"].number(), 2);
  const double shortest = domain["geodesics"].at(0)["length"].number();
  EXPECT_GE(certificate["spectrum_complete_to"].number(), shortest);
  const Json signature = json({"signature", "g.obj"});
  EXPECT_NEAR(signature["conformal"]["length_spectrum"].at(0).number(), shortest, 1e-9);

  // A vertex that the cuts pass has several images; deck transformations carry one to another.
  std::vector<std::vector<Complex>> images(out.positions.size());
  for (std::size_t f = 0; f < out.faces.size(); ++f) {
    for (int c = 0; c < 3; ++c) {
      images[out.faces[f][c]].push_back(out.points[out.corners[f][c]]);
    }
  }
  int cut = 0;
  for (const std::vector<Complex>& of_vertex : images) {
    const Complex first = of_vertex.front();
    for (const Complex& other : of_vertex) {
      if (other == first) continue;
      ++cut;
      double nearest = 1;
      for (int n = 0; n < domain["neighbours"].size(); ++n) {
        nearest = std::min(nearest, std::abs(image(domain["neighbours"].at(n), first) - other));
        for (int m = 0; nearest > 1e-9 && m < domain["neighbours"].size(); ++m) {
          const Complex twice =
              image(domain["neighbours"].at(n), image(domain["neighbours"].at(m), first));
          nearest = std::min(nearest, std::abs(twice - other));
        }
      }
      EXPECT_LT(nearest, 1e-9);
    }
  }
  EXPECT_GT(cut, 20);
}

TEST_F(Hyperbolic, PicturesOfBothKindsAreTheSameEveryTime) {
  sample("g.obj", {"genus", "genus=2", "resolution=4"});
  for (const std::string file : {"disk.png", "disk.svg"}) {
    std::string first;
    for (int times = 0; times < 2; ++times) {
      EXPECT_THAT(run({"parameterize", "g.obj", "--to", "hyperbolic", "--picture", file, "--size",
                       "500x300"}),
                  Succeeds());
      const std::string bytes = read(file);
      EXPECT_GT(bytes.size(), 2000U);
      if (times == 0) first = bytes;
      EXPECT_EQ(bytes, first);
    }
  }
  EXPECT_THAT(read("disk.svg"), HasSubstr("Poincaré disk"));
}

TEST_F(Hyperbolic, AnIntrinsicSurfaceHasItsGeodesics) {
  EXPECT_THAT(run({"sample", "bolza", "-o", "bolza.json"}), Succeeds());
  const Json report = json({"parameterize", "bolza.json", "--to", "hyperbolic", "-o", "out.obj",
                            "--picture", "disk.svg"});
  const Json geodesics = report["hyperbolic"]["geodesics"];
  ASSERT_EQ(geodesics.size(), 12);
  for (int n = 0; n < 12; ++n) EXPECT_NEAR(geodesics.at(n)["length"].number(), kSystole, 1e-9);
}

TEST_F(Hyperbolic, ASpectrumGoesAsFarAsItIsAsked) {
  EXPECT_THAT(run({"sample", "bolza", "-o", "bolza.json"}), Succeeds());
  const auto count = [&](const std::string& length) {
    const Json report = json({"signature", "bolza.json", "--spectrum-length", length});
    EXPECT_NEAR(report["certificate"]["spectrum_complete_to"].number(), std::stod(length), 1e-12);
    return report["conformal"]["length_spectrum"].size();
  };
  EXPECT_EQ(count("3"), 0);
  EXPECT_EQ(count("3.2"), 12);
  EXPECT_EQ(count("5"), 24);
  EXPECT_EQ(count("5.9"), 48);
  for (const std::string wrong : {"0", "-1", "nan", "inf", "long"}) {
    EXPECT_THAT(run({"signature", "bolza.json", "--spectrum-length", wrong}), IsUsageError());
  }
}

TEST_F(Hyperbolic, BoundariesBecomeGeodesic) {
  sample("p.obj", {"plate", "holes=2", "resolution=6"});
  const Json report = json({"parameterize", "p.obj", "--to", "hyperbolic"});
  const Json lengths = report["hyperbolic"]["boundary_lengths"];
  ASSERT_EQ(lengths.size(), 3);
  EXPECT_EQ(report["hyperbolic"]["generators"].size(), 0);
  std::vector<double> ascending;
  for (int n = 0; n < 3; ++n) ascending.push_back(lengths.at(n).number());
  std::sort(ascending.begin(), ascending.end());
  const Json signature = json({"signature", "p.obj"});
  const Json same = signature["conformal"]["boundary_lengths"];
  ASSERT_EQ(same.size(), 3);
  for (int n = 0; n < 3; ++n) EXPECT_NEAR(same.at(n).number(), ascending[n], 1e-9);
}

TEST_F(Hyperbolic, OtherSurfacesAreToldWhatTheyAre) {
  sample("s.obj", {"sphere", "resolution=3"});
  expectRefusal({"parameterize", "s.obj", "--to", "hyperbolic"}, "this surface is a sphere");
  expectRefusal({"parameterize", "s.obj", "--to", "hyperbolic"}, "--to sphere maps it");
  sample("t.obj", {"torus", "resolution=6"});
  expectRefusal({"parameterize", "t.obj", "--to", "hyperbolic"}, "--to flat maps it");
  sample("a.obj", {"annulus", "resolution=3"});
  expectRefusal({"parameterize", "a.obj", "--to", "hyperbolic"}, "--to circle-domain maps it");
  sample("g.obj", {"genus", "genus=2", "resolution=2"});
  write("cones.txt", "1 0.5\n");
  expectRefusal({"parameterize", "g.obj", "--to", "hyperbolic", "--cones", "cones.txt"},
                "cones are of FLAT and POLYCUBE maps, and the target is HYPERBOLIC");
  expectRefusal({"parameterize", "g.obj", "--to", "hyperbolic", "--scheme", "thurston"}, "scheme");
  EXPECT_THAT(run({"parameterize", "g.obj", "--to", "hyperbolic", "--scheme", "vertex-scaling",
                   "--solver", "newton", "--method", "auto"}),
              Succeeds());
  expectRefusal({"parameterize", "g.obj", "--to", "sphere"}, "--to hyperbolic maps it");
}

}  // namespace
}  // namespace moduli
