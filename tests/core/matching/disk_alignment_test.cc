#include "core/matching/disk_alignment.h"

#include <numbers>
#include <random>

#include "tests/core/testing.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

std::vector<Complex> pointsInDisk(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::vector<Complex> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double radius = std::sqrt(uniform(random)),
                 angle = 2 * std::numbers::pi * uniform(random);
    points.push_back(std::polar(radius, angle));
  }
  return points;
}

std::vector<DiskPair> pairsOf(const std::vector<Complex>& points, const MobiusMap& map) {
  std::vector<DiskPair> pairs;
  for (const Complex& z : points) pairs.push_back({z, map(z)});
  return pairs;
}

TEST(AlignDisks, FindsAnAutomorphism) {
  const MobiusMap truth = diskAutomorphism({0.7, -0.5}, 2.2);
  const std::vector<Complex> points = pointsInDisk(50, 3);
  const auto found = alignDisks(pairsOf(points, truth), 0);
  ASSERT_OK(found);
  EXPECT_TRUE(found->keepsDisk());
  for (const Complex& z : points) EXPECT_LT(std::abs((*found)(z)-truth(z)), 1e-12);
}

TEST(AlignDisks, EvensOutErrorsOfThePairs) {
  const MobiusMap truth = diskAutomorphism({0.4, 0.3}, -1);
  const std::vector<Complex> points = pointsInDisk(400, 4);
  std::vector<DiskPair> pairs = pairsOf(points, truth);
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, 0.05);
  for (DiskPair& pair : pairs) {
    pair.target += Complex(normal(random), normal(random));
    pair.target /= std::max(1.0, std::abs(pair.target));
  }
  const auto found = alignDisks(pairs, 0);
  ASSERT_OK(found);
  double sum = 0;
  for (const Complex& z : points) sum += std::abs((*found)(z)-truth(z)) / 400;
  // Three parameters of 400 errors of 0.07: 0.07 sqrt(3 / 800) = 0.004, and what is cut off at the
  // circle.
  EXPECT_LT(sum, 0.015);
}

TEST(AlignDisks, CommutesWithRotations) {
  const std::vector<Complex> points = pointsInDisk(30, 5), others = pointsInDisk(30, 6);
  std::vector<DiskPair> pairs, turned;
  const MobiusMap before = diskAutomorphism(0, 0.9), after = diskAutomorphism(0, -2.1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Complex to = 0.7 * points[i] + 0.3 * others[i];
    pairs.push_back({points[i], to});
    turned.push_back({before(points[i]), after(to)});
  }
  const auto one = alignDisks(pairs, 0.01), other = alignDisks(turned, 0.01);
  ASSERT_OK(one);
  ASSERT_OK(other);
  for (const Complex& z : points) {
    EXPECT_LT(std::abs(after((*one)(z)) - (*other)(before(z))), 1e-7);
  }
}

TEST(AlignDisks, PrefersRotationsIfTold) {
  const MobiusMap truth = diskAutomorphism({0.5, 0}, 0);
  const std::vector<DiskPair> pairs = pairsOf(pointsInDisk(50, 3), truth);
  const auto free = alignDisks(pairs, 0), stiff = alignDisks(pairs, 1000);
  ASSERT_OK(free);
  ASSERT_OK(stiff);
  EXPECT_GT(std::abs((*free)(0)), 0.49);
  EXPECT_LT(std::abs((*stiff)(0)), 0.01);
}

TEST(AlignDisks, RefusesWhatItCannotUse) {
  EXPECT_THAT(alignDisks({}, 0), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(alignDisks({{0, 1.1}}, 0), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(alignDisks({{0, 0.1}}, -1), FailsWith(Reason::kInvalidOption));
}

}  // namespace
}  // namespace moduli
