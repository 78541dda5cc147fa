#include "core/matching/plane_motion.h"

#include <cmath>
#include <vector>

#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const std::vector<Geometry> kPlanes = {Geometry::kEuclidean, Geometry::kHyperbolic};

TEST(CoverPlane, InverseUndoesAndShiftsGoAsFarAsTheyShould) {
  for (const Geometry geometry : kPlanes) {
    const CoverPlane plane(geometry);
    for (const Vector2d& way : {Vector2d(0, 0), Vector2d(1e-9, -2e-9), Vector2d(0.4, 1.1)}) {
      const Motion there = plane.shift(way) * CoverPlane::turn(0.7);
      EXPECT_LT(distanceToUnit(there * plane.inverse(there)), 1e-14);
      EXPECT_LE((plane.wayTo(there.col(2)) - way).norm(), 1e-15 * way.norm());
      EXPECT_LE((plane.pointAt(way) - there.col(2)).norm(), 1e-15);
      EXPECT_LT((plane.normalized(there) - there).cwiseAbs().maxCoeff(), 1e-14);
    }
  }
}

TEST(CoverPlane, NormalizingRemovesAnErrorOfTheSecondOrder) {
  const CoverPlane plane(Geometry::kHyperbolic);
  const Motion exact = plane.shift({0.3, -0.2}) * CoverPlane::turn(1);
  Motion moved = exact;
  moved(0, 1) += 1e-6;
  const Motion back = plane.normalized(moved);
  // An isometry to rounding, and no farther away than what was done to it.
  EXPECT_LT(distanceToUnit(back * plane.inverse(back)), 1e-15);
  EXPECT_LT((back - exact).cwiseAbs().maxCoeff(), 2e-6);
}

TEST(CoverPlane, AreaIsTheDefectOfTheAngles) {
  // The hyperbolic triangle with a right angle at 0 and legs a, b.
  const CoverPlane plane(Geometry::kHyperbolic);
  const double a = 0.8, b = 1.7;
  const double at_a = std::atan(std::tanh(b) / std::sinh(a));
  const double at_b = std::atan(std::tanh(a) / std::sinh(b));
  const Vector3d p = plane.pointAt({a, 0}), q = plane.pointAt({0, b});
  EXPECT_NEAR(plane.area(p, q), M_PI / 2 - at_a - at_b, 1e-15);
  EXPECT_NEAR(plane.area(q, p), at_a + at_b - M_PI / 2, 1e-15);
  EXPECT_EQ(CoverPlane(Geometry::kEuclidean).area({2, 0, 1}, {0, 3, 1}), 3);
}

}  // namespace
}  // namespace moduli
