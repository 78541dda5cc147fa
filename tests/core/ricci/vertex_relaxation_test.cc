// Single vertices solved on their own, and what that is for: surfaces with needles.

#include "core/ricci/vertex_relaxation.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "core/intrinsic/delaunay.h"
#include "core/ricci/prescribe.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

double curvatureOf(const IntrinsicTriangulation& triangulation, const std::vector<double>& scale,
                   Index v) {
  double sum = 2 * std::numbers::pi;
  for (Index h = 0; h < triangulation.halfedgeCount(); ++h) {
    if (triangulation.tail(h) != v) continue;
    TriangleValues sides;
    Index g = h;
    for (double& side : sides) {
      side =
          triangulation.halfChord(g) * scale[triangulation.tail(g)] * scale[triangulation.head(g)];
      g = Connectivity::next(g);
    }
    sum -= triangleAngles(Geometry::kEuclidean, sides)[1];
  }
  return sum;
}

// Every curvature below a full turn is within reach of one factor: from a vertex that is nearly a
// spike to one with several times the full angle.
TEST(VertexRelaxation, ReachesTheCurvatureOfAVertexFromBothSides) {
  const MetricSurface torus = flatTorus({0.2, 1.1}, 8, 8, 0.2, 1);
  for (const double target : {-6.0, -1.0, 1.0, 5.0}) {
    SCOPED_TRACE(target);
    Context context;
    IntrinsicTriangulation triangulation(torus.surface, torus.lengths);
    std::vector<double> scale(torus.surface.vertexCount(), 1.0);
    ASSERT_OK(flipToDelaunayPtolemy(context, triangulation, scale));
    VertexRelaxation relaxation(Geometry::kEuclidean, triangulation, scale);
    const auto change = relaxation.solve(context, {9}, target, 1e-6);
    ASSERT_OK(change);
    // The flat vertex has to shrink to be left with more angle, and to grow to be left with less.
    EXPECT_GT(*change * target, 0);
    EXPECT_NEAR(scale[9], std::exp(*change / 2), 1e-12);
    EXPECT_NEAR(curvatureOf(triangulation, scale, 9), target, 1e-6 + 1e-12);
    for (Index h = 0; h < triangulation.halfedgeCount(); ++h) {
      EXPECT_FALSE(triangulation.twin(h) == kNone);
    }
  }
}

TEST(VertexRelaxation, LeavesAVertexAloneWhoseTargetIsOutOfReach) {
  const MetricSurface torus = flatTorus({0.2, 1.1}, 6, 6, 0.2, 1);
  Context context;
  IntrinsicTriangulation triangulation(torus.surface, torus.lengths);
  std::vector<double> scale(torus.surface.vertexCount(), 1.0);
  ASSERT_OK(flipToDelaunayPtolemy(context, triangulation, scale));
  VertexRelaxation relaxation(Geometry::kEuclidean, triangulation, scale);
  const auto change = relaxation.solve(context, {3}, 7.0, 1e-6);
  ASSERT_OK(change);
  EXPECT_EQ(*change, 0);
  EXPECT_EQ(scale[3], 1);
}

// A vertex at 1e-5 of a face from a corner in every face, and two cones. In plain doubles the
// rounding of u alone, 4e-16, would leave some 4e-11 in a needle's angle.
TEST(VertexRelaxation, LeavesNewtonsMethodToFindNeedlesToFullPrecision) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const MetricSurface torus =
        insertNearCorners(flatTorus({0.3, 0.9}, 5, 5, 0.2, seed), 1e-5, seed);
    Context context;
    std::vector<double> target(torus.surface.vertexCount(), 0.0);
    target[0] = 1;
    target[12] = -1;
    const auto found = prescribeCurvature(context, torus.surface, torus.lengths, target,
                                          Unknowns::all(torus.surface.vertexCount()));
    ASSERT_OK(found);
    EXPECT_LE(found->certificate.curvature_residual, 4e-12);
    EXPECT_LE(found->certificate.newton_iterations, 30);
  }
}

}  // namespace
}  // namespace moduli
