#include "server/rpc/convert.h"

#include <limits>

#include "tests/core/testing.h"

namespace moduli {
namespace {

Signature torusSignature() {
  Signature signature;
  signature.topology = {.vertices = 12, .faces = 24, .components = 1, .genus = 1, .area = 3.5};
  signature.conformal = ConformalBlock{ConformalType::kTorus, {{0.25, 1.5}}, 1e-3};
  signature.metric = MetricBlock{{1.0, 0.1}};
  signature.shape = ShapeBlock{{2.0, 0.2}, {-3.0, 0.3}};
  signature.vectors = {{0.5F}, {1.0F, 0.25F}, {2.0F}};
  signature.certificate.flipped_faces = 0;
  signature.certificate.max_dilatation = 1.25;
  signature.certificate.warnings = {"ZERO_AREA_FACE: one"};
  signature.timing = {{"read", 0.5}};
  return signature;
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
