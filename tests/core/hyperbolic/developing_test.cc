#include "core/hyperbolic/developing.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/intrinsic/intrinsic_samples.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

HyperbolicTriangles sample(const std::string& kind) {
  return *hyperbolicTriangles(*makeIntrinsicSample(kind));
}

class Regular : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Samples, Regular, testing::Values("bolza", "klein"));

TEST_P(Regular, ChangesOfCoordinatesCloseAroundEveryVertex) {
  Context context;
  const auto development = develop(context, sample(GetParam()));
  ASSERT_OK(development);
  // Eight factors or fewer, with entries below 3, each right to some 1e-16.
  EXPECT_LE(development->certificate.vertex_residual, 1e-13);
  EXPECT_LE(development->certificate.determinant_drift, 1e-14);
}

TEST_P(Regular, CornerFramesEndWhereTheNextCornerIs) {
  const HyperbolicTriangles triangles = sample(GetParam());
  for (Index h = 0; h < triangles.surface.halfedgeCount(); ++h) {
    const Su11 end = cornerFrame(triangles, h) * translation(triangles.lengths[h]);
    const Su11 next = cornerFrame(triangles, Connectivity::next(h));
    EXPECT_LE(std::abs(imageOf(end, 0.0) - imageOf(next, 0.0)), 1e-14);
    // There the direction turns to the left by pi less the angle.
    const double turn = std::numbers::pi - triangles.angles[Connectivity::next(h)];
    EXPECT_LE(distanceUpToSign(end * rotation(turn), next), 1e-14);
  }
}

TEST_P(Regular, FacesMeetAlongTheEdgesThroughWhichTheyWereEntered) {
  const HyperbolicTriangles triangles = sample(GetParam());
  const Connectivity& surface = triangles.surface;
  Context context;
  const auto development = develop(context, triangles);
  ASSERT_OK(development);
  const auto corner = [&](Index h) {
    return imageOf(development->placed[Connectivity::faceOf(h)] * cornerFrame(triangles, h), 0.0);
  };
  int entered = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const Index h = development->entry[f];
    if (h == kNone) {
      EXPECT_EQ(f, development->root);
      continue;
    }
    ++entered;
    const Index twin = surface.twin(h);
    EXPECT_LE(std::abs(corner(h) - corner(Connectivity::next(twin))), 1e-13);
    EXPECT_LE(std::abs(corner(twin) - corner(Connectivity::next(h))), 1e-13);
  }
  EXPECT_EQ(entered, surface.faceCount() - 1);
}

TEST_P(Regular, EveryRootSeesTheSameOfASurfaceWhoseFacesAreAllAlike) {
  const HyperbolicTriangles triangles = sample(GetParam());
  Context context;
  DevelopOptions options;
  options.root = 0;
  const double radius = develop(context, triangles, options)->certificate.radius;
  for (Index f = 1; f < triangles.surface.faceCount(); ++f) {
    options.root = f;
    const auto development = develop(context, triangles, options);
    ASSERT_OK(development);
    // Of faces equally far away any may be placed first, but none goes further.
    EXPECT_NEAR(development->certificate.radius, radius, 1e-12);
  }
}

TEST_P(Regular, LoopsAroundAFaceAreTrivialAndEdgesBackAndForthToo) {
  const HyperbolicTriangles triangles = sample(GetParam());
  Context context;
  const auto development = develop(context, triangles);
  ASSERT_OK(development);
  for (Index h = 0; h < triangles.surface.halfedgeCount(); h += 3) {
    EXPECT_EQ(distanceToUnit(holonomy(triangles.surface, *development, {h, h + 1, h + 2})), 0);
    // From the other side the walk goes around all neighbours.
    const Index twin = triangles.surface.twin(h);
    EXPECT_LE(distanceToUnit(holonomy(triangles.surface, *development, {h, twin})), 1e-13);
  }
}

TEST(Develop, NoticesAConeOfATenthOfADegree) {
  for (const Index h : {3, 4, 5}) {
    HyperbolicTriangles triangles = sample("bolza");
    triangles.angles[h] += 0.1 * std::numbers::pi / 180;
    Context context;
    EXPECT_THAT(develop(context, triangles), FailsWith(Reason::kResidualTooLarge));
  }
}

TEST(Develop, RefusesSurfacesWithoutAHyperbolicMetric) {
  IntrinsicSurface surface = *makeIntrinsicSample("bolza");
  surface.geometry = Geometry::kEuclidean;
  EXPECT_THAT(hyperbolicTriangles(surface), FailsWith(Reason::kInvalidMetric));
  surface.geometry = Geometry::kHyperbolic;
  surface.lengths.assign(surface.lengths.size(), 1.0);
  EXPECT_THAT(hyperbolicTriangles(surface), FailsWith(Reason::kInvalidMetric));
  const std::vector<Triangle> faces = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  const IntrinsicSurface sphere{*Connectivity::fromFaces(4, faces), std::vector<double>(6, 1.0),
                                Geometry::kHyperbolic};
  EXPECT_THAT(hyperbolicTriangles(sphere), FailsWith(Reason::kUnsupportedTopology));
  const IntrinsicSurface disk{
      *Connectivity::fromFaces(3, {{0, 1, 2}}), {1, 1, 1}, Geometry::kHyperbolic};
  EXPECT_THAT(hyperbolicTriangles(disk), FailsWith(Reason::kUnsupportedTopology));
}

TEST(Develop, StopsWhenCancelled) {
  CancelToken token;
  token.cancel();
  Context context;
  context.setCancelToken(token);
  EXPECT_THAT(develop(context, sample("klein")), FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
