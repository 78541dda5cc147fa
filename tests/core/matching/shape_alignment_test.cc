#include "core/matching/shape_alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/matching/map_report.h"
#include "core/mesh/sample_tools.h"
#include "tests/core/matching/lumps.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

TriangleMesh meshOf(TriangleSoup soup) {
  return *TriangleMesh::fromSoup(std::move(soup));
}

/// The lump with waves on it, some twentieth of its size long and high a sixth of that.
TriangleSoup wavy(TriangleSoup soup) {
  for (Vector3d& p : soup.vertices) {
    const Vector3d q = p;
    p *= 1 + 0.07 * std::sin(13 * q[0]) * std::sin(13 * q[1]) * std::sin(13 * q[2]);
  }
  return soup;
}

TriangleSoup moved(TriangleSoup soup) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2.1, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  for (Vector3d& p : soup.vertices) p = 37 * (turn * p) + Vector3d(100, -20, 3);
  return soup;
}

/// Every twentieth vertex, and where it goes by number, off by up to a twentieth of the root of the
/// area: as modes may have it.
struct Rough {
  std::vector<Index> samples;
  std::vector<Vector3d> targets;
};

Rough roughly(const TriangleMesh& b) {
  SampleRandom random(5);
  Rough rough;
  const double off = 0.1 * std::sqrt(b.area());
  for (Index v = 0; v < b.vertexCount(); v += 20) {
    rough.samples.push_back(v);
    const Vector3d by(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
    rough.targets.push_back(b.positions()[v] + off * by);
  }
  return rough;
}

std::optional<ShapeAlignment> alignRoughly(const TriangleMesh& a, const TriangleMesh& b,
                                           double most) {
  Context context;
  const Rough rough = roughly(b);
  return *alignShapes(context, a, b, rough.samples, rough.targets, most);
}

/// Mean distance of the points from the vertices of one number, over the root of the area.
double meanError(const TriangleMesh& b, const std::vector<SurfacePoint>& points) {
  double sum = 0;
  for (Index v = 0; v < b.vertexCount(); ++v) {
    sum += (spacePoint(b.connectivity(), b.positions(), points[v]) - b.positions()[v]).norm();
  }
  return sum / (b.vertexCount() * std::sqrt(b.area()));
}

TEST(ShapeAlignment, OfACopyThatWasMovedIsExactAndSmoothsNothing) {
  const TriangleMesh a = meshOf(wavy(lump(16, 1))), b = meshOf(moved(wavy(lump(16, 1))));
  const auto found = alignRoughly(a, b, 0.03);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->smoothing, 0);
  // Rounds go on while the gap falls, at most 40; each halves it or better, from a twentieth on.
  // Half as many leave 5e-8.
  EXPECT_LT(found->gap, 5e-8);
  EXPECT_LT(meanError(b, found->points), 5e-8);
}

TEST(ShapeAlignment, FindsPlacesThroughReliefOnEitherSurface) {
  const TriangleMesh smooth = meshOf(moved(lump(24, 1))), relief = meshOf(wavy(lump(24, 1)));
  // Waves 0.07 high (of up to 2 from the centre) over the root of an area of about 17 are 0.02 to
  // 0.03 at their tops; their places are off by a part of that, and normals of theirs do not
  // matter.
  const auto there = alignRoughly(relief, smooth, 0.03);
  ASSERT_TRUE(there);
  EXPECT_GT(there->smoothing, 0);
  EXPECT_FALSE(there->of_second);
  EXPECT_LT(meanError(smooth, there->points), 0.01);
  const auto back = alignRoughly(smooth, relief, 0.03);
  ASSERT_TRUE(back);
  EXPECT_GT(back->smoothing, 0);
  EXPECT_TRUE(back->of_second);
  EXPECT_LT(meanError(relief, back->points), 0.01);
}

TEST(ShapeAlignment, IsTheSameForAMovedSurface) {
  const TriangleMesh relief = meshOf(wavy(lump(16, 1))), smooth = meshOf(lump(16, 1)),
                     other = meshOf(moved(lump(16, 1)));
  const auto one = alignRoughly(relief, smooth, 0.1), two = alignRoughly(relief, other, 0.1);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->smoothing, two->smoothing);
  // The starts' errors have other directions. Rounds end where one lowers the mean gap by less than
  // a thousandth, which may leave some hundredths of its largest values.
  EXPECT_NEAR(one->gap, two->gap, 0.05 * one->gap);
}

TEST(ShapeAlignment, IsNoneWhereAPartHasTurned) {
  const TriangleSoup soup = lump(16, 1);
  TriangleSoup bent = soup;
  // All beyond a plane turns by a right angle, gradually over a tenth of the size.
  for (Vector3d& p : bent.vertices) {
    const double share = std::clamp((p[0] - 0.7) / 0.4, 0.0, 1.0);
    const Vector3d pivot(0.7, 0, 0);
    p = pivot + Eigen::AngleAxisd(1.5 * share, Vector3d::UnitZ()) * (p - pivot);
  }
  // A tenth of the samples and more is beyond, farther from everything than a tenth.
  EXPECT_FALSE(alignRoughly(meshOf(soup), meshOf(bent), 0.03));
}

TEST(ShapeAlignment, StopsWhenTold) {
  const TriangleMesh mesh = meshOf(lump(12, 1));
  const Rough rough = roughly(mesh);
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_EQ(alignShapes(context, mesh, mesh, rough.samples, rough.targets, 1).status().reason(),
            Reason::kCancelled);
}

}  // namespace
}  // namespace moduli
