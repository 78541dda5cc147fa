#include "core/intrinsic/chordal_metric.h"

#include <cmath>

#include "tests/core/testing.h"

namespace moduli {
namespace {

IntrinsicSurface triangle(Geometry geometry, const std::vector<double>& lengths) {
  auto connectivity = Connectivity::fromFaces(3, {{0, 1, 2}});
  return {*std::move(connectivity), lengths, geometry};
}

TEST(ChordLengths, AreThoseOfTheFlatTriangleBetweenTheCorners) {
  const auto flat = chordLengths(triangle(Geometry::kEuclidean, {3, 4, 5}));
  ASSERT_OK(flat);
  EXPECT_EQ(*flat, (std::vector<double>{3, 4, 5}));
  // An octant of the sphere.
  const double quarter = std::acos(0.0);
  const auto octant = chordLengths(triangle(Geometry::kSpherical, {quarter, quarter, quarter}));
  ASSERT_OK(octant);
  for (const double chord : *octant) EXPECT_NEAR(chord, std::sqrt(2.0), 1e-15);
  const auto small = chordLengths(triangle(Geometry::kHyperbolic, {2, 2, 2}));
  ASSERT_OK(small);
  for (const double chord : *small) EXPECT_NEAR(chord, 2 * std::sinh(1.0), 1e-15);
}

TEST(ChordLengths, AHyperbolicTriangleWithoutACircumscribedCircleHasNone) {
  const auto horocyclic = chordLengths(triangle(Geometry::kHyperbolic, {10, 10, 19}));
  EXPECT_THAT(horocyclic, FailsWith(Reason::kUnsupportedContent));
  EXPECT_THAT(horocyclic.status().message(), testing::HasSubstr("face 0"));
  EXPECT_THAT(horocyclic.status().hint(), testing::HasSubstr("Delaunay"));
}

TEST(ChordLengths, BeyondADoubleAreRefused) {
  EXPECT_THAT(chordLengths(triangle(Geometry::kHyperbolic, {1, 2000, 2000})),
              FailsWith(Reason::kOverflow));
}

}  // namespace
}  // namespace moduli
