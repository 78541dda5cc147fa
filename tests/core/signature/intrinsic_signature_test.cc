#include <cmath>
#include <numbers>

#include "core/intrinsic/assemble_surface.h"
#include "core/intrinsic/intrinsic_samples.h"
#include "core/signature/compute.h"
#include "core/signature/distance.h"
#include "tests/core/spherical/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Signature sign(const IntrinsicSurface& surface, std::optional<Space> space = {}) {
  Context context;
  auto signature = computeIntrinsicSignature(context, surface, {space});
  EXPECT_OK(signature);
  return *std::move(signature);
}

IntrinsicSurface sampleOf(const char* kind) {
  auto surface = makeIntrinsicSample(kind);
  EXPECT_OK(surface);
  return *std::move(surface);
}

PreparedMesh meshOf(const char* kind, const std::map<std::string, double>& parameters) {
  Context context;
  auto prepared = prepareMesh(context, surfaces::sample(kind, parameters), {});
  EXPECT_OK(prepared);
  return *std::move(prepared);
}

/// The surfaces of chords are conformal to the smooth ones by symmetry, and symmetry makes their
/// projected energies exact on any triangulation that has it (CHECKS D2, D6).
struct Symmetric {
  const char* kind;
  Index genus;
  double least_energy;
  std::size_t multiplicity;
};

TEST(IntrinsicSignature, OfSymmetricSurfacesHasTheirKnownEnergies) {
  for (const auto& [kind, genus, least, multiplicity] :
       {Symmetric{"bolza", 2, std::numbers::sqrt2, 12},
        Symmetric{"klein", 3, 4 / std::sqrt(7.0), 21}}) {
    SCOPED_TRACE(kind);
    const Signature signature = sign(sampleOf(kind));
    EXPECT_EQ(signature.topology.genus, genus);
    EXPECT_NEAR(signature.topology.area, 4 * std::numbers::pi * (genus - 1), 1e-12);
    ASSERT_TRUE(signature.conformal);
    EXPECT_EQ(signature.conformal->type, ConformalType::kHyperbolic);
    EXPECT_EQ(signature.conformal->period_matrix->size, genus);
    const std::vector<double>& energies = signature.conformal->energy_spectrum;
    ASSERT_GT(energies.size(), multiplicity);
    for (std::size_t i = 0; i < multiplicity; ++i) {
      EXPECT_NEAR(energies[i], least, 1e-12);
    }
    EXPECT_GT(energies[multiplicity], 1.01 * energies[0]);
    EXPECT_FALSE(signature.metric);
    EXPECT_FALSE(signature.shape);
    EXPECT_TRUE(signature.vectors.metric.empty());
    EXPECT_TRUE(signature.vectors.shape.empty());
    EXPECT_FALSE(signature.vectors.conformal.empty());
    EXPECT_THAT(
        signature.certificate.warnings,
        testing::IsSupersetOf({StartsWith("SPACES_OMITTED: "), StartsWith("CHORDAL_METRIC: ")}));
  }
}

TEST(IntrinsicSignature, OfAMeshWithoutPositionsIsTheMeshsConformalBlock) {
  for (const char* kind : {"torus", "genus", "annulus", "disk", "sphere", "plate"}) {
    SCOPED_TRACE(kind);
    const PreparedMesh prepared = meshOf(kind, {{"resolution", 4}});
    Context context;
    const auto whole = computeSignature(context, prepared, {Space::kConformal});
    ASSERT_OK(whole);
    const Signature without = sign(forgetPositions(prepared.mesh), Space::kConformal);
    EXPECT_EQ(without.conformal->type, whole->conformal->type);
    EXPECT_EQ(without.conformal->tau, whole->conformal->tau);
    EXPECT_EQ(without.conformal->modulus, whole->conformal->modulus);
    EXPECT_EQ(without.conformal->energy_spectrum, whole->conformal->energy_spectrum);
    EXPECT_EQ(without.vectors.conformal, whole->vectors.conformal);
    EXPECT_EQ(signatureDistance(without, *whole, Space::kConformal), 0.0);
    EXPECT_NEAR(without.topology.area, whole->topology.area, 1e-12 * whole->topology.area);
    EXPECT_TRUE(without.certificate.warnings.empty() ||
                without.certificate.warnings == whole->certificate.warnings);
  }
}

TEST(IntrinsicSignature, OnlyMissingSpacesThatWereAskedForAreWorthAWarning) {
  const IntrinsicSurface torus = forgetPositions(meshOf("torus", {{"resolution", 4}}).mesh);
  EXPECT_THAT(sign(torus).certificate.warnings, testing::Contains(StartsWith("SPACES_OMITTED: ")));
  EXPECT_TRUE(sign(torus, Space::kConformal).certificate.warnings.empty());
}

TEST(IntrinsicSignature, TheMetricAndShapeSpacesAloneAreRefused) {
  const IntrinsicSurface bolza = sampleOf("bolza");
  for (const Space space : {Space::kMetric, Space::kShape}) {
    Context context;
    const auto signature = computeIntrinsicSignature(context, bolza, {space});
    ASSERT_THAT(signature, FailsWith(Reason::kUnsupportedContent));
    EXPECT_THAT(signature.status().message(), HasSubstr("metric and shape spaces"));
    EXPECT_FALSE(signature.status().hint().empty());
  }
}

TEST(IntrinsicSignature, ASphericalOctahedronIsASphereOfArea4Pi) {
  const double quarter = std::numbers::pi / 2;
  SurfaceTables tables;
  tables.geometry = Geometry::kSpherical;
  tables.vertex_count = 6;
  tables.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                  {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  tables.lengths.assign(24, quarter);
  Context context;
  const auto octahedron = assembleSurface(context, std::move(tables));
  ASSERT_OK(octahedron);
  const Signature signature = sign(*octahedron);
  EXPECT_EQ(signature.conformal->type, ConformalType::kSphere);
  EXPECT_NEAR(signature.topology.area, 4 * std::numbers::pi, 1e-12);
}

TEST(IntrinsicSignature, AnAreaThatNoDoubleHoldsIsRefused) {
  SurfaceTables tables;
  tables.vertex_count = 3;
  tables.faces = {{0, 1, 2}};
  tables.lengths.assign(3, 1e200);
  Context context;
  const auto triangle = assembleSurface(context, std::move(tables));
  ASSERT_OK(triangle);
  EXPECT_THAT(computeIntrinsicSignature(context, *triangle), FailsWith(Reason::kOverflow));
}

}  // namespace
}  // namespace moduli
