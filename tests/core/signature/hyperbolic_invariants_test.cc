#include "core/signature/hyperbolic_invariants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <string>

#include "core/intrinsic/intrinsic_samples.h"
#include "core/mesh/prepare.h"
#include "core/signature/compute.h"
#include "tests/core/hyperbolic/hexagon_pants.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

Signature sign(const TriangleSoup& soup, const SignatureOptions& options = {}) {
  Context context;
  const auto prepared = prepareMesh(context, soup, {});
  EXPECT_OK(prepared);
  auto signature = computeSignature(context, *prepared, options);
  EXPECT_OK(signature);
  return *std::move(signature);
}

struct KnownSurface {
  const char* kind;
  std::size_t systoles;
  double systole, next;
};

TEST(HyperbolicInvariants, OfBolzaAndKleinAreTheKnownOnes) {
  // CHECKS G1, G2. Edges are exact; lengths carry the rounding of words of some ten letters.
  const double eta = 2 * std::cos(2 * M_PI / 7);
  const KnownSurface known[] = {{"bolza", 12, 2 * std::acosh(1 + std::sqrt(2)), 0},
                                {"klein", 21, 8 * std::acosh((1 + eta) / 2), 5.208017}};
  for (const KnownSurface& one : known) {
    SCOPED_TRACE(one.kind);
    Context context;
    const auto surface = makeIntrinsicSample(one.kind);
    ASSERT_OK(surface);
    const auto signature = computeIntrinsicSignature(context, *surface);
    ASSERT_OK(signature);
    const std::vector<double>& lengths = signature->conformal->length_spectrum;
    ASSERT_GE(lengths.size(), one.systoles);
    for (std::size_t n = 0; n < one.systoles; ++n) EXPECT_NEAR(lengths[n], one.systole, 1e-9);
    if (lengths.size() > one.systoles) {
      EXPECT_GT(lengths[one.systoles], one.systole + 0.1);
      EXPECT_NEAR(lengths[one.systoles], one.next, 1e-6);
    }
    EXPECT_GE(*signature->certificate.spectrum_complete_to, 1.5 * one.systole - 1e-9);
    EXPECT_LT(*signature->certificate.relation_residual, 1e-10);
    EXPECT_EQ(signature->conformal->generators.size(),
              2 * static_cast<std::size_t>(signature->topology.genus));
  }
}

TEST(HyperbolicInvariants, DoNotDependOnNumbersPlaceAndScale) {
  const TriangleSoup soup = surfaces::sample("genus", {{"genus", 2}, {"resolution", 6}});
  const Signature first = sign(soup);
  const std::vector<double>& lengths = first.conformal->length_spectrum;
  ASSERT_FALSE(lengths.empty());
  EXPECT_TRUE(std::is_sorted(lengths.begin(), lengths.end()));
  for (const TriangleSoup& same : {surfaces::renumbered(soup, 3), surfaces::moved(soup, 50)}) {
    const Signature second = sign(same);
    ASSERT_EQ(second.conformal->length_spectrum.size(), lengths.size());
    for (std::size_t n = 0; n < lengths.size(); ++n) {
      EXPECT_NEAR(second.conformal->length_spectrum[n], lengths[n], 1e-8);
    }
  }
}

TEST(HyperbolicInvariants, AreThoseOfTheInvertedSurface) {
  // From the surface's own edges, space inversion keeps the discrete conformal class exactly.
  TriangleSoup soup = surfaces::sample("genus", {{"genus", 2}, {"resolution", 6}});
  SignatureOptions options;
  options.initial_delaunay = false;
  const Signature first = sign(soup, options);
  const Eigen::Vector3d center(11, -7, 9);
  for (Eigen::Vector3d& p : soup.vertices) p = center + (p - center) / (p - center).squaredNorm();
  const Signature second = sign(surfaces::reversed(soup), options);
  const std::vector<double>& lengths = first.conformal->length_spectrum;
  ASSERT_FALSE(lengths.empty());
  ASSERT_EQ(second.conformal->length_spectrum.size(), lengths.size());
  for (std::size_t n = 0; n < lengths.size(); ++n) {
    EXPECT_NEAR(second.conformal->length_spectrum[n], lengths[n], 1e-6);
  }
}

TEST(HyperbolicInvariants, BoundaryLengthsAreTheCuffsOfPants) {
  // Hexagons are exact to some 1e-15, Newton's method ends at curvatures of 1e-13 or less.
  for (const std::array<double, 3>& cuffs :
       {std::array{2.0, 2.4, 3.0}, {1.5, 1.5, 1.5}, {3.5, 3.0, 2.5}}) {
    Context context;
    const auto signature = computeIntrinsicSignature(context, hexagonPants(cuffs));
    ASSERT_OK(signature);
    std::array<double, 3> expected = cuffs;
    std::sort(expected.begin(), expected.end());
    const std::vector<double>& lengths = signature->conformal->boundary_lengths;
    ASSERT_EQ(lengths.size(), 3U);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(lengths[k], expected[k], 1e-12);
    // In the double they are closed geodesics like the others, among them twice the seams.
    const std::vector<double>& spectrum = signature->conformal->length_spectrum;
    const double complete_to = *signature->certificate.spectrum_complete_to;
    const std::array<double, 3> seams = *pantsSeams(cuffs);
    for (int k = 0; k < 3; ++k) {
      for (const double length : {cuffs[k], 2 * seams[k]}) {
        if (length > complete_to - 1e-9) continue;
        EXPECT_TRUE(std::any_of(spectrum.begin(), spectrum.end(), [&](double other) {
          return std::abs(other - length) < 1e-9;
        })) << length;
      }
    }
  }
}

TEST(HyperbolicInvariants, ClosedSurfacesHaveNoBoundaryLengths) {
  const Signature signature = sign(surfaces::sample("genus", {{"genus", 2}, {"resolution", 4}}));
  EXPECT_TRUE(signature.conformal->boundary_lengths.empty());
}

Signature signUpTo(const IntrinsicSurface& surface, double length) {
  Context context;
  SignatureOptions options;
  options.spectrum_length = length;
  auto signature = computeIntrinsicSignature(context, surface, options);
  EXPECT_OK(signature);
  return *std::move(signature);
}

bool warns(const Signature& signature, const std::string& code) {
  const std::vector<std::string>& warnings = signature.certificate.warnings;
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& text) { return text.starts_with(code + ": "); });
}

TEST(HyperbolicInvariants, GoUpToTheLengthThatIsAskedFor) {
  const IntrinsicSurface bolza = *makeIntrinsicSample("bolza");
  const Signature longer = signUpTo(bolza, 7);
  EXPECT_EQ(*longer.certificate.spectrum_complete_to, 7);
  const std::vector<double>& all = longer.conformal->length_spectrum;
  // Traces of Bolza's group: lengths 2 acosh(m + n sqrt 2), the next after the 12 systoles
  // m + n sqrt 2 = 3 + 2 sqrt 2 (Aurich, Bogomolny and Steiner 1991), 4.90.
  ASSERT_GT(all.size(), 12U);
  EXPECT_NEAR(all[11], 2 * std::acosh(1 + std::sqrt(2)), 1e-9);
  EXPECT_NEAR(all[12], 2 * std::acosh(3 + 2 * std::sqrt(2)), 1e-9);
  for (const double length : {2.0, 3.0, 4.0, 5.5}) {
    SCOPED_TRACE(length);
    const Signature shorter = signUpTo(bolza, length);
    EXPECT_EQ(*shorter.certificate.spectrum_complete_to, length);
    EXPECT_FALSE(warns(shorter, "SPECTRUM_LIMITED"));
    const std::vector<double>& some = shorter.conformal->length_spectrum;
    const auto end = std::upper_bound(all.begin(), all.end(), length);
    ASSERT_EQ(some.size(), static_cast<std::size_t>(end - all.begin()));
    for (std::size_t i = 0; i < some.size(); ++i) EXPECT_NEAR(some[i], all[i], 1e-9);
  }
}

TEST(HyperbolicInvariants, SayHowFarTheyGoWhereTheLengthIsTooMuch) {
  const IntrinsicSurface bolza = *makeIntrinsicSample("bolza");
  const Signature limited = signUpTo(bolza, 30);
  const double complete_to = *limited.certificate.spectrum_complete_to;
  EXPECT_TRUE(warns(limited, "SPECTRUM_LIMITED"));
  EXPECT_LT(complete_to, 30);
  EXPECT_GT(complete_to, 6);
  const std::vector<double>& lengths = limited.conformal->length_spectrum;
  ASSERT_FALSE(lengths.empty());
  EXPECT_LE(lengths.back(), complete_to * (1 + 1e-9));
  // What it says is true: a search that ends there finds as many.
  const Signature again = signUpTo(bolza, complete_to * 0.9);
  EXPECT_FALSE(warns(again, "SPECTRUM_LIMITED"));
  const auto end = std::upper_bound(lengths.begin(), lengths.end(), complete_to * 0.9);
  EXPECT_EQ(again.conformal->length_spectrum.size(),
            static_cast<std::size_t>(end - lengths.begin()));
  std::cout << lengths.size() << " geodesics up to " << complete_to << "\n";
}

TEST(HyperbolicInvariants, OfRealSurfacesHaveSoundRelations) {
  int seen = 0;
  for (const char* folder : {"genus2", "genus3plus"}) {
    const std::vector<std::string> paths = sharedMeshes(folder);
    if (paths.empty()) GTEST_SKIP() << "no meshes in " << folder << "; set MODULI_SHARED";
    for (const std::string& path : paths) {
      SCOPED_TRACE(path);
      SignatureOptions options;
      options.space = Space::kConformal;
      const Signature signature = sign(surfaces::read(path), options);
      ASSERT_TRUE(signature.certificate.relation_residual);
      EXPECT_LT(*signature.certificate.relation_residual, 1e-8);
      ++seen;
    }
  }
  EXPECT_GE(seen, 10);
}

}  // namespace
}  // namespace moduli
