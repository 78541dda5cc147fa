#include "server/rpc/convert.h"

#include <google/protobuf/util/json_util.h>

#include <limits>
#include <string>

#include "tests/core/testing.h"

namespace moduli {
namespace {

Signature torusSignature() {
  Signature signature;
  signature.topology = {.vertices = 12, .faces = 24, .components = 1, .genus = 1, .area = 3.5};
  ConformalBlock& block = signature.conformal.emplace();
  block.type = ConformalType::kTorus;
  block.tau = {0.25, 1.5};
  block.tau_error = 1e-3;
  block.energy_spectrum = {0.5, 1.5, 1.5};
  block.energy_spectrum_error = 1e-4;
  signature.metric = MetricBlock{{12.5, 13.5}, {1.0, 0.1}};
  signature.shape = ShapeBlock{{2.0, 0.2}, {-3.0, 0.3}};
  signature.vectors = {{0.5F}, {1.0F, 0.25F}, {2.0F}};
  signature.certificate.flipped_faces = 0;
  signature.certificate.max_dilatation = 1.25;
  signature.certificate.warnings = {"ZERO_AREA_FACE: one"};
  signature.timing = {{"read", 0.5}};
  return signature;
}

/// Every field of a conformal block at once, as no one surface has them.
Signature borderedSignature() {
  Signature signature = torusSignature();
  ConformalBlock& block = *signature.conformal;
  block.type = ConformalType::kBordered;
  block.tau.reset();
  block.modulus = 0.75;
  block.modulus_error = 1e-5;
  block.period_matrix = PeriodEntries{2, {{0.5, 1}, {-0.25, 0.125}, {-0.25, 0.125}, {0, 2}}};
  block.period_error = 1e-6;
  block.circles = {{0, 1}, {0, 0.25}, {{0.6, -0.125}, 1e-5}};
  block.boundary_lengths = {1.25, 4.5};
  block.length_spectrum = {0.5, 1.25};
  signature.certificate.period_symmetry_residual = 1e-17;
  signature.certificate.mode_residual = 1e-9;
  return signature;
}

TEST(Convert, PeriodsTravelThereAndBackToTheLastBit) {
  const Signature signature = borderedSignature();
  const v1::Signature message = toProto(signature);
  EXPECT_EQ(message.conformal().period_matrix().entries(2).re(), -0.25) << "row by row";
  const Result<Signature> back = fromProto(message);
  ASSERT_OK(back);
  EXPECT_EQ(toProto(*back).SerializeAsString(), message.SerializeAsString());
  EXPECT_EQ(back->conformal->period_matrix->values, signature.conformal->period_matrix->values);
  EXPECT_EQ(back->conformal->energy_spectrum, signature.conformal->energy_spectrum);
  EXPECT_EQ(back->conformal->modulus, 0.75);
  EXPECT_EQ(back->conformal->boundary_lengths, signature.conformal->boundary_lengths);
  EXPECT_EQ(back->metric->laplace_spectrum, signature.metric->laplace_spectrum);
  EXPECT_EQ(back->certificate.mode_residual, 1e-9);
  EXPECT_EQ(back->certificate.period_symmetry_residual, 1e-17);
}

TEST(Convert, CirclesTravelThereAndBackToTheLastBit) {
  const Signature signature = borderedSignature();
  const v1::Signature message = toProto(signature);
  ASSERT_EQ(message.conformal().circles_size(), 3);
  EXPECT_EQ(message.conformal().circles(2).center().re(), 0.6);
  EXPECT_EQ(message.conformal().circles(2).center().im(), -0.125);
  const Result<Signature> back = fromProto(message);
  ASSERT_OK(back);
  ASSERT_EQ(back->conformal->circles.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(back->conformal->circles[k].center, signature.conformal->circles[k].center);
    EXPECT_EQ(back->conformal->circles[k].radius, signature.conformal->circles[k].radius);
  }
}

// The keys that other programs read.
TEST(Convert, CirclesHaveTheirNamesInJson) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  std::string text;
  ASSERT_TRUE(MessageToJsonString(toProto(borderedSignature()).conformal(), &text, options).ok());
  EXPECT_THAT(text, testing::HasSubstr(R"("circles":[{"center":{"re":0,"im":0},"radius":1},)"
                                       R"({"center":{"re":0,"im":0},"radius":0.25},)"
                                       R"({"center":{"re":0.6,"im":-0.125},"radius":1e-05}])"));
}

TEST(Convert, ASignatureTravelsThereAndBackToTheLastBit) {
  const Signature signature = torusSignature();
  const v1::Signature message = toProto(signature);
  const Result<Signature> back = fromProto(message);
  ASSERT_OK(back);
  EXPECT_EQ(toProto(*back).SerializeAsString(), message.SerializeAsString());
  EXPECT_EQ(back->conformal->tau, signature.conformal->tau);
  EXPECT_EQ(back->certificate.flipped_faces, 0) << "a zero that was said is not absent";
  EXPECT_FALSE(back->certificate.newton_iterations.has_value());
  EXPECT_EQ(back->vectors.metric, signature.vectors.metric);
  EXPECT_EQ(back->shape->cross_spectrum, signature.shape->cross_spectrum);
}

TEST(Convert, BlocksThatWereNotComputedStayAbsent) {
  Signature signature = torusSignature();
  signature.metric.reset();
  signature.shape.reset();
  const Result<Signature> back = fromProto(toProto(signature));
  ASSERT_OK(back);
  EXPECT_FALSE(back->metric.has_value());
  EXPECT_FALSE(back->shape.has_value());
}

TEST(Convert, WhatNoSignatureCanBeIsRefused) {
  using Spoil = void (*)(v1::Signature&);
  const std::vector<Spoil> spoils = {
      [](v1::Signature& s) { s.clear_topology(); },
      [](v1::Signature& s) { s.mutable_topology()->set_faces(-1); },
      [](v1::Signature& s) { s.clear_descriptor_version(); },
      [](v1::Signature& s) { s.mutable_conformal()->clear_type(); },
      [](v1::Signature& s) { s.mutable_conformal()->clear_tau(); },
      [](v1::Signature& s) { s.mutable_conformal()->mutable_tau()->set_im(-1); },
      [](v1::Signature& s) {
        s.mutable_metric()->add_conformal_factor_spectrum(std::numeric_limits<double>::quiet_NaN());
      },
      [](v1::Signature& s) {
        s.mutable_vectors()->add_shape(std::numeric_limits<float>::infinity());
      },
      [](v1::Signature& s) {
        for (int i = 0; i < 5000; ++i) s.mutable_vectors()->add_metric(0);
      },
  };
  for (std::size_t i = 0; i < spoils.size(); ++i) {
    v1::Signature message = toProto(torusSignature());
    spoils[i](message);
    EXPECT_THAT(fromProto(message), FailsWith(Reason::kInvalidRequest)) << "spoil " << i;
  }
}

TEST(Convert, WhatNoConformalBlockCanBeIsRefused) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  using Spoil = void (*)(v1::ConformalBlock&);
  const std::vector<Spoil> spoils = {
      [](v1::ConformalBlock& b) { b.set_modulus(0); },
      [](v1::ConformalBlock& b) { b.set_modulus(kNaN); },
      [](v1::ConformalBlock& b) { b.set_modulus_error(kNaN); },
      [](v1::ConformalBlock& b) { b.set_period_error(kNaN); },
      [](v1::ConformalBlock& b) { b.set_energy_spectrum_error(kNaN); },
      [](v1::ConformalBlock& b) { b.add_energy_spectrum(-1); },
      [](v1::ConformalBlock& b) { b.add_energy_spectrum(kNaN); },
      [](v1::ConformalBlock& b) {
        for (int i = 0; i < 5000; ++i) b.add_energy_spectrum(1);
      },
      [](v1::ConformalBlock& b) { b.mutable_period_matrix()->set_size(0); },
      [](v1::ConformalBlock& b) { b.mutable_period_matrix()->set_size(3); },
      [](v1::ConformalBlock& b) { b.mutable_period_matrix()->set_size(1 << 16); },
      [](v1::ConformalBlock& b) { b.mutable_period_matrix()->mutable_entries(1)->set_im(kNaN); },
      [](v1::ConformalBlock& b) { b.mutable_circles(1)->set_radius(0); },
      [](v1::ConformalBlock& b) { b.mutable_circles(1)->set_radius(-1); },
      [](v1::ConformalBlock& b) { b.mutable_circles(1)->set_radius(kNaN); },
      [](v1::ConformalBlock& b) {
        b.mutable_circles(1)->set_radius(std::numeric_limits<double>::infinity());
      },
      [](v1::ConformalBlock& b) { b.mutable_circles(2)->mutable_center()->set_re(kNaN); },
      [](v1::ConformalBlock& b) { b.mutable_circles(2)->mutable_center()->set_im(kNaN); },
      [](v1::ConformalBlock& b) {
        for (int i = 0; i < 127; ++i) *b.add_circles() = b.circles(1);
      },
  };
  for (std::size_t i = 0; i < spoils.size(); ++i) {
    v1::Signature message = toProto(borderedSignature());
    spoils[i](*message.mutable_conformal());
    EXPECT_THAT(fromProto(message), FailsWith(Reason::kInvalidRequest)) << "spoil " << i;
  }
}

TEST(Convert, AsManyCirclesAsPeriodsAllowAreTaken) {
  v1::Signature message = toProto(borderedSignature());
  v1::ConformalBlock& block = *message.mutable_conformal();
  while (block.circles_size() < 129) *block.add_circles() = block.circles(1);
  EXPECT_OK(fromProto(message));
}

TEST(Convert, DefectsKeepKindSeverityAndElements) {
  Inspection inspection;
  inspection.counts.faces = 3;
  inspection.defects = {{DefectKind::kNonManifoldEdge, 2, {0, 5}, "bad edge"},
                        {DefectKind::kIsolatedVertex, 1, {7}, "alone"}};
  const v1::Inspection message = toProto(inspection, {{"weld vertices", 3}});
  ASSERT_EQ(message.defects_size(), 2);
  EXPECT_EQ(message.defects(0).kind(), v1::Defect::NON_MANIFOLD_EDGE);
  EXPECT_EQ(message.defects(0).severity(), v1::Defect::BLOCKING);
  EXPECT_EQ(message.defects(0).elements(1), 5);
  EXPECT_EQ(message.defects(1).kind(), v1::Defect::ISOLATED_VERTEX);
  EXPECT_EQ(message.defects(1).severity(), v1::Defect::WARNING);
  EXPECT_FALSE(message.topology().has_genus());
  EXPECT_EQ(message.repair(0).action(), "weld vertices");
}

TEST(Convert, EveryDefectKindHasTheNameOfItsMessage) {
  for (int i = 0; i <= static_cast<int>(DefectKind::kMultipleComponents); ++i) {
    Inspection inspection;
    inspection.defects = {{static_cast<DefectKind>(i), 1, {}, ""}};
    const v1::Inspection message = toProto(inspection, {});
    EXPECT_EQ(v1::Defect::Kind_Name(message.defects(0).kind()),
              defectName(static_cast<DefectKind>(i)));
  }
}

TEST(Convert, OptionsAndEnumsTravelThereAndBack) {
  PrepareOptions options;
  options.repair = {.repair = true, .fill_holes = 0.25};
  options.component = "largest";
  const PrepareOptions back = fromProto(toProto(options));
  EXPECT_TRUE(back.repair.repair);
  EXPECT_EQ(back.repair.fill_holes, 0.25);
  EXPECT_EQ(back.component, "largest");
  EXPECT_FALSE(fromProto(v1::PrepareOptions()).repair.fill_holes.has_value());
  EXPECT_EQ(fromProto(toProto(Space::kMetric)), Space::kMetric);
  EXPECT_EQ(fromProto(v1::Signature::SPACE_UNSPECIFIED), std::nullopt);
  EXPECT_EQ(fromProto(static_cast<v1::Signature::Space>(99)), std::nullopt);
  EXPECT_EQ(fromProto(toProto(MeshFormat::kStl)), MeshFormat::kStl);
  EXPECT_EQ(fromProto(toProto(MeshFormat::kJson)), MeshFormat::kJson);
  EXPECT_EQ(toProto(MeshFormat::kGifti), v1::MeshSource::GIFTI);
  EXPECT_EQ(fromProto(toProto(MeshFormat::kFreeSurfer)), MeshFormat::kFreeSurfer);
  EXPECT_EQ(fromProto(static_cast<v1::MeshSource::Format>(8)), std::nullopt);
  EXPECT_EQ(fromProto(v1::MeshSource::FORMAT_UNSPECIFIED), std::nullopt);
}

TEST(Convert, UndefinedDistancesStayAbsent) {
  SignatureDistances distances;
  distances.metric = 0.0;
  const v1::SignatureDistances message = toProto(distances);
  EXPECT_FALSE(message.has_conformal());
  EXPECT_TRUE(message.has_metric());
  EXPECT_EQ(fromProto(message).metric, 0.0);
  EXPECT_FALSE(fromProto(message).shape.has_value());
}

}  // namespace
}  // namespace moduli
