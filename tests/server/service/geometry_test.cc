#include <cmath>
#include <numbers>

#include "core/intrinsic/intrinsic_json.h"
#include "core/intrinsic/intrinsic_samples.h"
#include "core/signature/signature.h"
#include "tests/server/service/fixture.h"

namespace moduli {
namespace {

class GeometryTest : public ServiceTest {
 protected:
  Result<v1::Inspection> inspect(const v1::MeshSource& source) {
    grpc::ClientContext context;
    v1::InspectMeshRequest request;
    *request.mutable_source() = source;
    ASSIGN_OR_RETURN(const auto last, lastEvent(*peer_->geometry().InspectMesh(&context, request)));
    return last.inspection();
  }

  Result<v1::SignatureDistances> compare(const v1::CompareSignaturesRequest& request) {
    grpc::ClientContext context;
    ASSIGN_OR_RETURN(const auto last,
                     lastEvent(*peer_->geometry().CompareSignatures(&context, request)));
    if (!last.has_distances()) return Status(Reason::kInternal, "no distances");
    return last.distances();
  }
};

TEST_F(GeometryTest, TheServerTellsItsLimits) {
  grpc::ClientContext context;
  v1::ServerInfo info;
  ASSERT_TRUE(peer_->geometry().GetServerInfo(&context, {}, &info).ok());
  EXPECT_FALSE(info.version().empty());
  EXPECT_EQ(info.descriptor_version(), kDescriptorVersion);
  EXPECT_EQ(info.max_inline_bytes(), 4 << 20);
  EXPECT_EQ(info.max_chunk_bytes(), 1 << 20);
  EXPECT_EQ(info.max_faces(), 8'000'000);
}

TEST_F(GeometryTest, InspectionCountsWhatIsThere) {
  const auto inspection = inspect(inlineSource(sampleFile("torus", {{"resolution", 8}})));
  ASSERT_OK(inspection);
  EXPECT_TRUE(inspection->valid());
  EXPECT_EQ(inspection->topology().genus(), 1);
  EXPECT_EQ(inspection->topology().components(), 1);
}

TEST_F(GeometryTest, InspectionOfABrokenMeshReportsItsDefects) {
  // Three faces on the edge 0-1.
  const auto inspection = inspect(
      inlineSource("OFF\n5 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 -1 0\n3 0 1 2\n3 1 0 3\n3 0 1 4\n"));
  ASSERT_OK(inspection);
  EXPECT_FALSE(inspection->valid());
  ASSERT_GE(inspection->defects_size(), 1);
  EXPECT_EQ(inspection->defects(0).kind(), v1::Defect::NON_MANIFOLD_EDGE);
}

TEST_F(GeometryTest, SignaturesOfSphereAndTorusHaveTheirType) {
  const auto sphere = peer_->sign(inlineSource(smallMesh(1)));
  ASSERT_OK(sphere);
  EXPECT_EQ(sphere->conformal().type(), v1::ConformalBlock::SPHERE);
  EXPECT_TRUE(sphere->has_metric());
  EXPECT_TRUE(sphere->has_shape());
  EXPECT_FALSE(sphere->timing().empty());
  const auto torus = peer_->sign(inlineSource(sampleFile("torus", {{"resolution", 12}})));
  ASSERT_OK(torus);
  EXPECT_EQ(torus->conformal().type(), v1::ConformalBlock::TORUS);
  EXPECT_GT(torus->conformal().tau().im(), 0.8);
}

TEST_F(GeometryTest, OneSpaceAloneIsComputedOnRequest) {
  const auto signature = peer_->sign(inlineSource(smallMesh(1)), v1::Signature::CONFORMAL);
  ASSERT_OK(signature);
  EXPECT_TRUE(signature->has_conformal());
  EXPECT_FALSE(signature->has_shape());
}

TEST_F(GeometryTest, TheSameMeshGivesTheSameSignatureFromEverySource) {
  const std::string bytes = smallMesh(3);
  const auto digest = peer_->upload(bytes);
  ASSERT_OK(digest);
  EXPECT_EQ(*digest, sha256Hex(bytes));
  ASSERT_OK(peer_->ingest(ingestHeader("c"), {ingestItemOf(0, "s", bytes)}));
  auto from_bytes = peer_->sign(inlineSource(bytes));
  auto from_digest = peer_->sign(digestSource(*digest));
  auto from_shape = peer_->sign(shapeSource("collections/c/shapes/s"));
  ASSERT_OK(from_bytes);
  ASSERT_OK(from_digest);
  ASSERT_OK(from_shape);
  for (auto* signature : {&from_bytes, &from_digest, &from_shape}) (*signature)->clear_timing();
  EXPECT_EQ(from_bytes->SerializeAsString(), from_digest->SerializeAsString());
  EXPECT_EQ(from_bytes->SerializeAsString(), from_shape->SerializeAsString());
}

TEST_F(GeometryTest, SidesOfAComparisonMayBeMeshesOrSignatures) {
  const std::string bytes = smallMesh(4);
  const auto signature = peer_->sign(inlineSource(bytes));
  ASSERT_OK(signature);
  v1::CompareSignaturesRequest request;
  *request.mutable_a()->mutable_source() = inlineSource(bytes);
  *request.mutable_b()->mutable_signature() = *signature;
  const auto same = compare(request);
  ASSERT_OK(same);
  EXPECT_EQ(same->shape(), 0.0);
  EXPECT_EQ(same->metric(), 0.0);
  *request.mutable_a()->mutable_source() = inlineSource(smallMesh(400));
  const auto other = compare(request);
  ASSERT_OK(other);
  EXPECT_GT(other->shape(), 0.0);
}

TEST_F(GeometryTest, OtherDescriptorVersionsAreNotCompared) {
  auto signature = peer_->sign(inlineSource(smallMesh(4)));
  ASSERT_OK(signature);
  v1::CompareSignaturesRequest request;
  *request.mutable_a()->mutable_signature() = *signature;
  signature->set_descriptor_version(77);
  *request.mutable_b()->mutable_signature() = *signature;
  EXPECT_THAT(compare(request), FailsWith(Reason::kIncomparableSignatures));
}

TEST_F(GeometryTest, ProgressComesBeforeTheOneResult) {
  grpc::ClientContext context;
  v1::ComputeSignatureRequest request;
  *request.mutable_source() = inlineSource(smallMesh(5));
  const auto reader = peer_->geometry().ComputeSignature(&context, request);
  std::vector<v1::ComputeSignatureResponse> events;
  for (v1::ComputeSignatureResponse event; reader->Read(&event);) events.push_back(event);
  ASSERT_TRUE(reader->Finish().ok());
  ASSERT_GE(events.size(), 2U);
  EXPECT_EQ(events.front().progress().stage(), "queued");
  for (std::size_t i = 0; i + 1 < events.size(); ++i) {
    EXPECT_TRUE(events[i].has_progress());
    EXPECT_GE(events[i].progress().fraction(), 0);
    EXPECT_LE(events[i].progress().fraction(), 1);
  }
  EXPECT_TRUE(events.back().has_signature());
}

struct WrongSource {
  std::string bytes;
  Reason reason;
};

TEST_F(GeometryTest, TheSameDefectAlwaysHasTheSameReason) {
  const std::string square = "4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const std::vector<WrongSource> wrongs = {
      {"", Reason::kEmpty},
      {"no mesh at all", Reason::kUnknownFormat},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n", Reason::kTruncatedFile},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", Reason::kIndexOutOfRange},
      {"{\"format\": 1}", Reason::kSyntaxError},
      {"OFF\n3 1 0\n0 0 0\n1 0 zero\n0 1 0\n3 0 1 2\n", Reason::kSyntaxError},
      {"OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", Reason::kNonFiniteCoordinate},
      {"OFF\n" + square + "3 0 1 2\n3 0 2 2\n", Reason::kDegenerateFace},
      {"OFF\n" + square + "3 0 1 2\n3 0 1 3\n", Reason::kInconsistentOrientation},
      {"OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n5 0 0\n6 0 0\n5 1 0\n3 0 1 2\n3 3 4 5\n",
       Reason::kMultipleComponents},
  };
  for (const WrongSource& wrong : wrongs) {
    const auto signature = peer_->sign(inlineSource(wrong.bytes, "wrong"));
    EXPECT_THAT(signature, FailsWith(wrong.reason)) << wrong.bytes.substr(0, 60);
  }
}

TEST_F(GeometryTest, EveryTopologyHasItsConformalBlock) {
  using Type = v1::ConformalBlock;
  const auto blockOf = [&](const std::string& kind, const std::map<std::string, double>& values) {
    const auto signature = peer_->sign(inlineSource(sampleFile(kind, values), kind));
    EXPECT_OK(signature) << kind;
    return signature.ok() ? signature->conformal() : Type();
  };
  const Type two = blockOf("genus", {{"genus", 2}, {"resolution", 2}});
  EXPECT_EQ(two.type(), Type::HYPERBOLIC);
  EXPECT_EQ(two.period_matrix().size(), 2);
  EXPECT_EQ(two.period_matrix().entries_size(), 4);
  EXPECT_EQ(two.energy_spectrum_size(), 32);
  EXPECT_GT(two.period_error(), 0);
  const Type ring = blockOf("annulus", {{"resolution", 4}});
  EXPECT_EQ(ring.type(), Type::ANNULUS);
  EXPECT_NEAR(ring.modulus(), std::log(2) / (2 * std::numbers::pi), 2e-3);
  EXPECT_FALSE(ring.has_period_matrix());
  const Type plate = blockOf("plate", {{"holes", 3}, {"resolution", 2}});
  EXPECT_EQ(plate.type(), Type::CIRCLE_DOMAIN);
  EXPECT_EQ(plate.period_matrix().size(), 3);
  EXPECT_EQ(plate.circles_size(), 4);
  EXPECT_EQ(blockOf("disk", {{"resolution", 4}}).type(), Type::DISK);
}

TEST_F(GeometryTest, IntrinsicTriangulationsAreInspectedAndSigned) {
  const auto bolza = makeIntrinsicSample("bolza");
  ASSERT_OK(bolza);
  v1::MeshSource source = inlineSource(writeIntrinsicJson(*bolza), "bolza.json");
  const auto inspection = inspect(source);
  ASSERT_OK(inspection);
  EXPECT_TRUE(inspection->valid());
  EXPECT_EQ(inspection->topology().genus(), 2);
  source.set_format(v1::MeshSource::JSON);
  const auto signature = peer_->sign(source);
  ASSERT_OK(signature);
  EXPECT_EQ(signature->conformal().type(), v1::ConformalBlock::HYPERBOLIC);
  EXPECT_FALSE(signature->has_metric());
  EXPECT_FALSE(signature->has_shape());
  EXPECT_THAT(peer_->sign(source, v1::Signature::SHAPE), FailsWith(Reason::kUnsupportedContent));
  source.set_format(v1::MeshSource::OFF);
  EXPECT_THAT(peer_->sign(source), FailsWith(Reason::kSyntaxError));

  ASSERT_OK(peer_->ingest(ingestHeader("c"), {ingestItemOf(0, "b", source.inline_())}));
  const auto stored = peer_->getShape("collections/c/shapes/b");
  ASSERT_OK(stored);
  EXPECT_EQ(stored->format(), v1::MeshSource::JSON);
  const auto again = peer_->sign(shapeSource("collections/c/shapes/b"));
  ASSERT_OK(again);
  EXPECT_EQ(again->conformal().SerializeAsString(), signature->conformal().SerializeAsString());
}

TEST_F(GeometryTest, WrongRequestsNameTheirField) {
  const auto field = [&](const v1::ComputeSignatureRequest& request) -> std::string {
    grpc::ClientContext context;
    const auto reader = peer_->geometry().ComputeSignature(&context, request);
    v1::ComputeSignatureResponse event;
    while (reader->Read(&event)) {
    }
    const grpc::Status status = reader->Finish();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    const std::string& details = status.error_details();
    for (const char* name : {"source.digest", "source.shape", "prepare.component",
                             "prepare.fill_holes", "space", "source"}) {
      if (details.find(name) != std::string::npos) return name;
    }
    return "";
  };
  v1::ComputeSignatureRequest request;
  EXPECT_EQ(field(request), "source");
  request.mutable_source()->set_digest("abc");
  EXPECT_EQ(field(request), "source.digest");
  request.mutable_source()->set_shape("collections/c");
  EXPECT_EQ(field(request), "source.shape");
  *request.mutable_source() = inlineSource(smallMesh(1));
  request.mutable_prepare()->set_component("biggest");
  EXPECT_EQ(field(request), "prepare.component");
  request.mutable_prepare()->set_component("");
  request.mutable_prepare()->set_fill_holes(-1);
  EXPECT_EQ(field(request), "prepare.fill_holes");
  request.clear_prepare();
  request.set_space(static_cast<v1::Signature::Space>(42));
  EXPECT_EQ(field(request), "space");
}

TEST_F(GeometryTest, WhatIsNotThereIsNotFound) {
  EXPECT_THAT(peer_->sign(digestSource(sha256Hex("never sent"))),
              FailsWith(Reason::kUploadNotFound));
  EXPECT_THAT(peer_->sign(shapeSource("collections/none/shapes/s")),
              FailsWith(Reason::kCollectionNotFound));
  ASSERT_OK(peer_->createCollection("c"));
  EXPECT_THAT(peer_->sign(shapeSource("collections/c/shapes/s")),
              FailsWith(Reason::kShapeNotFound));
}

TEST_F(GeometryTest, ALongInlineMeshIsSentBackToUploadMesh) {
  const std::string bytes((4 << 20) + 1, ' ');
  EXPECT_THAT(peer_->sign(inlineSource(bytes)), FailsWith(Reason::kMessageTooLarge));
}

TEST_F(GeometryTest, AMessageAboveEightMebibytesIsTooLarge) {
  const std::string bytes(9 << 20, ' ');
  EXPECT_THAT(peer_->sign(inlineSource(bytes)), FailsWith(Reason::kMessageTooLarge));
}

class SmallServerTest : public GeometryTest {
  void configure(ServerOptions& options) override {
    options.max_faces = 100;
    options.max_upload_bytes = 1000;
    options.data_dir.clear();
  }
};

TEST_F(SmallServerTest, MeshesAboveTheLimitAreRefused) {
  EXPECT_THAT(peer_->sign(inlineSource(smallMesh(1))), FailsWith(Reason::kMeshTooLarge));
  EXPECT_THAT(inspect(inlineSource(smallMesh(1))), FailsWith(Reason::kMeshTooLarge));
  EXPECT_THAT(peer_->upload(smallMesh(1)), FailsWith(Reason::kMeshTooLarge));
}

TEST_F(SmallServerTest, WithoutAStoreOnlyTheCatalogueIsMissing) {
  EXPECT_OK(inspect(inlineSource(sampleFile("ellipsoid", {{"resolution", 1}}))));
  EXPECT_THAT(peer_->createCollection("c"), FailsWith(Reason::kStoreFailure));
  EXPECT_THAT(peer_->sign(shapeSource("collections/c/shapes/s")), FailsWith(Reason::kStoreFailure));
  EXPECT_THAT(peer_->ingest(ingestHeader("c"), {}), FailsWith(Reason::kStoreFailure));
}

}  // namespace
}  // namespace moduli
