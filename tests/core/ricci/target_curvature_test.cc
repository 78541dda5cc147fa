#include "core/ricci/target_curvature.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "core/topology/surface_topology.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
constexpr double kPi = std::numbers::pi;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

MetricSurface octahedron() {
  return fromPositions(
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}

MATCHER_P(Says, words,
          std::string("is refused with words that ") +
              ::testing::DescribeMatcher<std::string>(words)) {
  const Status status = statusOf(arg);
  *result_listener << status.toString();
  return status.reason() == Reason::kInvalidOption &&
         ::testing::Matches(::testing::Matcher<std::string>(words))(status.message());
}

Result<std::vector<double>> straight(const MetricSurface& metric, const std::vector<Cone>& cones) {
  return flatTarget(metric.surface, cones, BoundaryRule::kStraight, metric.lengths);
}

double sumOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(FlatTarget, GivesConesTheirCurvatureAndOthersNone) {
  const auto target = straight(octahedron(), {{0, kPi}, {3, kPi}, {4, 3 * kPi / 2}, {5, kPi / 2}});
  ASSERT_OK(target);
  const std::vector<double> wanted{kPi, 0, 0, kPi, 1.5 * kPi, 0.5 * kPi};
  for (int v = 0; v < 6; ++v) EXPECT_NEAR((*target)[v], wanted[v], 1e-15);
  const auto none = straight(flatTorus({0, 1}, 3, 3, 0.1, 1), {});
  ASSERT_OK(none);
  EXPECT_EQ(*none, std::vector<double>(9, 0.0));
}

TEST(FlatTarget, NamesTheVertexOfABadCone) {
  const MetricSurface sphere = octahedron();
  EXPECT_THAT(straight(sphere, {{6, kPi}}), Says(AllOf(HasSubstr("vertex 6"), HasSubstr("has 6"))));
  EXPECT_THAT(straight(sphere, {{-1, kPi}}), Says(HasSubstr("vertex -1")));
  EXPECT_THAT(straight(sphere, {{2, kPi}, {4, kPi}, {2, 0}}),
              Says(AllOf(HasSubstr("vertex 2"), HasSubstr("two cones"))));
  for (const double value : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_THAT(straight(sphere, {{3, value}}),
                Says(AllOf(HasSubstr("vertex 3"), HasSubstr("finite"))));
  }
}

TEST(FlatTarget, RefusesCurvaturesThatLeaveNoAngle) {
  EXPECT_THAT(straight(octahedron(), {{1, 2 * kPi}, {2, kPi}, {3, kPi}}),
              Says(AllOf(HasSubstr("vertex 1"), HasSubstr("(2 pi)"), HasSubstr("below 2 pi"))));
  EXPECT_THAT(straight(octahedron(), {{4, 2.5 * kPi}, {2, 1.5 * kPi}}),
              Says(HasSubstr("vertex 4")));
  // Vertex 0 of a plate is a corner. Half a turn less there is allowed inside only.
  const MetricSurface square = plate(2, 2, {});
  ASSERT_TRUE(square.surface.isBoundaryVertex(0));
  EXPECT_THAT(straight(square, {{0, kPi}, {1, kPi / 2}}),
              Says(AllOf(HasSubstr("vertex 0"), HasSubstr("boundary"), HasSubstr("below pi"))));
}

TEST(FlatTarget, NamesBothSidesOfASumThatIsWrong) {
  EXPECT_THAT(straight(octahedron(), {}),
              Says(AllOf(HasSubstr("sum up to 0 (0 pi)"), HasSubstr("(4 pi)"))));
  EXPECT_THAT(straight(octahedron(), {{0, kPi}, {1, kPi}, {2, kPi}}),
              Says(AllOf(HasSubstr("(3 pi)"), HasSubstr("(4 pi)"))));
  EXPECT_THAT(straight(flatTorus({0, 1}, 3, 3, 0.1, 1), {{0, 0.5}}), Says(HasSubstr("(0 pi)")));
  EXPECT_THAT(straight(squareTiledL(), {}), Says(HasSubstr("(-4 pi)")));
  EXPECT_THAT(straight(plate(2, 2, {}), {}), Says(HasSubstr("(2 pi)")));
}

TEST(FlatTarget, CompletesTypedFigures) {
  // 8 cones of pi / 2 = 1.5707963... with five decimals: each is off by 4e-6, and comes right.
  std::vector<Cone> cones;
  for (const Index v : {0, 1, 2, 3}) cones.push_back({v, 3.14159});
  const auto target = straight(octahedron(), cones);
  ASSERT_OK(target);
  for (int v = 0; v < 4; ++v) EXPECT_NEAR((*target)[v], kPi, 1e-15);
  EXPECT_NEAR(sumOf(*target), 4 * kPi, 1e-14);
  EXPECT_EQ((*target)[4], 0);
  // Four decimals are no rounding of that kind any more.
  for (Cone& cone : cones) cone.curvature = 3.1416 + 1e-5;
  EXPECT_THAT(straight(octahedron(), cones), Says(HasSubstr("sum up to")));
  cones.pop_back();
  EXPECT_THAT(straight(octahedron(), cones), Says(HasSubstr("sum up to")));
}

TEST(FlatTarget, TurnsLoopsEvenlyByLength) {
  // A plate of 7 x 5 with two holes of different size: the outer loop turns by 2 pi, each hole by
  // -2 pi, and every vertex by the half of its two edges.
  const MetricSurface metric = plate(7, 5, {{1, 1}, {2, 1}, {4, 3}});
  const auto target = flatTarget(metric.surface, {}, BoundaryRule::kCircle, metric.lengths);
  ASSERT_OK(target);
  const SurfaceTopology topology = computeTopology(metric.surface);
  ASSERT_EQ(topology.boundary_loops.size(), 3U);
  std::multiset<int> sizes;
  for (const std::vector<Index>& loop : topology.boundary_loops) {
    sizes.insert(static_cast<int>(loop.size()));
    // All edges are of length 1.
    const double turning = loop.size() == 24 ? 2 * kPi : -2 * kPi;
    for (const Index h : loop) {
      EXPECT_NEAR((*target)[metric.surface.tail(h)], turning / static_cast<double>(loop.size()),
                  1e-14);
    }
  }
  EXPECT_EQ(sizes, (std::multiset<int>{4, 6, 24}));
  for (Index v = 0; v < metric.surface.vertexCount(); ++v) {
    EXPECT_TRUE(metric.surface.isBoundaryVertex(v) || (*target)[v] == 0);
  }
}

TEST(FlatTarget, WeighsBoundaryVerticesByTheLengthAroundThem) {
  // A triangle about a centre, sides 3, 4, 5: turning shares of (3 + 5), (3 + 4), (4 + 5) in 24.
  const MetricSurface metric = fromPositions({{0, 0, 0}, {3, 0, 0}, {3, 4, 0}, {2, 1, 0}},
                                             {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  const auto target = flatTarget(metric.surface, {}, BoundaryRule::kCircle, metric.lengths);
  ASSERT_OK(target);
  EXPECT_NEAR((*target)[0], 2 * kPi * 8 / 24, 1e-14);
  EXPECT_NEAR((*target)[1], 2 * kPi * 7 / 24, 1e-14);
  EXPECT_NEAR((*target)[2], 2 * kPi * 9 / 24, 1e-14);
  EXPECT_EQ((*target)[3], 0);
  // A cone inside or on the boundary is taken from the rest.
  const auto inner = flatTarget(metric.surface, {{3, 1.0}}, BoundaryRule::kCircle, metric.lengths);
  ASSERT_OK(inner);
  EXPECT_NEAR((*inner)[0], (2 * kPi - 1) * 8 / 24, 1e-14);
  const auto outer = flatTarget(metric.surface, {{0, 1.0}}, BoundaryRule::kCircle, metric.lengths);
  ASSERT_OK(outer);
  EXPECT_EQ((*outer)[0], 1.0);
  EXPECT_NEAR((*outer)[1], (2 * kPi - 1) * 7 / 16, 1e-14);
  EXPECT_NEAR((*outer)[2], (2 * kPi - 1) * 9 / 16, 1e-14);
}

TEST(FlatTarget, OfAnAnnulusTurnsByNothingInSum) {
  const MetricSurface frame = squareFrame(3, 1);
  const auto target = flatTarget(frame.surface, {}, BoundaryRule::kCircle, frame.lengths);
  ASSERT_OK(target);
  EXPECT_NEAR(sumOf(*target), 0, 1e-13);
}

TEST(FlatTarget, AsksNothingOfAFreeBoundary) {
  // No sum to obey, and any number on the boundary; inside the rules stay.
  const MetricSurface square = plate(2, 2, {});
  const auto free = [&](const std::vector<Cone>& cones) {
    return flatTarget(square.surface, cones, BoundaryRule::kFree, square.lengths);
  };
  Index inner = 0;
  while (square.surface.isBoundaryVertex(inner)) ++inner;
  const auto target = free({{inner, 1.25}});
  ASSERT_OK(target);
  EXPECT_EQ((*target)[inner], 1.25);
  EXPECT_OK(free({}));
  EXPECT_OK(free({{0, 3 * kPi}}));
  EXPECT_THAT(free({{inner, 2 * kPi}}), Says(HasSubstr("vertex " + std::to_string(inner))));
}

TEST(FlatTarget, TakesTheBoundaryRuleOfAClosedSurfaceForNothing) {
  const MetricSurface torus = flatTorus({0, 1}, 3, 3, 0.1, 1);
  for (const BoundaryRule rule :
       {BoundaryRule::kFree, BoundaryRule::kCircle, BoundaryRule::kStraight}) {
    EXPECT_OK(flatTarget(torus.surface, {}, rule, torus.lengths));
    EXPECT_THAT(flatTarget(torus.surface, {{0, 1.0}}, rule, torus.lengths),
                Says(HasSubstr("sum up to")));
  }
}

TEST(CheckAdmissible, AsksForMoreThanTheCharacteristicInTheHyperbolicPlane) {
  const MetricSurface genus2 = octahedronCover();
  const std::vector<double> none(genus2.surface.vertexCount(), 0.0);
  EXPECT_OK(checkAdmissible(Geometry::kHyperbolic, genus2.surface, none));
  const std::vector<double> flat(6, -4 * kPi / 6);
  EXPECT_OK(checkAdmissible(Geometry::kEuclidean, genus2.surface, flat));
  // No area is left, or less than none.
  for (const double excess : {-1e-9, -1.0}) {
    std::vector<double> less = flat;
    less[0] += excess;
    EXPECT_THAT(checkAdmissible(Geometry::kHyperbolic, genus2.surface, less),
                Says(AllOf(HasSubstr("more than"), HasSubstr("(-4 pi)"))));
  }
  EXPECT_THAT(checkAdmissible(Geometry::kEuclidean, genus2.surface, none),
              Says(HasSubstr("(-4 pi)")));
  EXPECT_THAT(
      checkAdmissible(Geometry::kHyperbolic, octahedron().surface, std::vector<double>(6, 0.0)),
      Says(AllOf(HasSubstr("more than"), HasSubstr("(4 pi)"))));
}

TEST(CheckAdmissible, NamesTheVertex) {
  const MetricSurface genus2 = octahedronCover();
  for (const Geometry geometry : {Geometry::kEuclidean, Geometry::kHyperbolic}) {
    std::vector<double> target(6, 0.0);
    target[4] = kNaN;
    EXPECT_THAT(checkAdmissible(geometry, genus2.surface, target),
                Says(AllOf(HasSubstr("vertex 4"), HasSubstr("not finite"))));
    target[4] = 2 * kPi;
    EXPECT_THAT(checkAdmissible(geometry, genus2.surface, target),
                Says(AllOf(HasSubstr("vertex 4"), HasSubstr("below 2 pi"))));
  }
}

}  // namespace
}  // namespace moduli
