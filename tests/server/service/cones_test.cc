#include "server/service/cones.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numbers>

#include "server/rpc/convert_parameterization.h"
#include "server/service/parameterizing.h"
#include "server/service/request.h"
#include "tests/core/mesh/shapes.h"
#include "tests/core/testing.h"

/// Cones and options of a request before anything is computed, and what is sent after it.
namespace moduli {
namespace {

using Options = v1::ParameterizationOptions;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

/// A prepared surface and where its vertices came from.
struct Stage {
  explicit Stage(const TriangleSoup& soup, bool repair = false, const std::string& component = "")
      : prepared(prepare(soup, repair, component)),
        places(findVertexPlaces(soup, prepared, inputCorners(soup, prepared))) {}

  static PreparedMesh prepare(const TriangleSoup& soup, bool repair, const std::string& component) {
    Context context;
    auto result = prepareMesh(context, soup, {{repair, {}}, component});
    EXPECT_OK(result);
    return *std::move(result);
  }

  const Connectivity& surface() const { return prepared.mesh.connectivity(); }
  Result<std::vector<Cone>> place(const std::vector<Cone>& cones) const {
    return conesOnSurface(messages(cones), surface(), places);
  }
  Result<BoundaryRule> rule(Options::Boundary wanted, const std::vector<Cone>& cones) const {
    const auto placed = place(cones);
    EXPECT_OK(placed);
    return boundaryRule(wanted, messages(cones), *placed, surface());
  }
  static ConeMessages messages(const std::vector<Cone>& cones) {
    ConeMessages messages;
    for (const Cone& cone : cones) {
      messages.Add()->set_vertex(cone.vertex);
      messages.rbegin()->set_curvature(cone.curvature);
    }
    return messages;
  }

  PreparedMesh prepared;
  VertexPlaces places;
};

// The one place where tests look up what a refusal says.
std::string refusal(const Result<std::vector<Cone>>& result) {
  EXPECT_THAT(result, FailsWith(Reason::kInvalidOption));
  return result.status().message();
}

TriangleSoup withIsolatedVertexInFront(TriangleSoup soup) {
  soup.vertices.insert(soup.vertices.begin(), Eigen::Vector3d(9, 9, 9));
  for (Triangle& face : soup.faces) {
    for (Index& v : face) ++v;
  }
  return soup;
}

TEST(Cones, MoveToTheVerticesOfThePreparedSurface) {
  const Stage stage(withIsolatedVertexInFront(shapes::icosahedron()));
  const auto cones = stage.place({{12, 1.5}, {1, -2}});
  ASSERT_OK(cones);
  ASSERT_EQ(cones->size(), 2U);
  EXPECT_EQ((*cones)[0].vertex, 11);
  EXPECT_EQ((*cones)[0].curvature, 1.5);
  EXPECT_EQ((*cones)[1].vertex, 0);
}

TEST(Cones, AreRefusedByTheNumberThatTheFileGivesThem) {
  const Stage stage(withIsolatedVertexInFront(shapes::icosahedron()));
  EXPECT_THAT(refusal(stage.place({{13, 1}})),
              HasSubstr("vertex 13, but the mesh has vertices 0 to 12"));
  EXPECT_THAT(refusal(stage.place({{0, 1}})), HasSubstr("vertex 0, which no face uses"));
  EXPECT_THAT(refusal(stage.place({{3, 1}, {3, 1}})), HasSubstr("vertex 3 is given twice"));
  EXPECT_THAT(refusal(stage.place({{5, 2 * kPi}})), HasSubstr("vertex 5 of curvature 6.28"));
}

TEST(Cones, OnTheBoundaryHaveHalfTheRoom) {
  const Stage stage(withIsolatedVertexInFront(shapes::disk()));
  EXPECT_OK(stage.place({{1, 3.1}}));
  EXPECT_THAT(
      refusal(stage.place({{1, kPi}})),
      HasSubstr("vertex 1 of curvature 3.141592653589793: on the boundary it must be below pi"));
}

TEST(Cones, AreNotInOtherComponents) {
  const TriangleSoup soup = shapes::together(shapes::tetrahedron(), shapes::octahedron());
  const Stage stage(soup, false, "1");
  const auto cones = stage.place({{4, 1}});
  ASSERT_OK(cones);
  EXPECT_EQ((*cones)[0].vertex, 0);
  EXPECT_THAT(refusal(stage.place({{3, 1}})),
              HasSubstr("vertex 3, whose faces are in another component"));
}

TEST(Cones, FollowARepair) {
  TriangleSoup soup = shapes::tetrahedron();
  soup.vertices.push_back(Eigen::Vector3d(soup.vertices[1]));
  soup.faces[1][2] = 4;
  const Stage stage(soup, true);
  const auto cones = stage.place({{4, 1}});
  ASSERT_OK(cones);
  EXPECT_EQ((*cones)[0].vertex, 1) << "vertex 4 was welded to vertex 1";
  EXPECT_THAT(refusal(stage.place({{1, 1}, {4, 1}})),
              HasSubstr("vertex 4 and one at vertex 1, which repair has welded to it"));
}

TEST(BoundaryRules, AreAsWantedWhereNoConeIsInTheirWay) {
  const Stage stage(shapes::disk());
  const std::vector<Cone> none;
  EXPECT_EQ(*stage.rule(Options::BOUNDARY_UNSPECIFIED, none), BoundaryRule::kFree);
  EXPECT_EQ(*stage.rule(Options::CIRCLE, none), BoundaryRule::kCircle);
  EXPECT_EQ(*stage.rule(Options::STRAIGHT, none), BoundaryRule::kStraight);
  EXPECT_EQ(*stage.rule(Options::FREE, none), BoundaryRule::kFree);
}

TEST(BoundaryRules, AConeOnTheBoundaryWantsItStraight) {
  const Stage stage(shapes::disk());
  EXPECT_EQ(*stage.rule(Options::BOUNDARY_UNSPECIFIED, {{0, kPi / 2}}), BoundaryRule::kStraight);
  EXPECT_EQ(*stage.rule(Options::STRAIGHT, {{0, kPi / 2}}), BoundaryRule::kStraight);
  EXPECT_EQ(*stage.rule(Options::CIRCLE, {{0, kPi / 2}}), BoundaryRule::kCircle);
  const auto free = stage.rule(Options::FREE, {{0, kPi / 2}});
  EXPECT_THAT(free, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(free.status().message(), HasSubstr("vertex 0 is on the boundary"));
}

TEST(ParameterizationMessages, WhatIsUnspecifiedHasItsDefault) {
  const FlatOptions options = fromProto(Options());
  EXPECT_EQ(options.scheme, FlatOptions().scheme);
  EXPECT_EQ(options.solver, FlatOptions().solver);
  EXPECT_EQ(options.boundary, FlatOptions().boundary);
  EXPECT_TRUE(options.initial_delaunay);
}

TEST(ParameterizationMessages, ChoicesTravel) {
  Options message;
  message.set_boundary(Options::FREE);
  message.set_scheme(Options::TANGENTIAL);
  message.set_solver(Options::FLOW);
  message.set_initial_delaunay(false);
  const FlatOptions options = fromProto(message);
  EXPECT_EQ(options.boundary, BoundaryRule::kFree);
  EXPECT_EQ(options.scheme, Scheme::kTangential);
  EXPECT_EQ(options.solver, RicciSolver::kFlow);
  EXPECT_FALSE(options.initial_delaunay);
}

TEST(ParameterizationMessages, NumbersThatAreNotFiniteStayBehind) {
  MapCertificate certificate;
  certificate.quality.max_dilatation = std::numeric_limits<double>::infinity();
  certificate.quality.flipped_faces = 3;
  certificate.newton_iterations = 4;
  certificate.warnings = {"a"};
  v1::ParameterizationCertificate message = toProto(certificate);
  EXPECT_FALSE(message.has_max_dilatation());
  EXPECT_EQ(message.mean_dilatation(), 1);
  EXPECT_EQ(message.flipped_faces(), 3);
  EXPECT_TRUE(message.has_newton_iterations());
  EXPECT_FALSE(message.has_clamped_fraction());
  EXPECT_EQ(message.warnings_size(), 1);
  certificate.clamped_fraction = 0;
  EXPECT_TRUE(toProto(certificate).has_clamped_fraction());
}

TEST(ParameterizationRequests, AreRefusedByField) {
  const auto field = [](const Options& options) {
    const Refusal refusal = checkParameterization(options, "options");
    return refusal.ok() ? "" : refusal.field;
  };
  Options options;
  EXPECT_EQ(field(options), "options.target");
  options.set_target(static_cast<Options::Target>(77));
  EXPECT_EQ(field(options), "options.target");
  options.set_target(Options::FLAT);
  EXPECT_EQ(field(options), "");
  options.set_boundary(static_cast<Options::Boundary>(77));
  EXPECT_EQ(field(options), "options.boundary");
  options.clear_boundary();
  options.set_scheme(static_cast<Options::Scheme>(-1));
  EXPECT_EQ(field(options), "options.scheme");
  options.clear_scheme();
  options.set_solver(static_cast<Options::Solver>(9));
  EXPECT_EQ(field(options), "options.solver");
  options.clear_solver();
  options.add_cones()->set_curvature(1);
  options.add_cones()->set_vertex(-1);
  EXPECT_EQ(field(options), "options.cones[1].vertex");
  options.mutable_cones(1)->set_vertex(1);
  options.mutable_cones(1)->set_curvature(std::nan(""));
  EXPECT_EQ(field(options), "options.cones[1].curvature");
}

TEST(ParameterizationParts, AreChunksOfAtMostAMebibyteAndTheResultLast) {
  auto surface = std::make_shared<ParameterizedSurface>();
  for (int i = 0; i < 100'000; ++i) surface->positions.emplace_back(i, 0.5 * i, -i);
  surface->faces = {{0, 1, 2}};
  surface->corners = {{kNone, kNone, kNone}};
  surface->result.set_target(Options::FLAT);
  const auto next = parameterizationParts(surface, false);
  std::string positions;
  std::vector<v1::ArrayChunk> chunks;
  auto part = next();
  for (; part && part->has_array(); part = next()) {
    EXPECT_LE(part->array().data().size(), kMaxChunkBytes);
    if (part->array().array() == v1::ArrayChunk::POSITIONS) {
      EXPECT_EQ(part->array().offset(), static_cast<std::int64_t>(positions.size()));
      EXPECT_EQ(part->array().rows(), 100'000);
      positions += part->array().data();
    }
    chunks.push_back(part->array());
  }
  ASSERT_TRUE(part && part->has_parameterization());
  EXPECT_EQ(part->parameterization().target(), Options::FLAT);
  EXPECT_FALSE(next());
  ASSERT_EQ(chunks.size(), 6U) << "three of positions, one of each other array";
  ASSERT_EQ(positions.size(), 2'400'000U);
  EXPECT_EQ(std::memcmp(positions.data(), surface->positions.data(), positions.size()), 0);
  EXPECT_EQ(chunks[4].array(), v1::ArrayChunk::POINTS);
  EXPECT_EQ(chunks[4].rows(), 0) << "an empty array tells its shape";
  EXPECT_EQ(chunks[5].data(), std::string(12, '\xFF'));

  const auto alone = parameterizationParts(surface, true);
  EXPECT_TRUE(alone()->has_parameterization());
  EXPECT_FALSE(alone());
}

}  // namespace
}  // namespace moduli
