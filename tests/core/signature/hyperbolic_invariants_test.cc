#include "core/signature/hyperbolic_invariants.h"

#include <algorithm>
#include <cmath>

#include "core/intrinsic/intrinsic_samples.h"
#include "core/mesh/prepare.h"
#include "core/signature/compute.h"
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
