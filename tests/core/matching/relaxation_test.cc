#include "core/matching/relaxation.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/matching/refinement.h"
#include "tests/core/spherical/sphere_testing.h"

namespace moduli {
namespace {

using surfaces::MappedSurface;

/// A round sphere on itself, with attractions.
class RoundRelaxation : public ::testing::Test {
 protected:
  void SetUp() override {
    attractions_.resize(map_.points.size());
    rings_ = *RingMesh::make(map_.surface());
  }

  Relaxation identity() const {
    Relaxation relaxation(*rings_, map_.mesh.positions(), domain_, attractions_);
    for (const Index v : relaxation.present()) {
      relaxation.setImage(v, domain_.at(vertexPoint(map_.surface(), v)));
    }
    return relaxation;
  }

  static int badFaces(const Relaxation& relaxation) {
    int bad = 0;
    for (const Index v : relaxation.present()) {
      const std::vector<Index>& ring = relaxation.mesh().ring(v);
      for (std::size_t i = 0; i < ring.size(); ++i) {
        bad += SphereDomain::isPositive(relaxation.image(v), relaxation.image(ring[i]),
                                        relaxation.image(ring[(i + 1) % ring.size()]))
                   ? 0
                   : 1;
      }
    }
    return bad;
  }

  const MappedSurface map_ = surfaces::roundSphere(8, 4);
  const SphereLocator sphere_ = *SphereLocator::make(map_.surface(), map_.points);
  const SphereDomain domain_{sphere_, map_.mesh.positions(), 1};
  std::vector<Attraction> attractions_;
  std::optional<RingMesh> rings_;
};

TEST_F(RoundRelaxation, LeavesAnIsometryAlone) {
  Relaxation relaxation = identity();
  EXPECT_NEAR(relaxation.excess(relaxation.present()), 0, 1e-13);
  for (const Index v : relaxation.present()) {
    EXPECT_EQ(relaxation.relax(v), 0);
    EXPECT_EQ(relaxation.image(v).direction, map_.points[v]);
  }
}

TEST_F(RoundRelaxation, LowersTheEnergyByWhatItSaysAndFoldsNothingUnderWildPulls) {
  surfaces::RandomSphere random(3);
  for (Attraction& to : attractions_) {
    to.image = domain_.at(random.direction());
    to.place = to.image.space;
    to.weight = 1;
  }
  Relaxation relaxation = identity();
  relaxation.setPull(1000, 2);
  const std::vector<Index> all = relaxation.present();
  double energy = relaxation.excess(all);
  const double start = energy;
  double gained = 0;
  for (int sweep = 0; sweep < 5; ++sweep) {
    for (const Index v : all) gained += relaxation.relax(v);
    EXPECT_EQ(badFaces(relaxation), 0);
  }
  EXPECT_TRUE(coversOnce(relaxation));
  energy = relaxation.excess(all);
  EXPECT_LT(energy, start / 1.01);
  // The same sums in another order.
  EXPECT_NEAR(start - energy, gained, 1e-11 * start);
}

TEST_F(RoundRelaxation, JumpsToItsAttractionWhereThatFoldsNothing) {
  const Index v = 17;
  const Image near = domain_.walk(domain_.at(map_.points[v]), Eigen::Vector3d(0.01, 0.01, 0.01));
  attractions_[v] = {near.space, near, 1};
  Relaxation relaxation = identity();
  relaxation.setPull(1e6, 1);
  relaxation.jump(v);
  EXPECT_EQ(relaxation.image(v).direction, near.direction);
  const Image far = domain_.at(Eigen::Vector3d(-map_.points[v]));
  attractions_[v] = {far.space, far, 1};
  relaxation.jump(v);
  EXPECT_EQ(relaxation.image(v).direction, near.direction);
}

TEST_F(RoundRelaxation, PlacesARemovedVertexInItsKernel) {
  Relaxation relaxation = identity();
  const Index v = 17, u = relaxation.mesh().ring(v)[0];
  ASSERT_TRUE(relaxation.mesh().canCollapse(v, u));
  relaxation.mesh().collapse(v, u);
  relaxation.mesh().restore();
  relaxation.setImage(v, domain_.at(Eigen::Vector3d(-map_.points[v])));
  EXPECT_GT(badFaces(relaxation), 0);
  ASSERT_TRUE(relaxation.place(v, u));
  EXPECT_EQ(badFaces(relaxation), 0);
  // One step of Newton's method from the mean value of the ring: within a small part of an edge,
  // which is 1.107 / 8 at most.
  EXPECT_LT((relaxation.image(v).direction - map_.points[v]).norm(), 0.01);
}

TEST_F(RoundRelaxation, KnowsADoubleCover) {
  Relaxation relaxation = identity();
  EXPECT_TRUE(coversOnce(relaxation));
  // z -> z^2 covers the sphere twice.
  for (const Index v : relaxation.present()) {
    const Eigen::Vector3d& p = map_.points[v];
    const double angle = 2 * std::atan2(p.y(), p.x()), radius = std::hypot(p.x(), p.y());
    Image image;
    image.direction = {radius * std::cos(angle), radius * std::sin(angle), p.z()};
    relaxation.setImage(v, image);
  }
  EXPECT_FALSE(coversOnce(relaxation));
}

}  // namespace
}  // namespace moduli
