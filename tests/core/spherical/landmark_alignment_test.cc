#include "core/spherical/landmark_alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "tests/core/spherical/sphere_testing.h"

namespace moduli {
namespace {

using surfaces::RandomSphere;

/// A map that turns and, by the hyperbolic distance `reach`, moves the centre of the ball.
MobiusMap randomMobius(unsigned seed, double reach) {
  const auto turn = mobiusOfRotation(surfaces::rotation(seed));
  const auto back = mobiusOfRotation(surfaces::rotation(seed + 100));
  return compose(turn, compose({std::exp(reach / 2), 0, 0, std::exp(-reach / 2)}, back));
}

std::vector<PointPair> pairsUnder(const MobiusMap& map, int count, unsigned seed) {
  RandomSphere random(seed);
  std::vector<PointPair> pairs;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p = random.direction();
    pairs.push_back({p, map(p), 0.5 + random.uniform()});
  }
  return pairs;
}

/// Largest distance of the images of points under two maps.
double distance(const MobiusMap& a, const MobiusMap& b) {
  RandomSphere random(99);
  double worst = 0;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p = random.direction();
    worst = std::max(worst, (a(p) - b(p)).norm());
  }
  return worst;
}

LandmarkAlignment aligned(const std::vector<PointPair>& pairs,
                          const AlignmentOptions& options = {}) {
  const auto result = alignLandmarks(pairs, options);
  EXPECT_OK(result);
  return *result;
}

/// What alignLandmarks makes small.
double energyOf(const std::vector<PointPair>& pairs, const MobiusMap& map, double preference = 0) {
  double sum = 0, total = 0;
  for (const PointPair& pair : pairs) {
    sum += pair.weight * (map(pair.source) - pair.target).squaredNorm();
    total += pair.weight;
  }
  const double stretch =
      std::norm(map.a) + std::norm(map.b) + std::norm(map.c) + std::norm(map.d) - 2;
  return sum / total + preference * stretch;
}

TEST(MobiusOfRotation, MovesPointsAsTheRotationDoes) {
  RandomSphere random(1);
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Eigen::Matrix3d rotation = surfaces::rotation(seed);
    const MobiusMap map = mobiusOfRotation(rotation);
    const Eigen::Vector3d p = random.direction();
    EXPECT_LT((map(p) - rotation * p).norm(), 1e-15 * 4);
    EXPECT_LT((map(Eigen::Vector3d(0, 0, 1)) - rotation.col(2)).norm(), 1e-15 * 4);
  }
}

TEST(BestRotation, OfOnePairTurnsNoMoreThanItMust) {
  const Eigen::Vector3d p = Eigen::Vector3d(1, 2, 2) / 3, q = Eigen::Vector3d(-2, 1, 2) / 3;
  const auto rotation = bestRotation({{p, q}});
  ASSERT_OK(rotation);
  EXPECT_LT((*rotation * p - q).norm(), 1e-15);
  EXPECT_NEAR(Eigen::AngleAxisd(*rotation).angle(), std::acos(p.dot(q)), 1e-14);
  const auto same = bestRotation({{p, p}});
  ASSERT_OK(same);
  EXPECT_LT((*same - Eigen::Matrix3d::Identity()).norm(), 1e-15);
}

TEST(BestRotation, IsRecoveredFromTwoPairsAndMore) {
  RandomSphere random(4);
  for (const int count : {2, 3, 10}) {
    const Eigen::Matrix3d truth = surfaces::rotation(static_cast<unsigned>(count));
    std::vector<PointPair> pairs;
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d p = random.direction();
      pairs.push_back({p, truth * p});
    }
    const auto rotation = bestRotation(pairs);
    ASSERT_OK(rotation);
    // Rounding over the sine of the angle between the points.
    EXPECT_LT((*rotation - truth).norm(), 1e-13);
  }
}

TEST(BestRotation, HalvesTheMisfitOfTwoPairsOfDifferentWidth) {
  // Sources 60 degrees apart, targets 80, in one plane with the same middle: each pair is left with
  // ten degrees.
  const auto at = [](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  };
  const auto rotation = bestRotation({{at(-30), at(-40)}, {at(30), at(40)}});
  ASSERT_OK(rotation);
  EXPECT_LT((*rotation - Eigen::Matrix3d::Identity()).norm(), 1e-15 * 4);
}

TEST(AlignLandmarks, RecoversMobiusMapsFromThreePairsAndMore) {
  for (const int count : {3, 4, 7, 40}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      const MobiusMap truth = randomMobius(seed, 0.2 * seed);
      const std::vector<PointPair> pairs = pairsUnder(truth, count, seed + 50);
      const LandmarkAlignment result = aligned(pairs);
      EXPECT_FALSE(result.is_rotation);
      // Rounding, stretched by up to e^2 both ways and by points that crowd.
      EXPECT_LT(distance(result.map, truth), 1e-10) << count << " pairs, seed " << seed;
      EXPECT_LT(result.rms, 1e-12);
      for (const double residual : result.residuals) EXPECT_LT(residual, 1e-12);
    }
  }
}

TEST(AlignLandmarks, MeetsAnyThreePairsExactly) {
  RandomSphere random(8);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<PointPair> pairs;
    for (int i = 0; i < 3; ++i) pairs.push_back({random.direction(), random.direction()});
    const LandmarkAlignment result = aligned(pairs);
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT(result.residuals[i], 1e-12);
      // One rounding of the source's length, stretched by the map.
      EXPECT_LT((result.moved[i] - result.map(pairs[i].source)).norm(), 1e-12);
    }
  }
}

/// Pairs that no Möbius map meets.
std::vector<PointPair> noisyPairs(unsigned seed, double noise, int count = 12) {
  RandomSphere random(seed + 7);
  std::vector<PointPair> pairs = pairsUnder(randomMobius(seed, 0.8), count, seed);
  for (PointPair& pair : pairs) pair.target = random.awayFrom(pair.target, noise);
  return pairs;
}

TEST(AlignLandmarks, HasNoBetterNeighbour) {
  RandomSphere random(3);
  for (const double preference : {0.0, 0.05}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      const std::vector<PointPair> pairs = noisyPairs(seed, 0.3);
      const AlignmentOptions options{.rotation_preference = preference, .rigid = false};
      const MobiusMap best = aligned(pairs, options).map;
      const double least = energyOf(pairs, best, preference);
      // A map h away has more energy by the order of h^2.
      const double h = 1e-3;
      for (int i = 0; i < 50; ++i) {
        const MobiusMap turn =
            mobiusOfRotation(Eigen::AngleAxisd(h, random.direction()).toRotationMatrix());
        const Eigen::Matrix3d frame = surfaces::rotation(static_cast<unsigned>(i));
        const MobiusMap boost = compose(
            mobiusOfRotation(frame),
            compose({std::exp(h), 0, 0, std::exp(-h)}, mobiusOfRotation(frame.transpose())));
        EXPECT_GT(energyOf(pairs, compose(turn, best), preference), least);
        EXPECT_GT(energyOf(pairs, compose(boost, best), preference), least);
      }
      const MobiusMap rigid = aligned(pairs, {.rotation_preference = 0, .rigid = true}).map;
      EXPECT_LT(least, energyOf(pairs, rigid, preference));
    }
  }
}

TEST(AlignLandmarks, CommutesWithRotationsOfEitherSphere) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const std::vector<PointPair> pairs = noisyPairs(seed, 0.2);
    const Eigen::Matrix3d source = surfaces::rotation(11), target = surfaces::rotation(12);
    std::vector<PointPair> turned = pairs;
    for (PointPair& pair : turned) {
      pair.source = source * pair.source;
      pair.target = target * pair.target;
    }
    const MobiusMap expected =
        compose(mobiusOfRotation(target),
                compose(aligned(pairs).map, mobiusOfRotation(source.transpose())));
    // Newton's last steps go by the gradient, whose rounding is 1e-15.
    EXPECT_LT(distance(aligned(turned).map, expected), 1e-12);
  }
}

TEST(AlignLandmarks, DependsNeitherOnTheOrderNorOnTheScaleOfWeights) {
  const std::vector<PointPair> pairs = noisyPairs(2, 0.2);
  std::vector<PointPair> other(pairs.rbegin(), pairs.rend());
  for (PointPair& pair : other) pair.weight *= 1000;
  EXPECT_LT(distance(aligned(pairs).map, aligned(other).map), 1e-12);
}

TEST(AlignLandmarks, FallsBackToRotationsWhereThePairsDoNotDetermineMore) {
  RandomSphere random(5);
  const Eigen::Vector3d p = random.direction(), q = random.direction(), r = random.direction();
  EXPECT_TRUE(aligned({{p, q}}).is_rotation);
  EXPECT_TRUE(aligned({{p, q}, {q, r}}).is_rotation);
  EXPECT_TRUE(aligned({{p, q}, {q, r}, {p, q}}).is_rotation);
  EXPECT_TRUE(aligned({{p, q}, {q, r}, {r, q}}).is_rotation);
  EXPECT_FALSE(aligned({{p, q}, {q, r}, {r, p}}).is_rotation);
}

TEST(AlignLandmarks, PreferenceLeadsFromMobiusMapsToRotations) {
  const std::vector<PointPair> pairs = noisyPairs(4, 0.1);
  const auto stretch = [&](double preference) {
    const MobiusMap map = aligned(pairs, {.rotation_preference = preference, .rigid = false}).map;
    return std::norm(map.a) + std::norm(map.b) + std::norm(map.c) + std::norm(map.d) - 2;
  };
  EXPECT_GT(stretch(0), 0.2);
  EXPECT_LT(stretch(0.1), stretch(0));
  EXPECT_LT(stretch(1), stretch(0.1));
  // The pull of the pairs, below 2, over the preference.
  EXPECT_LT(stretch(1e6), 1e-11);
  const MobiusMap rigid = aligned(pairs, {.rotation_preference = 0, .rigid = true}).map;
  EXPECT_LT(distance(aligned(pairs, {.rotation_preference = 1e6, .rigid = false}).map, rigid),
            1e-5);
}

TEST(AlignLandmarks, SaysSoWhereTheBestMapIsAtInfinity) {
  // Three of four crowd to a point, as only a map without limit can bring them.
  RandomSphere random(6);
  const Eigen::Vector3d q = random.direction();
  std::vector<PointPair> pairs;
  for (int i = 0; i < 5; ++i) {
    pairs.push_back({random.direction(), i == 0 ? Eigen::Vector3d(-q) : random.awayFrom(q, 1e-7)});
  }
  pairs.push_back(pairs.back());
  EXPECT_THAT(alignLandmarks(pairs), FailsWith(Reason::kNoConvergence));
  EXPECT_OK(alignLandmarks(pairs, {.rotation_preference = 1e-3, .rigid = false}));
}

TEST(AlignLandmarks, RefusesWhatIsNoPair) {
  const Eigen::Vector3d p(1, 0, 0);
  EXPECT_THAT(alignLandmarks({}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(alignLandmarks({{p, 2 * p}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(alignLandmarks({{p, p, 0}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(alignLandmarks({{p, p, std::nan("")}}), FailsWith(Reason::kInvalidOption));
  const auto named = alignLandmarks({{p, p}, {p, {0, 0, std::nan("")}}});
  EXPECT_THAT(named.status().message(), testing::HasSubstr("landmark pair 1"));
}

}  // namespace
}  // namespace moduli
