#include "core/matching/ring_place.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

/// A vertex at (x, y, 1), lifted to the sphere, scaled before by `size`.
Vector3d lifted(double x, double y, double size) {
  return Vector3d(size * x, size * y, 1).normalized();
}

/// Vertex 0 among the others, in their order.
struct Star {
  std::vector<Index> ring;
  std::vector<Vector3d> positions;
  Points3 points;
  double area = 1;

  PlacedRing placed() const { return {0, ring, positions, points, area, kLeastScale, false}; }
};

Star starOf(const std::vector<Eigen::Vector2d>& corners, double size) {
  Star star;
  star.positions.emplace_back(0, 0, 0);
  star.points.push_back(Vector3d::UnitZ());
  for (const Eigen::Vector2d& p : corners) {
    star.ring.push_back(static_cast<Index>(star.points.size()));
    star.positions.emplace_back(p.x(), p.y(), 0);
    star.points.push_back(lifted(p.x(), p.y(), size));
  }
  return star;
}

std::vector<Eigen::Vector2d> polygon(int sides) {
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i < sides; ++i) {
    const double t = 2 * std::numbers::pi * i / sides;
    corners.emplace_back(std::cos(t), std::sin(t));
  }
  return corners;
}

TEST(RingPlace, CentreOfAConvexRingIsItsCentroid) {
  // A gnomonic chart turned to the ring's own centre.
  const Star star = starOf(polygon(7), 0.2);
  const auto p = kernelCentre(star.placed(), Vector3d::UnitZ());
  ASSERT_TRUE(p);
  EXPECT_LT((*p - Vector3d::UnitZ()).norm(), 1e-15);
}

TEST(RingPlace, FindsKernelsFromAnyOfTheirCorners) {
  // An L: its kernel is the square at the bend, of which one corner is a corner of the ring.
  const std::vector<Eigen::Vector2d> corners = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const double size : {0.3, 1e-3, 1e-9, 1e-12}) {
    const Star star = starOf(corners, size);
    const auto p = kernelCentre(star.placed(), star.points[1]);
    ASSERT_TRUE(p) << size;
    // What is left of sixteen digits.
    const double tolerance = 1e-15 / size + size;
    EXPECT_NEAR(p->x() / p->z() / size, 0.5, tolerance);
    EXPECT_NEAR(p->y() / p->z() / size, 0.5, tolerance);
  }
}

TEST(RingPlace, SaysWhereAKernelIsEmpty) {
  // A Z, both of whose ends are out of sight of each other.
  const std::vector<Eigen::Vector2d> corners = {{0, 0}, {3, 0}, {3, 3}, {4, 3},
                                                {4, 4}, {2, 4}, {2, 1}, {0, 1}};
  const Star star = starOf(corners, 0.1);
  for (const Vector3d& p : star.points) {
    EXPECT_FALSE(kernelCentre(star.placed(), p));
  }
}

TEST(RingPlace, FindsRoomInRingsOfMoreThanAHemisphere) {
  // A fifth vertex on an edge of a tetrahedron.
  Star star;
  star.ring = {1, 2, 3, 4};
  star.positions.assign(5, Vector3d::Zero());
  const Vector3d a(1, 1, 1), b(-1, -1, 1), c(-1, 1, -1), d(1, -1, -1);
  star.points = {Vector3d::Zero()};
  for (const Vector3d& p : {a, c, b, d}) star.points.push_back(p.normalized());
  const auto p = kernelCentre(star.placed(), star.points[1]);
  ASSERT_TRUE(p);
  EXPECT_TRUE(isInKernel(star.placed(), *p));
}

TEST(RingPlace, AConformalImageIsLeastDistorted) {
  const std::vector<Eigen::Vector2d> corners = {
      {1, 0.2}, {0.3, 1.1}, {-0.9, 0.6}, {-1, -0.5}, {0.2, -1.2}};
  for (const double size : {1e-2, 1e-4}) {
    Star star = starOf(corners, size);
    star.area = 4 * std::numbers::pi;
    star.points[0] = lifted(0.3, 0.25, size);
    ASSERT_TRUE(isInKernel(star.placed(), star.points[0]));
    const Vector3d p = leastDistorted(star.placed(), star.points[0]);
    // The chart around the start is conformal to second order.
    EXPECT_LT((p - Vector3d::UnitZ()).norm(), size * (10 * size * size + 1e-9));
  }
}

TEST(RingPlace, LeavesTheKernelNeverHoweverThinItsFaces) {
  // Faces of the surface that have no area ask for images without one.
  Star star = starOf(polygon(5), 0.05);
  for (Vector3d& p : star.positions) p.y() = 0;
  star.points[0] = lifted(0.2, 0.1, 0.05);
  const Vector3d p = leastDistorted(star.placed(), star.points[0]);
  EXPECT_TRUE(isInKernel(star.placed(), p));
  for (Vector3d& q : star.positions) q.setZero();
  EXPECT_TRUE(isInKernel(star.placed(), leastDistorted(star.placed(), star.points[0])));
}

}  // namespace
}  // namespace moduli
