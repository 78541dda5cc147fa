#include <cmath>

#include "tests/server/service/fixture.h"

/// The Parameterize call with the targets that lay a surface into the plane: what it sends beside
/// the arrays that all have, and what it refuses.
namespace moduli {
namespace {

using Options = v1::ParameterizationOptions;
using testing::HasSubstr;

struct Answer {
  std::string atlas;
  int atlas_rows = -1;
  v1::Parameterization result;
};

class PlaneTargetsTest : public ServiceTest {
 protected:
  Result<Answer> call(const v1::ParameterizeRequest& request) {
    grpc::ClientContext context;
    const auto reader = peer_->geometry().Parameterize(&context, request);
    Answer answer;
    for (v1::ParameterizeResponse event; reader->Read(&event);) {
      if (event.array().array() == v1::ArrayChunk::ATLAS_JSON) {
        answer.atlas += event.array().data();
        answer.atlas_rows = event.array().rows();
      }
      if (event.has_parameterization()) answer.result = event.parameterization();
    }
    if (const grpc::Status status = reader->Finish(); !status.ok()) return fromGrpcStatus(status);
    return answer;
  }

  std::string detailsOf(const v1::ParameterizeRequest& request) {
    grpc::ClientContext context;
    const auto reader = peer_->geometry().Parameterize(&context, request);
    for (v1::ParameterizeResponse event; reader->Read(&event);) {
    }
    const grpc::Status status = reader->Finish();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    return status.error_details();
  }
};

v1::ParameterizeRequest requestOf(const std::string& bytes, Options::Target target) {
  v1::ParameterizeRequest request;
  *request.mutable_source() = inlineSource(bytes);
  request.mutable_options()->set_target(target);
  return request;
}

std::string torus() {
  return sampleFile("torus", {{"resolution", 8}});
}

std::string ball() {
  return sampleFile("sphere", {{"resolution", 6}});
}

TEST_F(PlaneTargetsTest, EachTargetSendsItsOwnPartAndNoOther) {
  const auto flat_torus = call(requestOf(torus(), Options::TORUS));
  ASSERT_OK(flat_torus);
  EXPECT_EQ(flat_torus->result.torus().generators_size(), 2);
  EXPECT_FALSE(flat_torus->result.has_cone_metric());
  EXPECT_FALSE(flat_torus->result.has_method());
  EXPECT_TRUE(flat_torus->atlas.empty());

  const auto squares = call(requestOf(torus(), Options::QUADS));
  ASSERT_OK(squares);
  EXPECT_EQ(squares->result.quads().periods_size(), 2);
  EXPECT_FALSE(squares->result.has_torus());

  const auto cubes = call(requestOf(ball(), Options::POLYCUBE));
  ASSERT_OK(cubes);
  EXPECT_GE(cubes->result.cone_metric().cones_size(), 8);
  EXPECT_TRUE(cubes->result.cone_metric().has_spread());
  EXPECT_TRUE(cubes->result.certificate().has_holonomy_residual());
}

TEST_F(PlaneTargetsTest, AnAtlasTravelsAsTextUnlessArraysAreOmitted) {
  v1::ParameterizeRequest request = requestOf(ball(), Options::ATLAS);
  const auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_EQ(answer->result.cone_metric().cones_size(), 3);
  EXPECT_EQ(static_cast<int>(answer->atlas.size()), answer->atlas_rows);
  EXPECT_THAT(answer->atlas, HasSubstr("\"moduli-affine-atlas\""));
  EXPECT_TRUE(answer->atlas.ends_with("}\n"));
  request.set_omit_arrays(true);
  const auto bare = call(request);
  ASSERT_OK(bare);
  EXPECT_TRUE(bare->atlas.empty());
  EXPECT_EQ(bare->result.atlas().charts(), answer->result.atlas().charts());
}

TEST_F(PlaneTargetsTest, ChosenConesHaveTheQuantumAndTheNumberAskedFor) {
  v1::ParameterizeRequest request = requestOf(ball(), Options::FLAT);
  v1::ConeChoice& choice = *request.mutable_options()->mutable_cone_choice();
  choice.set_quarter_turns(true);
  choice.set_most(9);
  const auto answer = call(request);
  ASSERT_OK(answer);
  const auto& cones = answer->result.cone_metric().cones();
  EXPECT_LE(cones.size(), 9);
  for (const v1::Cone& cone : cones) {
    const double quarters = cone.curvature() / std::acos(0.0);
    EXPECT_NEAR(quarters, std::round(quarters), 1e-12);
  }
  choice.set_most(2);
  EXPECT_THAT(call(request), FailsWith(Reason::kInvalidOption)) << "a theorem wants three";
}

TEST_F(PlaneTargetsTest, OverlapsStayOnRequestAndOutputsAreTheSameEachTime) {
  v1::ParameterizeRequest request = requestOf(ball(), Options::POLYCUBE);
  request.mutable_options()->set_cut_overlaps(false);
  const auto kept = call(request);
  ASSERT_OK(kept);
  EXPECT_EQ(kept->result.layout().islands(), 1);
  const auto again = call(request);
  ASSERT_OK(again);
  EXPECT_EQ(kept->result.certificate().SerializeAsString(),
            again->result.certificate().SerializeAsString());
}

TEST_F(PlaneTargetsTest, WrongRequestsNameTheirField) {
  v1::ParameterizeRequest request = requestOf(torus(), Options::TORUS);
  Options& options = *request.mutable_options();
  options.mutable_cone_choice();
  EXPECT_THAT(detailsOf(request), HasSubstr("options.cone_choice"));
  options.set_target(Options::FLAT);
  options.mutable_cone_choice()->set_spread(-1);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.cone_choice.spread"));
  options.mutable_cone_choice()->set_spread(1);
  options.mutable_cone_choice()->set_most(-1);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.cone_choice.most"));
  options.mutable_cone_choice()->clear_most();
  options.set_boundary(Options::CIRCLE);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.boundary"));
  options.clear_boundary();
  options.add_cones()->set_vertex(0);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.cone_choice"));
  options.clear_cones();
  options.set_target(Options::POLYCUBE);
  options.mutable_cone_choice()->set_quarter_turns(true);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.cone_choice.quarter_turns"));
  options.clear_cone_choice();
  options.add_extraordinary(1);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.extraordinary"));
  options.clear_extraordinary();
  options.set_most_squares(100);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.most_squares"));
  options.set_target(Options::QUADS);
  options.set_most_squares(0);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.most_squares"));
  options.clear_most_squares();
  options.set_target(Options::TORUS);
  options.set_cut_overlaps(true);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.cut_overlaps"));
  options.clear_cut_overlaps();
  options.set_margin(0.1);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.margin"));
  options.set_target(Options::ATLAS);
  options.set_margin(-0.1);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.margin"));
  options.clear_margin();
  options.add_seams()->add_vertices(3);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.seams[0]"));
  options.set_target(Options::QUADS);
  EXPECT_THAT(detailsOf(request), HasSubstr("options.seams"));
  options.clear_seams();
  request.mutable_prepare()->set_component("all");
  EXPECT_THAT(detailsOf(request), HasSubstr("prepare.component"));
}

}  // namespace
}  // namespace moduli
