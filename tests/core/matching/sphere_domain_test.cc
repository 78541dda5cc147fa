#include "core/matching/sphere_domain.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/matching/capped_disk.h"
#include "tests/core/matching/disk_samples.h"
#include "tests/core/spherical/sphere_testing.h"

namespace moduli {
namespace {

/// The surface of the cube [-1, 1]^3, its squares cut along diagonals.
class CubeDomain : public ::testing::Test {
 protected:
  static std::vector<Eigen::Vector3d> corners() {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 8; ++i) {
      points.emplace_back((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    }
    return points;
  }

  static Points3 directions() {
    Points3 points = corners();
    for (Eigen::Vector3d& p : points) p.normalize();
    return points;
  }

  const Connectivity surface_ = *Connectivity::fromFaces(8, {{4, 5, 7},
                                                             {4, 7, 6},
                                                             {0, 2, 3},
                                                             {0, 3, 1},
                                                             {1, 3, 7},
                                                             {1, 7, 5},
                                                             {0, 4, 6},
                                                             {0, 6, 2},
                                                             {0, 1, 5},
                                                             {0, 5, 4},
                                                             {2, 6, 7},
                                                             {2, 7, 3}});
  const SphereLocator sphere_ = *SphereLocator::make(surface_, directions());
  const SphereDomain domain_{sphere_, corners(), 1};

  static void expectAt(const Image& image, const Eigen::Vector3d& place) {
    EXPECT_LT((image.space - place).norm(), 4e-15);
    // The sphere's triangles are seen from the centre as the cube's.
    EXPECT_LT((image.direction - place.normalized()).norm(), 4e-15);
  }
};

TEST_F(CubeDomain, WalksStraightAcrossDiagonalsAndOverEdges) {
  const Image top = domain_.at(Eigen::Vector3d(0.1, -0.2, 1));
  expectAt(top, {0.1, -0.2, 1});
  expectAt(domain_.walk(top, {0.3, 0.6, 0}), {0.4, 0.4, 1});
  expectAt(domain_.walk(top, {-0.5, 0.1, 7}), {-0.4, -0.1, 1});  // What leaves the plane is lost.
  expectAt(domain_.walk(top, {1.5, 0, 0}), {1, -0.2, 0.4});      // 0.9 on top and 0.6 down.
  expectAt(domain_.walk(top, {0.9 + 2 + 0.25, 0, 0}), {0.75, -0.2, -1});  // And underneath.
  expectAt(domain_.walk(top, {8, 0, 0}), {0.1, -0.2, 1});                 // All around.
  expectAt(domain_.walk(top, {1.8, 0.6, 0}), {1, 0.4, 0.1});
}

TEST_F(CubeDomain, WalksOutOfACornerAndAlongAnEdge) {
  const Image corner = domain_.at(vertexPoint(surface_, 7));
  expectAt(corner, {1, 1, 1});
  for (const Eigen::Vector3d& motion :
       {Eigen::Vector3d(-0.5, -0.25, 0), Eigen::Vector3d(0, -0.5, -0.25),
        Eigen::Vector3d(-0.25, 0, -0.5)}) {
    // Into the square that the motion lies in, if that is the face of the vertex.
    const Image moved = domain_.walk(corner, motion);
    const Eigen::Vector3d& normal = domain_.normal(corner.point.face);
    const Eigen::Vector3d inside = motion - motion.dot(normal) * normal;
    EXPECT_NEAR((moved.space - corner.space).norm(), inside.norm(), 4e-15);
  }
  const Image edge = domain_.at(edgePoint(0, 0.5));
  EXPECT_LT(
      (domain_.walk(edge, {0.25, 0, 0}).space - edge.space - Eigen::Vector3d(0.25, 0, 0)).norm(),
      4e-15);
}

TEST_F(CubeDomain, StopsAfterAsManyEdgesAsItMayCross) {
  const Image top = domain_.at(Eigen::Vector3d(0.1, -0.2, 1));
  expectAt(domain_.walk(top, {8, 0, 0}, 0),
           {1, -0.2, 1});  // At the first edge: no diagonal before.
}

TEST_F(CubeDomain, CountsLengthsInItsUnit) {
  const SphereDomain other(sphere_, corners(), 4);
  const Image top = other.at(Eigen::Vector3d(0.1, -0.2, 1));
  EXPECT_LT((top.space - Eigen::Vector3d(0.025, -0.05, 0.25)).norm(), 1e-15);
}

TEST(SphereDomain, KeepsGivenDirectionsAndKnowsClearance) {
  const surfaces::MappedSurface map = surfaces::roundSphere(4, 3);
  const SphereLocator sphere = *SphereLocator::make(map.surface(), map.points);
  const SphereDomain domain(sphere, map.mesh.positions(), 1);
  surfaces::RandomSphere random(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d direction = random.direction();
    EXPECT_EQ(domain.at(direction).direction, direction);
  }
  const Image x = domain.at(Eigen::Vector3d(1, 0, 0)), y = domain.at(Eigen::Vector3d(0, 1, 0)),
              z = domain.at(Eigen::Vector3d(0, 0, 1));
  EXPECT_NEAR(SphereDomain::clearance(x, y, z), 0.5, 1e-15);  // Determinant 1, sides sqrt 2.
  EXPECT_EQ(SphereDomain::clearance(x, z, y), 0);
  EXPECT_EQ(SphereDomain::clearance(x, y, x), 0);
}

TEST(DiskDomain, AWalkEndsAtTheBoundary) {
  Context context;
  const TriangleMesh disk = *TriangleMesh::fromSoup(shield(8, 2));
  const TriangleMesh capped = *cappedDisk(disk);
  const Index pole = disk.vertexCount();
  const auto points = conformalHemisphere(context, disk, capped, true);
  ASSERT_OK(points);
  const SphereLocator sphere = *SphereLocator::make(capped.connectivity(), *points);
  const SphereDomain domain(sphere, capped.positions(), 1, pole);
  for (const double angle : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0}) {
    const Image start = domain.at(Eigen::Vector3d(0.1, 0.2, 1));
    const Image end = domain.walk(start, 10 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0));
    EXPECT_LT(end.point.face, disk.faceCount());
    EXPECT_NEAR(end.direction.z(), 0, 1e-15);
  }
}

TEST(DiskDomain, WalksAlongTheBoundary) {
  Context context;
  const TriangleMesh disk = *TriangleMesh::fromSoup(shield(8, 2));
  const TriangleMesh capped = *cappedDisk(disk);
  const auto points = conformalHemisphere(context, disk, capped, true);
  ASSERT_OK(points);
  const SphereLocator sphere = *SphereLocator::make(capped.connectivity(), *points);
  const SphereDomain domain(sphere, capped.positions(), 1, disk.vertexCount());
  const Image start = domain.onRim(Eigen::Vector3d(0.6, 0.8, 0.3));
  EXPECT_NEAR((start.direction - Eigen::Vector3d(0.6, 0.8, 0)).norm(), 0, 1e-15);
  const Image there = domain.walkRim(start, 1.3);
  EXPECT_EQ(there.direction.z(), 0);
  EXPECT_NEAR(domain.rimWay(start, there), 1.3, 1e-12);
  const Image back = domain.walkRim(there, -1.3);
  EXPECT_LT((back.direction - start.direction).norm(), 1e-12);
  // A short step goes along the tangent, counter-clockwise.
  const Image near = domain.walkRim(start, 1e-6);
  EXPECT_LT((near.space - start.space - 1e-6 * domain.rimTangent(start)).norm(), 1e-14);
  EXPECT_GT(start.direction.cross(near.direction).z(), 0);
}

}  // namespace
}  // namespace moduli
