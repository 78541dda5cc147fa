#include "core/signature/conformal_bounds.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "core/intrinsic/intrinsic_samples.h"
#include "core/signature/distance.h"
#include "tests/core/hyperbolic/hexagon_pants.h"
#include "tests/core/signature/stretched_surfaces.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

Signature sign(const TriangleSoup& soup, bool initial_delaunay = true) {
  Context context;
  const auto prepared = prepareMesh(context, soup, {});
  EXPECT_OK(prepared);
  SignatureOptions options;
  options.space = Space::kConformal;
  options.initial_delaunay = initial_delaunay;
  auto signature = computeSignature(context, *prepared, options);
  EXPECT_OK(signature);
  return *std::move(signature);
}

Signature sign(const IntrinsicSurface& surface) {
  Context context;
  auto signature = computeIntrinsicSignature(context, surface);
  EXPECT_OK(signature);
  return *std::move(signature);
}

double bound(const KnownNumbers& a, const KnownNumbers& b) {
  const std::optional<double> forth = spectrumBound(a, b);
  EXPECT_EQ(forth, spectrumBound(b, a));
  EXPECT_TRUE(forth);
  return forth.value_or(-1);
}

TEST(SpectrumBound, IsHalfTheLogOfTheLargestRatio) {
  const std::vector<double> a = {1, 2, 3}, b = {1.1, 2, 2.4};
  EXPECT_EQ(bound({a, 3}, {a, 3}), 0);
  EXPECT_DOUBLE_EQ(bound({a, 3}, {b, 3}), std::log(3 / 2.4) / 2);
}

TEST(SpectrumBound, ReachesOneNumberBeyondTheShorterList) {
  const std::vector<double> one = {1}, more = {1, 2, 3}, none;
  // The second number of the first is beyond 5, that of the other is 2.
  EXPECT_DOUBLE_EQ(bound({one, 5}, {more, 3}), std::log(5 / 2.0) / 2);
  // Beyond 1.5 it may be 2 as well.
  EXPECT_EQ(bound({one, 1.5}, {more, 3}), 0);
  EXPECT_DOUBLE_EQ(bound({none, 4}, {more, 3}), std::log(4.0) / 2);
  EXPECT_EQ(bound({none, 0.5}, {more, 3}), 0);
  EXPECT_FALSE(spectrumBound({none, 4}, {none, 2}));
}

TEST(SpectrumBound, IsAtMostTheDilatationWhateverIsKnownOfTwoSpectra) {
  // Numbers of corresponding classes differ by factors between 1 / K and K, and each list knows its
  // own up to another length.
  std::mt19937 random(1);
  double largest = 0;
  for (int round = 0; round < 2000; ++round) {
    const double logarithm = 2 * uniform(random);
    std::vector<double> a, b;
    for (int n = 0; n < 30; ++n) {
      a.push_back(std::exp(2 * uniform(random)));
      b.push_back(a.back() * std::exp(logarithm * (2 * uniform(random) - 1)));
    }
    const auto known = [&](std::vector<double>& numbers) {
      std::sort(numbers.begin(), numbers.end());
      const double complete_to = std::exp(3 * uniform(random) - 0.5);
      numbers.erase(std::upper_bound(numbers.begin(), numbers.end(), complete_to), numbers.end());
      return complete_to;
    };
    const double a_complete_to = known(a), b_complete_to = known(b);
    if (a.empty() && b.empty()) continue;
    const double found = bound({a, a_complete_to}, {b, b_complete_to});
    ASSERT_LE(found, logarithm / 2 + 1e-12) << "round " << round;
    if (logarithm > 0) largest = std::max(largest, found / (logarithm / 2));
  }
  EXPECT_GT(largest, 0.8) << "some of them should be told nearly in full";
}

struct Family {
  std::string name;
  MetricSurface (*at)(double);
  int parts;
};

const std::vector<Family>& families() {
  static const std::vector<Family> all = {
      {"L", stretchedL, 8},
      {"octagon", [](double t) { return stretchedPolygon(8, std::numbers::pi / 8, t); }, 8},
      {"decagon", [](double t) { return stretchedPolygon(10, 0.1, t); }, 8}};
  return all;
}

/// Energies: the stretching carries forms that are linear on faces to such forms, and their
/// energies by a factor of at most K, so that the bound holds for meshes too: energies of meshes
/// are geometric means of their upper and lower bounds, and both these matrices are within K of
/// those of the other mesh. Only rounding is left. Lengths: their bound differs by less than 0.01 t
/// from that of meshes twice as fine, and stays below 0.8 t.
TEST(ConformalBounds, AreAtMostTheDistanceOfStretchedTranslationSurfaces) {
  for (const Family& family : families()) {
    const Signature first = signatureOf(subdivide(family.at(0), family.parts));
    for (const double t : {0.05, 0.2, 0.5, 1.0}) {
      SCOPED_TRACE(family.name + " " + std::to_string(t));
      const Signature second = signatureOf(subdivide(family.at(t), family.parts));
      const ConformalBounds bounds = conformalBounds(first, second);
      ASSERT_TRUE(bounds.energies && bounds.lengths);
      EXPECT_FALSE(bounds.boundary);
      EXPECT_LE(*bounds.energies, t + 1e-10);
      EXPECT_LE(*bounds.lengths, t);
      EXPECT_GT(*bounds.energies, 0.4 * t);
      EXPECT_GT(*bounds.lengths, 0.35 * t);
      EXPECT_EQ(signatureDistance(first, second, Space::kConformal), bounds.largest());
      EXPECT_EQ(signatureDistance(second, first, Space::kConformal), bounds.largest());
      std::cout << family.name << " t = " << t << ": energies " << *bounds.energies / t
                << " t, lengths " << *bounds.lengths / t << " t\n";
    }
  }
}

TEST(ConformalBounds, AttainTheDistanceWhereTheStretchedClassIsInteger) {
  // dx on the three squares is an integer class among the 32 shortest ones, and its energy
  // 3 e^{2 t} is exact on any mesh.
  const Signature first = signatureOf(subdivide(stretchedL(0), 4));
  const Signature second = signatureOf(subdivide(stretchedL(0.05), 4));
  EXPECT_NEAR(*signatureDistance(first, second, Space::kConformal), 0.05, 1e-10);
}

TEST(ConformalBounds, TellTheKnownSurfacesApartAndNotFromThemselves) {
  const double klein_systole = 8 * std::acosh((1 + 2 * std::cos(2 * M_PI / 7)) / 2);
  const Signature bolza = sign(*makeIntrinsicSample("bolza"));
  const Signature klein = sign(*makeIntrinsicSample("klein"));
  EXPECT_EQ(signatureDistance(bolza, bolza, Space::kConformal), 0.0);
  EXPECT_EQ(signatureDistance(klein, klein, Space::kConformal), 0.0);
  EXPECT_FALSE(signatureDistance(bolza, klein, Space::kConformal)) << "other genus";
  EXPECT_NEAR(klein.conformal->length_spectrum[0], klein_systole, 1e-9);
  // The octagon and the cover of the octahedron are Bolza's surface (CHECKS D2, D3, G8); their
  // energies are exact by symmetry, and so is the hyperbolic metric with cones at the vertices of
  // the {3, 8} triangulation, while on subdivided faces it is one of a mesh.
  const Signature octahedron = signatureOf(octahedronCover());
  const ConformalBounds same = conformalBounds(bolza, octahedron);
  EXPECT_LT(*same.energies, 1e-10);
  EXPECT_LT(*same.lengths, 1e-9);
  // Against y^2 = x^5 - 1: energies sqrt 2 and 2 cot(pi / 5) / sqrt 5, exact again (CHECKS D5).
  const Signature decagon = signatureOf(gluedPolygon(10));
  const double ratio = std::sqrt(2) / (2 / std::tan(M_PI / 5) / std::sqrt(5));
  EXPECT_GE(*signatureDistance(bolza, decagon, Space::kConformal), std::log(ratio) / 2 - 1e-6);
}

TEST(ConformalBounds, OfPantsAreThoseOfTheirCuffs) {
  const Signature first = sign(hexagonPants({2.0, 2.4, 3.0}));
  const Signature second = sign(hexagonPants({3.3, 2.1, 2.4}));
  const ConformalBounds bounds = conformalBounds(first, second);
  ASSERT_TRUE(bounds.boundary && bounds.lengths && bounds.energies);
  // In ascending order 2.0, 2.4, 3.0 and 2.1, 2.4, 3.3.
  EXPECT_NEAR(*bounds.boundary, std::log(1.1) / 2, 1e-12);
  EXPECT_GE(*bounds.lengths, std::log(1.05) / 2 - 1e-12) << "the shortest ones are these cuffs";
  EXPECT_GE(*signatureDistance(first, second, Space::kConformal), *bounds.boundary);
}

/// Second order in the edges: of meshes half as fine four times as much.
TEST(ConformalBounds, OfOneSurfaceMeshedTwiceVanishAtSecondOrder) {
  std::vector<Signature> signatures;
  for (const double resolution : {4, 8, 16}) {
    signatures.push_back(
        sign(surfaces::sample("genus", {{"genus", 2}, {"resolution", resolution}})));
  }
  const ConformalBounds coarse = conformalBounds(signatures[0], signatures[1]);
  const ConformalBounds fine = conformalBounds(signatures[1], signatures[2]);
  std::cout << "1600 and 6400 faces: energies " << *coarse.energies << ", lengths "
            << *coarse.lengths << "; 6400 and 25600: " << *fine.energies << ", " << *fine.lengths
            << "\n";
  // Measured 3.7 and 4.0; half an order is allowed to what is not yet asymptotic.
  EXPECT_LT(*fine.energies, *coarse.energies / 2.8);
  EXPECT_LT(*fine.lengths, *coarse.lengths / 2.8);
  EXPECT_LT(*coarse.largest(), 0.002);
  // The polyhedral surfaces differ by about as much as their energies' errors, which is less than
  // the bounds of these.
  const double certified = std::log1p(*signatures[0].conformal->energy_spectrum_error) / 2 +
                           std::log1p(*signatures[1].conformal->energy_spectrum_error) / 2;
  EXPECT_LT(*coarse.energies, certified);
}

TEST(ConformalBounds, AreZeroToMirrorImagesMovedAndRenumberedSurfaces) {
  const TriangleSoup soup =
      surfaces::sample("genus", {{"genus", 2}, {"resolution", 4}, {"seed", 3}});
  const Signature first = sign(soup);
  ASSERT_FALSE(first.conformal->length_spectrum.empty());
  TriangleSoup mirrored = surfaces::reversed(soup);
  for (Eigen::Vector3d& p : mirrored.vertices) p.x() = -p.x();
  for (const TriangleSoup& same : {surfaces::renumbered(soup, 3), surfaces::moved(soup, 1e-3),
                                   surfaces::moved(soup, 50), surfaces::reversed(soup), mirrored}) {
    const Signature second = sign(same);
    const ConformalBounds bounds = conformalBounds(first, second);
    EXPECT_LT(*bounds.energies, 1e-9);
    EXPECT_LT(*bounds.lengths, 1e-8);
    const std::vector<float>&x = first.vectors.conformal, &y = second.vectors.conformal;
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], y[i], 1e-6);  // Floats.
  }
}

TEST(ConformalBounds, OfTheInvertedSurfaceVanish) {
  // From the surface's own edges space inversion keeps lengths exactly; energies are those of
  // another polyhedral surface, second order away (as meshed twice).
  const TriangleSoup soup = surfaces::sample("genus", {{"genus", 2}, {"resolution", 8}});
  TriangleSoup inverted = surfaces::reversed(soup);
  const Eigen::Vector3d center(11, -7, 9);
  for (Eigen::Vector3d& p : inverted.vertices) {
    p = center + (p - center) / (p - center).squaredNorm();
  }
  const ConformalBounds bounds = conformalBounds(sign(soup, false), sign(inverted, false));
  EXPECT_LT(*bounds.lengths, 1e-6);
  EXPECT_LT(*bounds.energies, 1e-3);
}

TEST(ConformalBounds, UseWhatBothSurfacesKnow) {
  const Signature first = signatureOf(subdivide(stretchedL(0), 4));
  const Signature second = signatureOf(subdivide(stretchedL(0.3), 4));
  const ConformalBounds bounds = conformalBounds(first, second);
  Signature without = second;
  without.conformal->length_spectrum.clear();
  without.certificate.spectrum_complete_to.reset();
  EXPECT_FALSE(conformalBounds(first, without).lengths);
  EXPECT_EQ(signatureDistance(first, without, Space::kConformal), bounds.energies);
  Signature lengths_only = second;
  lengths_only.conformal->energy_spectrum.clear();
  EXPECT_EQ(signatureDistance(first, lengths_only, Space::kConformal), bounds.lengths);
  EXPECT_FALSE(signatureDistance(without, lengths_only, Space::kConformal));
}

TEST(ConformalBounds, OfRealMeshesOfOneShapeAreSmallAndOfOthersLarge) {
  MODULI_NEED_SHARED_MESH(fine, "genus2/ceaedf__eight.off");
  MODULI_NEED_SHARED_MESH(coarse, "genus2/cfwen__eight.off");
  MODULI_NEED_SHARED_MESH(cup, "genus2/ceaedf__cup_input_simple_10000.off");
  const Signature eight = sign(surfaces::read(fine));
  const Signature other_eight = sign(surfaces::read(coarse));
  const Signature third = sign(surfaces::read(cup));
  // Two eights that are modelled a little differently.
  EXPECT_LT(*signatureDistance(eight, other_eight, Space::kConformal), 0.02);
  EXPECT_GT(*signatureDistance(eight, third, Space::kConformal), 0.2);
  EXPECT_GT(*conformalBounds(eight, third).lengths, 0.2);
}

}  // namespace
}  // namespace moduli
