#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/signature/compute.h"
#include "core/signature/conformal_block.h"
#include "core/signature/distance.h"
#include "core/signature/spectra.h"
#include "tests/core/mesh/shapes.h"
#include "tests/core/signature/closed_forms.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

PreparedMesh prepare(const TriangleSoup& soup) {
  Context context;
  auto prepared = prepareMesh(context, soup, {});
  EXPECT_OK(prepared);
  return *std::move(prepared);
}

Result<Signature> tryToSign(const TriangleSoup& soup, std::optional<Space> space = {}) {
  Context context;
  return computeSignature(context, prepare(soup), {space});
}

Signature sign(const TriangleSoup& soup, std::optional<Space> space = {}) {
  auto signature = tryToSign(soup, space);
  EXPECT_OK(signature);
  return *std::move(signature);
}

TriangleSoup withoutFace(TriangleSoup soup) {
  soup.faces.pop_back();
  return soup;
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Powers agree to `relative` of the whole spectrum; cross spectra to that of both together.
void expectSameSpectra(const Signature& a, const Signature& b, double relative,
                       double cross_sign = 1) {
  const double metric = sum(a.metric->conformal_factor_spectrum);
  const double shape = sum(a.shape->mean_curvature_spectrum);
  for (int l = 0; l < kSpectrumBins; ++l) {
    EXPECT_NEAR(a.metric->conformal_factor_spectrum[l], b.metric->conformal_factor_spectrum[l],
                relative * metric);
    EXPECT_NEAR(a.shape->mean_curvature_spectrum[l], b.shape->mean_curvature_spectrum[l],
                relative * shape);
    EXPECT_NEAR(a.shape->cross_spectrum[l], cross_sign * b.shape->cross_spectrum[l],
                relative * std::sqrt(metric * shape));
  }
}

TEST(SphereSignature, OfARoundSphereIsNearlyNothing) {
  double previous = 0;
  for (const double resolution : {8.0, 16.0}) {
    const Signature signature =
        sign(surfaces::sample("sphere", {{"radius", 7}, {"resolution", resolution}}));
    const double factor = std::sqrt(sum(signature.metric->conformal_factor_spectrum));
    EXPECT_LT(factor, 0.01);
    EXPECT_LT(std::sqrt(sum(signature.shape->mean_curvature_spectrum)), 0.05);
    if (previous > 0) {
      EXPECT_GT(previous / factor, 3);
    }
    previous = factor;
  }
}

class SpheroidSignature : public testing::TestWithParam<double> {};

TEST_P(SpheroidSignature, ConvergesToTheClosedForm) {
  const double c = GetParam();
  const FieldSpectra exact = closed_forms::spheroidSpectra(c);
  std::vector<double> factor, curvature;
  for (const double resolution : {8.0, 16.0, 32.0}) {
    const Signature signature =
        sign(surfaces::sample("spheroid", {{"a", 1}, {"c", c}, {"resolution", resolution}}));
    factor.push_back(
        closed_forms::amplitudeError(signature.metric->conformal_factor_spectrum, exact.first));
    curvature.push_back(
        closed_forms::amplitudeError(signature.shape->mean_curvature_spectrum, exact.second));
    if (resolution == 32) {
      // Sign and size of the cross spectrum where it matters.
      EXPECT_NEAR(signature.shape->cross_spectrum[1], exact.cross[1],
                  0.02 * std::abs(exact.cross[1]));
    }
  }
  // The limit is 16 for both; see the order of the positions.
  EXPECT_GT(factor[0] / factor[2], 10) << factor[0] << ' ' << factor[1] << ' ' << factor[2];
  EXPECT_GT(curvature[0] / curvature[2], 10)
      << curvature[0] << ' ' << curvature[1] << ' ' << curvature[2];
  EXPECT_LT(factor[2], 3e-3);
  EXPECT_LT(curvature[2], 5e-3);
}

TEST_P(SpheroidSignature, ForgetsTheTriangulation) {
  const double c = GetParam();
  std::vector<double> metric, shape;
  for (const double resolution : {8.0, 32.0}) {
    const std::map<std::string, double> regular = {{"a", 1}, {"c", c}, {"resolution", resolution}};
    std::map<std::string, double> irregular = regular;
    irregular["seed"] = 5;
    const SignatureDistances d = signatureDistances(sign(surfaces::sample("spheroid", regular)),
                                                    sign(surfaces::sample("spheroid", irregular)));
    metric.push_back(*d.metric);
    shape.push_back(*d.shape);
  }
  EXPECT_LT(metric[1], 0.01);
  EXPECT_LT(shape[1], 0.02);
  // Coarse meshes are refined before modes are found, so that their metric vectors are as near as
  // those of fine ones. Their places in space are what they are: less than the 16 of a second order
  // for curvatures, which are smoothed.
  EXPECT_LT(metric[0], 0.01);
  EXPECT_GT(shape[0] / shape[1], 3) << shape[0] << ' ' << shape[1];
}

INSTANTIATE_TEST_SUITE_P(OblateAndProlate, SpheroidSignature, testing::Values(0.5, 2.0));

TEST(TorusSignature, ConvergesToTheClosedForm) {
  const FieldSpectra exact = closed_forms::torusSpectra(2, 1);
  std::vector<double> factor, curvature;
  for (const double resolution : {16.0, 32.0, 64.0}) {
    const Signature signature =
        sign(surfaces::sample("torus", {{"R", 2}, {"r", 1}, {"resolution", resolution}}));
    factor.push_back(
        closed_forms::amplitudeError(signature.metric->conformal_factor_spectrum, exact.first));
    curvature.push_back(
        closed_forms::amplitudeError(signature.shape->mean_curvature_spectrum, exact.second));
    EXPECT_NEAR(signature.conformal->tau->imag(), std::sqrt(3.0),
                *signature.conformal->tau_error + 4.0 / (resolution * resolution));
  }
  for (const auto& errors : {factor, curvature}) {
    EXPECT_NEAR(errors[0] / errors[1], 4, 1) << errors[0] << ' ' << errors[1];
    EXPECT_NEAR(errors[1] / errors[2], 4, 1) << errors[1] << ' ' << errors[2];
    EXPECT_LT(errors[2], 4e-3);
  }
}

TEST(Signature, ReportsTopologyInInputUnits) {
  const Signature signature = sign(shapes::torusGrid(12, 8));
  EXPECT_EQ(signature.topology.vertices, 96);
  EXPECT_EQ(signature.topology.faces, 192);
  EXPECT_EQ(signature.topology.components, 1);
  EXPECT_EQ(signature.topology.genus, 1);
  EXPECT_EQ(signature.topology.boundary_loops, 0);
  EXPECT_EQ(signature.topology.euler_characteristic, 0);
  EXPECT_NEAR(signature.topology.area, 8 * std::numbers::pi * std::numbers::pi, 8);
  EXPECT_EQ(signature.descriptor_version, kDescriptorVersion);
  EXPECT_FALSE(signature.timing.empty());
}

TEST(Signature, ComputesOnlyTheSpaceThatIsAskedFor) {
  const TriangleSoup sphere = surfaces::sample("ellipsoid", {{"resolution", 4}});
  const Signature all = sign(sphere);

  const Signature conformal = sign(sphere, Space::kConformal);
  EXPECT_EQ(conformal.conformal->type, ConformalType::kSphere);
  EXPECT_FALSE(conformal.metric || conformal.shape);
  EXPECT_EQ(conformal.timing.count("sphere map"), 0U) << "all spheres are conformally one";
  EXPECT_EQ(conformal.vectors.conformal, std::vector<float>{0});
  EXPECT_TRUE(conformal.vectors.metric.empty() && conformal.vectors.shape.empty());

  const Signature metric = sign(sphere, Space::kMetric);
  EXPECT_FALSE(metric.conformal || metric.shape);
  EXPECT_EQ(metric.metric->conformal_factor_spectrum, all.metric->conformal_factor_spectrum);
  EXPECT_EQ(metric.vectors.metric, all.vectors.metric);

  const Signature shape = sign(sphere, Space::kShape);
  EXPECT_FALSE(shape.conformal || shape.metric);
  EXPECT_EQ(shape.shape->mean_curvature_spectrum, all.shape->mean_curvature_spectrum);
  EXPECT_EQ(shape.vectors.shape, all.vectors.shape);

  const Signature torus = sign(shapes::torusGrid(12, 8), Space::kConformal);
  EXPECT_TRUE(torus.conformal->tau && torus.conformal->tau_error);
  EXPECT_EQ(torus.timing.count("spectra"), 0U);
  EXPECT_EQ(torus.vectors.conformal.size(), 4U);
}

TEST(Signature, HasTheConformalBlockOfEveryTopology) {
  struct Case {
    TriangleSoup soup;
    ConformalType type;
    Index period_size;  // 0: none.
    bool spectrum;
  };
  const std::vector<Case> cases{
      {shapes::icosahedron(), ConformalType::kSphere, 0, false},
      {shapes::disk(), ConformalType::kDisk, 0, false},
      {shapes::annulus(), ConformalType::kAnnulus, 0, true},
      {shapes::torusGrid(6, 5), ConformalType::kTorus, 0, true},
      {shapes::chainOfTori(2), ConformalType::kHyperbolic, 2, true},
      {surfaces::sample("plate", {{"holes", 3}, {"resolution", 2}}), ConformalType::kCircleDomain,
       3, true},
      {withoutFace(shapes::chainOfTori(2)), ConformalType::kBordered, 4, true},
  };
  for (const Case& each : cases) {
    const Signature signature = sign(each.soup, Space::kConformal);
    ASSERT_TRUE(signature.conformal);
    const ConformalBlock& block = *signature.conformal;
    EXPECT_EQ(block.type, each.type);
    EXPECT_EQ(block.tau.has_value(), each.type == ConformalType::kTorus);
    EXPECT_EQ(block.modulus.has_value(), each.type == ConformalType::kAnnulus);
    EXPECT_EQ(block.period_matrix.has_value(), each.period_size > 0);
    EXPECT_EQ(block.period_error.has_value(), each.period_size > 0);
    if (block.period_matrix) {
      EXPECT_EQ(block.period_matrix->size, each.period_size);
      EXPECT_EQ(block.period_matrix->values.size(),
                static_cast<std::size_t>(each.period_size * each.period_size));
    }
    EXPECT_EQ(block.energy_spectrum.size(), each.spectrum ? kEnergySpectrumLength : 0);
    EXPECT_EQ(block.circles.size(), each.type == ConformalType::kCircleDomain ? 4 : 0);
    EXPECT_TRUE(std::is_sorted(block.energy_spectrum.begin(), block.energy_spectrum.end()));
    EXPECT_FALSE(signature.vectors.conformal.empty());
  }
}

TEST(Signature, EveryTopologyHasAllSpacesOfOneLength) {
  const TriangleSoup genus_two = shapes::chainOfTori(2);
  const Signature all = sign(genus_two);
  EXPECT_TRUE(all.conformal && all.metric && all.shape);
  EXPECT_EQ(all.metric->laplace_spectrum.size(), 50U);
  EXPECT_TRUE(all.metric->conformal_factor_spectrum.empty());
  EXPECT_LT(*all.certificate.mode_residual, 1e-6);
  EXPECT_EQ(all.conformal->energy_spectrum,
            sign(genus_two, Space::kConformal).conformal->energy_spectrum);
  const Signature metric = sign(genus_two, Space::kMetric);
  EXPECT_EQ(metric.vectors.metric, all.vectors.metric);
  EXPECT_FALSE(metric.conformal || metric.shape);
  const Signature shape = sign(genus_two, Space::kShape);
  EXPECT_EQ(shape.vectors.shape, all.vectors.shape);
  for (const char* kind : {"sphere", "torus", "annulus", "disk", "plate"}) {
    const Signature other = sign(surfaces::sample(kind, {{"resolution", 6}}));
    EXPECT_EQ(other.vectors.metric.size(), all.vectors.metric.size()) << kind;
    EXPECT_EQ(other.vectors.shape.size(), all.vectors.shape.size()) << kind;
    const SignatureDistances distances = signatureDistances(all, other);
    EXPECT_FALSE(distances.conformal) << kind;
    EXPECT_GT(*distances.metric, 0.1) << kind;
    EXPECT_GT(*distances.shape, 0.1) << kind;
  }
}

/// A plate with more holes than the limit of periods: the rest of the signature is kept.
TEST(Signature, LeavesOutPeriodsBeyondTheLimitAndSaysSo) {
  const TriangleSoup plate = surfaces::sample("plate", {{"holes", kMaxPeriodGenus + 1},
                                                        {"hole_width", 1},
                                                        {"hole_height", 1},
                                                        {"hole_step", 2},
                                                        {"resolution", 1}});
  const Signature signature = sign(plate);
  EXPECT_EQ(signature.topology.boundary_loops, kMaxPeriodGenus + 2);
  EXPECT_FALSE(signature.conformal);
  EXPECT_TRUE(signature.vectors.conformal.empty());
  EXPECT_GT(signature.topology.area, 0);
  EXPECT_THAT(signature.certificate.warnings,
              testing::Contains(testing::HasSubstr("PERIODS_OMITTED")));
}

TEST(SignatureDistance, OfAnnuliIsHalfTheLogarithmOfTheirModuli) {
  const auto ring = [](double width) {
    return sign(surfaces::sample("annulus", {{"r", 1}, {"R", width}, {"resolution", 12}}));
  };
  const Signature a = ring(1.5);
  const Signature b = ring(2.5);
  const double exact = std::log(std::log(2.5) / std::log(1.5)) / 2;
  EXPECT_NEAR(*signatureDistance(a, b, Space::kConformal), exact, 1e-3);
  EXPECT_EQ(*signatureDistance(a, a, Space::kConformal), 0);
}

TEST(SignatureDistance, OfPeriodsIsDefinedWithinOneTopologyOnly) {
  const auto plate = [](double holes, double step) {
    return sign(
        surfaces::sample("plate", {{"holes", holes}, {"hole_step", step}, {"resolution", 2}}));
  };
  const Signature two = plate(2, 3);
  const Signature wide = plate(2, 5);
  const Signature three = plate(3, 3);
  EXPECT_EQ(*signatureDistance(two, two, Space::kConformal), 0);
  EXPECT_GT(*signatureDistance(two, wide, Space::kConformal), 0.01);
  EXPECT_EQ(*signatureDistance(two, wide, Space::kConformal),
            *signatureDistance(wide, two, Space::kConformal));
  EXPECT_FALSE(signatureDistance(two, three, Space::kConformal));
  const Signature disk = sign(surfaces::sample("disk", {{"resolution", 3}}));
  EXPECT_FALSE(signatureDistance(two, disk, Space::kConformal));
  EXPECT_EQ(*signatureDistance(disk, sign(shapes::disk()), Space::kConformal), 0);
}

TEST(Signature, IsTheSameBytesEveryTime) {
  const TriangleSoup soup = surfaces::sample("torus", {{"resolution", 24}, {"seed", 3}});
  const Signature a = sign(soup);
  const Signature b = sign(soup);
  EXPECT_EQ(a.metric->conformal_factor_spectrum, b.metric->conformal_factor_spectrum);
  EXPECT_EQ(a.shape->mean_curvature_spectrum, b.shape->mean_curvature_spectrum);
  EXPECT_EQ(a.shape->cross_spectrum, b.shape->cross_spectrum);
  EXPECT_EQ(*a.conformal->tau, *b.conformal->tau);
  EXPECT_EQ(a.vectors.shape, b.vectors.shape);
}

TEST(Signature, HasTheSameNumbersInAnyUnits) {
  for (const TriangleSoup& soup :
       {surfaces::sample("torus", {{"resolution", 12}, {"seed", 3}}),
        surfaces::sample("ellipsoid", {{"resolution", 6}}), shapes::chainOfTori(2)}) {
    const Signature signature = sign(soup);
    for (const double factor : {0x1p-450, 0x1p450}) {
      TriangleSoup scaled = soup;
      for (Eigen::Vector3d& p : scaled.vertices) p *= factor;
      const Signature same = sign(scaled);
      EXPECT_EQ(same.conformal->tau, signature.conformal->tau);
      EXPECT_EQ(same.conformal->energy_spectrum, signature.conformal->energy_spectrum);
      EXPECT_EQ(same.vectors.metric, signature.vectors.metric);
      EXPECT_EQ(same.vectors.shape, signature.vectors.shape);
    }
  }
  TriangleSoup huge = shapes::icosahedron();
  for (Eigen::Vector3d& p : huge.vertices) p *= 1e200;
  EXPECT_THAT(tryToSign(huge), FailsWith(Reason::kOverflow));
}

TEST(Signature, StopsOnCancellationAndDeadline) {
  const PreparedMesh prepared =
      prepare(surfaces::sample("spheroid", {{"c", 0.5}, {"resolution", 16}}));
  Context cancelled;
  CancelToken token;
  token.cancel();
  cancelled.setCancelToken(token);
  EXPECT_THAT(computeSignature(cancelled, prepared), FailsWith(Reason::kCancelled));
  Context late;
  late.setDeadline(Context::Clock::now() - std::chrono::seconds(1));
  EXPECT_THAT(computeSignature(late, prepared), FailsWith(Reason::kDeadlineExceeded));

  // Cancelled from within, at the start of each stage in turn: it never finishes.
  for (const std::string stage : {"delaunay", "metric", "factorize", "layout", "spectra"}) {
    Context context;
    CancelToken raised;
    context.setCancelToken(raised);
    context.setProgressSink([&](const Progress& progress) {
      if (progress.stage == stage) raised.cancel();
    });
    EXPECT_THAT(computeSignature(context, prepared), FailsWith(Reason::kCancelled)) << stage;
  }
}

TEST(Signature, SurvivesFacesWithoutAreaAndSaysSo) {
  TriangleSoup soup = surfaces::sample("spheroid", {{"c", 0.5}, {"resolution", 12}});
  const Signature sound = sign(soup);
  // A cap without area on one edge.
  const auto [a, b, c] = soup.faces[40];
  const auto middle = static_cast<Index>(soup.vertices.size());
  soup.vertices.push_back(0.5 * (soup.vertices[a] + soup.vertices[b]));
  soup.faces[40] = {a, middle, c};
  soup.faces.push_back({middle, b, c});
  soup.faces.push_back({a, b, middle});
  const Signature capped = sign(soup);
  EXPECT_GT(*capped.certificate.mollification, 0);
  EXPECT_THAT(capped.certificate.warnings, testing::Contains(testing::HasSubstr("ZERO_AREA_FACE")));
  const SignatureDistances d = signatureDistances(sound, capped);
  EXPECT_LT(*d.metric, 0.02);
  EXPECT_LT(*d.shape, 0.02);
}

TEST(Distances, AreZeroToOneselfSymmetricAndDefinedAcrossTypes) {
  const Signature sphere = sign(surfaces::sample("ellipsoid", {{"resolution", 6}}));
  const Signature disc = sign(surfaces::sample("spheroid", {{"c", 0.3}, {"resolution", 6}}));
  const Signature thin = sign(surfaces::sample("torus", {{"R", 3}, {"resolution", 16}}));
  const Signature thick = sign(surfaces::sample("torus", {{"R", 1.5}, {"resolution", 16}}));
  for (const Signature* s : {&sphere, &disc, &thin, &thick}) {
    const SignatureDistances self = signatureDistances(*s, *s);
    EXPECT_EQ(self.conformal, 0.0);
    EXPECT_EQ(self.metric, 0.0);
    EXPECT_EQ(self.shape, 0.0);
  }
  EXPECT_EQ(signatureDistance(sphere, disc, Space::kConformal), 0.0);
  EXPECT_GT(*signatureDistance(sphere, disc, Space::kMetric), 0.1);
  // Teichmüller: tau = i sqrt(R^2 - 1), half the log of the ratio.
  EXPECT_NEAR(*signatureDistance(thin, thick, Space::kConformal),
              0.5 * std::log(std::sqrt(8.0) / std::sqrt(1.25)), 0.02);
  const SignatureDistances across = signatureDistances(sphere, thin);
  EXPECT_FALSE(across.conformal);
  EXPECT_GT(*across.metric, 0);
  EXPECT_EQ(*across.shape, *signatureDistances(thin, sphere).shape);
}

TEST(Distances, AreThoseOfTheSearchVectors) {
  const Signature a = sign(surfaces::sample("ellipsoid", {{"resolution", 6}}));
  const Signature b = sign(surfaces::sample("torus", {{"resolution", 12}}));
  ASSERT_EQ(a.vectors.metric.size(), b.vectors.metric.size());
  ASSERT_EQ(a.vectors.shape.size(), b.vectors.shape.size());
  const auto euclidean = [](const std::vector<float>& x, const std::vector<float>& y) {
    double total = 0;
    for (std::size_t i = 0; i < x.size(); ++i) total += (x[i] - y[i]) * (x[i] - y[i]);
    return std::sqrt(total);
  };
  const SignatureDistances d = signatureDistances(a, b);
  // Floats carry seven digits.
  EXPECT_NEAR(euclidean(a.vectors.metric, b.vectors.metric), *d.metric, 1e-5 * *d.metric);
  EXPECT_NEAR(euclidean(a.vectors.shape, b.vectors.shape), *d.shape, 1e-5 * *d.shape);
  // A signature of the shape space alone still has its distance.
  const Signature alone = sign(surfaces::sample("torus", {{"resolution", 12}}), Space::kShape);
  EXPECT_NEAR(*signatureDistance(a, alone, Space::kShape), *d.shape, 1e-5 * *d.shape);
  EXPECT_FALSE(signatureDistance(a, alone, Space::kMetric));
}

/// What must not change: place, size and numbering. Real meshes, one after the other.
class RealMesh : public testing::TestWithParam<const char*> {};

TEST_P(RealMesh, KeepsItsSignatureWhenMovedScaledAndRenumbered) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const TriangleSoup soup = surfaces::read(path);
  const Signature original = sign(soup);
  const Signature moved = sign(surfaces::moved(soup, 1234.5));
  const Signature renumbered = sign(surfaces::renumbered(soup, 1));
  for (const Signature* other : {&moved, &renumbered}) {
    expectSameSpectra(original, *other, 1e-9);
    const SignatureDistances d = signatureDistances(original, *other);
    EXPECT_LT(*d.conformal, 1e-9);
    EXPECT_LT(*d.metric, 1e-8);
    EXPECT_LT(*d.shape, 1e-8);
  }
  EXPECT_NEAR(moved.topology.area, original.topology.area * 1234.5 * 1234.5,
              1e-9 * moved.topology.area);
}

TEST_P(RealMesh, InsideOutMirrorsTauAndNegatesTheCrossSpectrum) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const TriangleSoup soup = surfaces::read(path);
  const Signature original = sign(soup);
  const Signature reversed = sign(surfaces::reversed(soup));
  expectSameSpectra(original, reversed, 1e-9, -1);
  if (original.conformal->tau) {
    EXPECT_NEAR(std::abs(*original.conformal->tau + std::conj(*reversed.conformal->tau)), 0, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Shared, RealMesh,
                         testing::Values("closed_g0/alec__spot.obj",
                                         "closed_g0/odedstein__bunny.obj",
                                         "genus1/ceaedf__Kitten.off", "genus1/cfwen__torus.off"));

/// A tenth of what different shapes are apart, in the middle.
TEST(RealMeshes, OfOneObjectAtTwoResolutionsAreNearest) {
  MODULI_NEED_SHARED_MESH(fine, "genus1/cfwen__kitten.nf20k.off");
  MODULI_NEED_SHARED_MESH(coarse, "genus1/ceaedf__Kitten.off");
  MODULI_NEED_SHARED_MESH(arm, "genus1/alec__rocker-arm.obj");
  MODULI_NEED_SHARED_MESH(torus, "genus1/cfwen__torus.off");
  MODULI_NEED_SHARED_MESH(knot, "genus1/cfwen__knot.obj");
  const Signature a = sign(surfaces::read(fine));
  const Signature b = sign(surfaces::read(coarse));
  const std::vector<Signature> others = {sign(surfaces::read(arm)), sign(surfaces::read(torus)),
                                         sign(surfaces::read(knot))};
  for (const Space space : {Space::kConformal, Space::kMetric, Space::kShape}) {
    SCOPED_TRACE(static_cast<int>(space));
    std::vector<double> apart;
    for (std::size_t i = 0; i < others.size(); ++i) {
      apart.push_back(*signatureDistance(a, others[i], space));
      for (std::size_t j = 0; j < i; ++j) {
        apart.push_back(*signatureDistance(others[i], others[j], space));
      }
    }
    std::sort(apart.begin(), apart.end());
    const double same = *signatureDistance(a, b, space);
    EXPECT_LT(same, apart.front());
    EXPECT_LT(same, 0.1 * apart[apart.size() / 2]);
  }
}

}  // namespace
}  // namespace moduli
