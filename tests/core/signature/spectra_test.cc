#include "core/signature/spectra.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/signature/spherical_harmonics.h"
#include "tests/core/mesh/shapes.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// A field with power 1 at degree 3, 4 at degree 7, and another one that shares degree 3 with it.
VertexFields bandLimited(const Points3& points) {
  const SphericalHarmonics harmonics(8);
  VertexFields fields(2);
  for (const Eigen::Vector3d& p : points) {
    const Eigen::VectorXd y = harmonics.evaluate(p);
    const double third =
        0.6 * y[SphericalHarmonics::index(3, 2)] + 0.8 * y[SphericalHarmonics::index(3, -1)];
    fields[0].push_back(5 + third + 2 * y[SphericalHarmonics::index(7, 5)]);
    fields[1].push_back(-0.5 * third + y[SphericalHarmonics::index(5, 0)]);
  }
  return fields;
}

FieldSpectra onSphere(const TriangleMesh& mesh, const Points3& points, const VertexFields& fields) {
  Context context;
  auto spectra = sphereSpectra(context, mesh.connectivity(), points, fields);
  EXPECT_OK(spectra);
  return *spectra;
}

TEST(SphereSpectra, FindBandLimitedFieldsAtTheirDegrees) {
  double previous = 0;
  for (const double resolution : {12.0, 24.0, 48.0}) {
    const TriangleMesh mesh =
        surfaces::mesh(surfaces::sample("sphere", {{"resolution", resolution}, {"seed", 2}}));
    const FieldSpectra spectra = onSphere(mesh, mesh.positions(), bandLimited(mesh.positions()));
    ASSERT_EQ(spectra.first.size(), kSpectrumBins);
    double error = 0;
    for (int l = 1; l <= kSpectrumBins; ++l) {
      const double first = l == 3 ? 1 : l == 7 ? 4 : 0;
      const double second = l == 3 ? 0.25 : l == 5 ? 1 : 0;
      const double cross = l == 3 ? -0.5 : 0;
      error = std::max({error, std::abs(spectra.first[l - 1] - first),
                        std::abs(spectra.second[l - 1] - second),
                        std::abs(spectra.cross[l - 1] - cross)});
    }
    // What is left is the interpolation of the fields: second order in the edge length.
    if (previous > 0) {
      EXPECT_GT(previous / error, 3);
    }
    previous = error;
  }
  EXPECT_LT(previous, 0.02);
}

TEST(SphereSpectra, ObeyParseval) {
  const TriangleMesh mesh = surfaces::mesh(surfaces::sample("sphere", {{"resolution", 40}}));
  const FieldSpectra spectra = onSphere(mesh, mesh.positions(), bandLimited(mesh.positions()));
  // Integrals of the squares are 1 + 4 and 1/4 + 1; the constant 5 is no part of a spectrum. The
  // interpolation loses (7 h)^2 / 6 of the power at degree 7, with edges h of 0.03.
  EXPECT_NEAR(sum(spectra.first), 5, 0.03 * 5);
  EXPECT_NEAR(sum(spectra.second), 1.25, 0.02 * 1.25);
}

TEST(SphereSpectra, DoNotChangeUnderRotations) {
  const TriangleMesh mesh =
      surfaces::mesh(surfaces::sample("sphere", {{"resolution", 10}, {"seed", 1}}));
  const VertexFields fields = bandLimited(mesh.positions());
  const FieldSpectra a = onSphere(mesh, mesh.positions(), fields);
  Points3 turned = mesh.positions();
  const Eigen::Matrix3d turn = surfaces::rotation(11);
  for (Eigen::Vector3d& p : turned) p = turn * p;
  const FieldSpectra b = onSphere(mesh, turned, fields);
  for (int l = 0; l < kSpectrumBins; ++l) {
    EXPECT_NEAR(a.first[l], b.first[l], 1e-12);
    EXPECT_NEAR(a.second[l], b.second[l], 1e-12);
    EXPECT_NEAR(a.cross[l], b.cross[l], 1e-12);
  }
}

TEST(SphereSpectra, RefineLargeFacesSoThatCoarseMeshesLoseNothing) {
  // One linear function per face of an icosahedron, seen through a mesh of the same points cut
  // finer: the fields are the same up to how "linear" bends on the sphere.
  const TriangleMesh coarse = surfaces::mesh(surfaces::sample("sphere", {{"resolution", 1}}));
  VertexFields fields(1);
  for (const Eigen::Vector3d& p : coarse.positions()) fields[0].push_back(p.z());
  const FieldSpectra spectra = onSphere(coarse, coarse.positions(), fields);
  // z / |chord point| has its power at degree 1; the faces of an icosahedron lie at 0.8 to 1 of the
  // radius, and z is linear, so that the field is z times that distance.
  EXPECT_GT(spectra.first[0], 0.80 * 0.80 * 4 * std::numbers::pi / 3);
  EXPECT_LT(spectra.first[0], 4 * std::numbers::pi / 3);
  EXPECT_LT(sum(spectra.first) - spectra.first[0], 0.02);
}

TEST(SphereSpectra, GiveNoWeightToFacesWithoutArea) {
  // A vertex whose star has shrunk to a point of the sphere may hold any finite value.
  TriangleSoup soup = surfaces::sample("sphere", {{"resolution", 8}});
  const Triangle face = soup.faces[17];
  const auto inner = static_cast<Index>(soup.vertices.size());
  soup.vertices.push_back(soup.vertices[face[0]]);
  soup.faces[17] = {face[0], face[1], inner};
  soup.faces.push_back({face[1], face[2], inner});
  soup.faces.push_back({face[2], face[0], inner});
  // Both faces at edge (face[0], inner) are without area; the third is the old face.
  const TriangleMesh mesh = surfaces::mesh(soup);
  VertexFields fields = bandLimited(mesh.positions());
  const FieldSpectra a = onSphere(mesh, mesh.positions(), fields);
  EXPECT_TRUE(std::isfinite(sum(a.first)));
}

/// The fundamental domain as an n x n grid, each square cut in two; corners in C / (Z + tau Z).
struct FlatTorus {
  TriangleMesh mesh;
  std::vector<Complex> corners;
};

FlatTorus flatTorus(Index n, Complex tau) {
  TriangleMesh mesh = surfaces::mesh(shapes::torusGrid(n, n));
  std::vector<Complex> corners(mesh.connectivity().halfedgeCount());
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    // Grid steps that stay within one cell, as shapes::torusGrid numbers vertices i n + j.
    const Index base = mesh.connectivity().face(f)[0];
    for (Index c = 0; c < 3; ++c) {
      const Index v = mesh.connectivity().face(f)[c];
      const Index di = (v / n - base / n + n) % n;
      const Index dj = (v % n - base % n + n) % n;
      corners[3 * f + c] =
          (static_cast<double>(base / n + di) + static_cast<double>(base % n + dj) * tau) /
          static_cast<double>(n);
    }
  }
  return {std::move(mesh), std::move(corners)};
}

FieldSpectra onTorus(const FlatTorus& torus, Complex tau, const VertexFields& fields) {
  Context context;
  auto spectra = torusSpectra(context, torus.mesh.connectivity(), torus.corners, tau, fields);
  EXPECT_OK(spectra);
  return *spectra;
}

/// cos of the wave (a, b), per vertex i n + j at (i + j tau) / n.
std::vector<double> wave(Index n, int a, int b) {
  std::vector<double> values;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      values.push_back(std::cos(2 * std::numbers::pi * (a * i + b * j) / n));
    }
  }
  return values;
}

TEST(TorusSpectra, ShareAWaveBetweenTheFrequenciesNextToIt) {
  const Complex tau(0.3, 1.2);
  const Index n = 96;
  const FlatTorus torus = flatTorus(n, tau);
  VertexFields fields = {wave(n, 2, 1), wave(n, 2, 1)};
  for (double& value : fields[1]) value *= -3;
  const FieldSpectra spectra = onTorus(torus, tau, fields);
  // mu = pi |b - a tau|^2 / Im tau, integral of cos^2 over area 4 pi is 2 pi.
  const double mu = std::numbers::pi * std::norm(1.0 - 2.0 * tau) / tau.imag();
  const double d = std::sqrt(mu + 0.25) - 0.5;
  const int below = static_cast<int>(d);
  // The interpolation loses a fraction mu h^2 / 6, below 1 percent.
  EXPECT_NEAR(spectra.first[below - 1], (below + 1 - d) * 2 * std::numbers::pi, 0.05);
  EXPECT_NEAR(spectra.first[below], (d - below) * 2 * std::numbers::pi, 0.05);
  EXPECT_NEAR(sum(spectra.first), 2 * std::numbers::pi, 0.07);
  for (int l = 0; l < kSpectrumBins; ++l) {
    EXPECT_NEAR(spectra.second[l], 9 * spectra.first[l], 1e-12);
    EXPECT_NEAR(spectra.cross[l], -3 * spectra.first[l], 1e-12);
  }
}

TEST(TorusSpectra, DoNotChangeUnderTheModularGroupAndTranslations) {
  const Complex tau(0.3, 1.2);
  const Index n = 24;
  const FlatTorus torus = flatTorus(n, tau);
  VertexFields fields = {wave(n, 1, 2), wave(n, 3, -1)};
  for (std::size_t i = 0; i < fields[0].size(); ++i) {
    fields[0][i] += 0.3 * std::sin(static_cast<double>(i * i % 97));
    fields[1][i] *= fields[0][i];
  }
  const FieldSpectra plain = onTorus(torus, tau, fields);

  FlatTorus inverted = torus;  // Z + tau Z divided by tau is Z + (-1 / tau) Z.
  for (Complex& z : inverted.corners) z = z / tau + Complex(0.2, -0.7);
  for (const FieldSpectra& same :
       {onTorus(torus, tau + 1.0, fields), onTorus(torus, tau - 2.0, fields),
        onTorus(inverted, -1.0 / tau, fields)}) {
    for (int l = 0; l < kSpectrumBins; ++l) {
      EXPECT_NEAR(same.first[l], plain.first[l], 1e-11);
      EXPECT_NEAR(same.second[l], plain.second[l], 1e-11);
      EXPECT_NEAR(same.cross[l], plain.cross[l], 1e-11);
    }
  }
}

TEST(TorusSpectra, ObeyParsevalOnLongTori) {
  const Complex tau(0, 40);
  const Index n = 60;
  const FlatTorus torus = flatTorus(n, tau);
  const FieldSpectra spectra = onTorus(torus, tau, {wave(n, 0, 1)});
  // The longest wave has frequency below 1; all of it counts for frequency 1.
  EXPECT_NEAR(spectra.first[0], 2 * std::numbers::pi, 0.02);
  EXPECT_LT(sum(spectra.first) - spectra.first[0], 1e-4);
}

TEST(Spectra, StopWhenCancelled) {
  const TriangleMesh mesh = surfaces::mesh(surfaces::sample("sphere", {{"resolution", 8}}));
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(
      sphereSpectra(context, mesh.connectivity(), mesh.positions(), bandLimited(mesh.positions())),
      FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
