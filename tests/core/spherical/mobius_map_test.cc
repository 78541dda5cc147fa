#include "core/spherical/mobius_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/spherical/disk_centering.h"
#include "core/spherical/mobius.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using namespace std::complex_literals;

const double kInfinity = std::numeric_limits<double>::infinity();

MobiusMap randomMap(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return Complex(normal(random), normal(random)); };
  const auto map = makeMobiusMap(draw(), draw(), draw(), draw());
  EXPECT_OK(map);
  return *map;
}

Eigen::Vector3d lift(const Complex& z) {
  const double r2 = std::norm(z);
  return Eigen::Vector3d(2 * z.real(), 2 * z.imag(), r2 - 1) / (1 + r2);
}

double size(const MobiusMap& m) {
  return std::norm(m.a) + std::norm(m.b) + std::norm(m.c) + std::norm(m.d);
}

TEST(MobiusMap, ComposesInvertsAndKeepsDeterminantOne) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const MobiusMap f = randomMap(random), g = randomMap(random);
    const Complex z(std::normal_distribution<double>()(random), 0.3);
    const MobiusMap both = compose(f, g);
    EXPECT_LT(std::abs(both.a * both.d - both.b * both.c - 1.0), 1e-15 * size(both));
    // Chordal distance: near a pole numbers are large. A map stretches rounding by up to its size.
    const double allowed = 1e-15 * size(f) * size(g);
    EXPECT_LT((lift(both(z)) - lift(f(g(z)))).norm(), allowed);
    EXPECT_LT((lift(f.inverse()(f(z))) - lift(z)).norm(), 1e-15 * size(f) * size(f));
  }
}

TEST(MobiusMap, ActsOnTheSphereAsOnThePlaneAtThePolesToo) {
  std::mt19937 random(2);
  const Eigen::Vector3d north = Eigen::Vector3d::UnitZ();
  for (int trial = 0; trial < 100; ++trial) {
    const MobiusMap f = randomMap(random);
    const Complex z = std::polar(std::exp(std::normal_distribution<double>(0, 3)(random)), 0.7);
    EXPECT_LT((f(lift(z)) - lift(f(z))).norm(), 1e-15 * size(f));
    EXPECT_LT((f(north) - lift(f.a / f.c)).norm(), 1e-15 * size(f));
    EXPECT_LT((f(Eigen::Vector3d(-north)) - lift(f.b / f.d)).norm(), 1e-15 * size(f));
    EXPECT_LT((lift(f(Complex(kInfinity, 0))) - lift(f.a / f.c)).norm(), 1e-15 * size(f));
    EXPECT_NEAR(f(lift(z)).norm(), 1, 4e-16);
  }
  // Near the north pole heights are 1 to rounding; the direction must not be lost. z -> 4 z pulls
  // towards the pole by 4.
  const MobiusMap stretch = *makeMobiusMap(4, 0, 0, 1);
  const Eigen::Vector3d image = stretch(Eigen::Vector3d(4e-12, 0, 1).normalized());
  EXPECT_NEAR(image.x(), 1e-12, 1e-27);
  const MobiusMap swap = *makeMobiusMap(0, 1, 1, 0);
  EXPECT_EQ(swap(north), Eigen::Vector3d(-north));
  EXPECT_TRUE(std::isinf(swap(Complex(0)).real()));
}

TEST(MobiusMap, IsFixedByThreePoints) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const MobiusMap f = randomMap(random);
    const std::array<Complex, 3> from = {0.3 + 1i, Complex(kInfinity, 0), -2.0};
    const auto g = mobiusThrough(from, {f(from[0]), f(from[1]), f(from[2])});
    ASSERT_OK(g);
    for (const Complex z : {0.1i, 3.0 - 1i, Complex(-20, 5)}) {
      EXPECT_LT((lift((*g)(z)) - lift(f(z))).norm(), 1e-13 * size(f) * size(f));
    }
  }
  const Eigen::Matrix3d turn = surfaces::rotation(4);
  const auto rotation = mobiusThrough({turn.col(0), turn.col(1), turn.col(2)},
                                      {turn.row(0), turn.row(1), turn.row(2)});
  ASSERT_OK(rotation);
  // The orthogonal frames are turned into each other by one rotation, in SU(2).
  EXPECT_LT(std::abs(rotation->d - std::conj(rotation->a)), 1e-14);
  EXPECT_LT(std::abs(rotation->c + std::conj(rotation->b)), 1e-14);
}

TEST(MobiusMap, RefusesWhatIsNoMap) {
  EXPECT_THAT(makeMobiusMap(1, 2, 2, 4), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(makeMobiusMap(0, 0, 0, 0), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(makeMobiusMap(NAN, 0, 0, 1), FailsWith(Reason::kInvalidOption));
  const std::array<Complex, 3> good = {0, 1, 2};
  EXPECT_THAT(mobiusThrough({1, 1, 2}, good), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(mobiusThrough(good, {1, 0, 1}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(mobiusThrough(good, {1, 0, NAN}), FailsWith(Reason::kInvalidOption));
}

TEST(DiskAutomorphism, StaysInTheGroupAndCarriesItsPointToZero) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  MobiusMap all;
  for (int trial = 0; trial < 100; ++trial) {
    const Complex w0 = std::polar(std::sqrt(uniform(random)) * 0.95, 6.3 * uniform(random));
    const MobiusMap f = diskAutomorphism(w0, 6.3 * uniform(random));
    EXPECT_LT(std::abs(f(w0)), 1e-14);
    EXPECT_TRUE(f.keepsDisk(1e-15));
    // Rounding on the circle, stretched by at most (1 + r) / (1 - r) = 39.
    EXPECT_NEAR(std::abs(f(std::polar(1.0, 1.0 * trial))), 1, 1e-14);
    // A step there and another one, so that lengths do not grow without bound.
    all = compose(f, trial % 2 == 0 ? diskAutomorphism(0.9 * w0) : all.inverse());
    EXPECT_TRUE(all.keepsDisk(1e-14));
  }
  EXPECT_FALSE(makeMobiusMap(0, 1, 1, 0)->keepsDisk());  // turns it inside out
  EXPECT_FALSE(makeMobiusMap(1, 1e-6, 0, 1)->keepsDisk());
}

TEST(DiskAutomorphism, HasTheFormOfTheBookAndTheHalfPlaneFits) {
  const Complex w0(0.3, -0.5), w(-0.2, 0.1);
  const double angle = 0.8;
  const Complex expected = std::polar(1.0, angle) * (w - w0) / (1.0 - std::conj(w0) * w);
  EXPECT_LT(std::abs(diskAutomorphism(w0, angle)(w) - expected), 1e-15);

  const Complex z0(0.4, 1.5);
  const MobiusMap cayley = halfPlaneToDisk(z0);
  EXPECT_LT(std::abs(cayley(z0)), 1e-15);
  EXPECT_LT(std::abs(cayley(Complex(kInfinity, 0)) - 1.0), 1e-15);
  for (const double x : {-100.0, -1.0, 0.0, 2.5, 1e8}) EXPECT_NEAR(std::abs(cayley(x)), 1, 1e-14);
  EXPECT_LT(std::abs(cayley(Complex(-3, 0.1))), 1);
  EXPECT_GT(std::abs(cayley(Complex(-3, -0.1))), 1);
}

/// Points of the disk, a quarter of them on the circle.
struct DiskPoints {
  std::vector<Complex> points;
  std::vector<double> weights;
};

DiskPoints skewedDisk(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  DiskPoints disk;
  const MobiusMap skew = diskAutomorphism({-0.5, 0.4});
  for (int i = 0; i < 200; ++i) {
    const double radius = i % 4 == 0 ? 1 : std::sqrt(uniform(random));
    disk.points.push_back(skew(std::polar(radius, 6.3 * uniform(random))));
    disk.weights.push_back(0.2 + uniform(random));
  }
  return disk;
}

Complex mean(const std::vector<Complex>& points, const std::vector<double>& weights) {
  Complex sum = 0;
  double total = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum += weights[i] * points[i];
    total += weights[i];
  }
  return sum / total;
}

std::vector<Complex> applied(const MobiusMap& map, std::vector<Complex> points) {
  for (Complex& z : points) z = map(z);
  return points;
}

TEST(CenterDisk, ReachesTheCentreAndKeepsTheCircle) {
  const DiskPoints disk = skewedDisk(1);
  ASSERT_GT(std::abs(mean(disk.points, disk.weights)), 0.3);
  Context context;
  const auto result = centerDisk(context, disk.points, disk.weights);
  ASSERT_OK(result);
  EXPECT_LT(std::abs(mean(result->points, disk.weights)), 1e-14);
  EXPECT_LT(result->residual, 1e-14);
  EXPECT_LE(result->iterations, 8);
  EXPECT_TRUE(result->map.keepsDisk(1e-14));
  for (std::size_t i = 0; i < disk.points.size(); ++i) {
    EXPECT_LT(std::abs(result->map(disk.points[i]) - result->points[i]), 1e-15);
    if (i % 4 == 0) {
      EXPECT_NEAR(std::abs(result->points[i]), 1, 1e-14);
    }
  }
}

TEST(CenterDisk, ForgetsAutomorphismsUpToARotationAndMirrorsWithItsInput) {
  const DiskPoints disk = skewedDisk(2);
  Context context;
  const auto a = centerDisk(context, disk.points, disk.weights);
  const auto b =
      centerDisk(context, applied(diskAutomorphism({0.6, -0.55}, 2), disk.points), disk.weights);
  ASSERT_OK(a);
  ASSERT_OK(b);
  const Complex turn = b->points[0] / a->points[0];
  EXPECT_NEAR(std::abs(turn), 1, 1e-13);
  for (std::size_t i = 0; i < disk.points.size(); ++i) {
    // Rounding of the squeezed points, 1e-16, stretched by at most (1 + .81) / (1 - .81) = 10
    // twice.
    EXPECT_LT(std::abs(a->points[i] * turn - b->points[i]), 1e-13);
  }
  std::vector<Complex> mirrored = disk.points;
  for (Complex& z : mirrored) z = std::conj(z);
  const auto c = centerDisk(context, mirrored, disk.weights);
  ASSERT_OK(c);
  for (std::size_t i = 0; i < disk.points.size(); ++i) {
    EXPECT_LT(std::abs(std::conj(c->points[i]) - a->points[i]), 1e-14);
  }
}

TEST(CenterDisk, OfPointsOnTheCircleIsTheSphereCentringOnTheEquator) {
  // Both find the minimum of the same potential: a second method.
  DiskPoints disk = skewedDisk(3);
  Points3 equator;
  for (Complex& z : disk.points) {
    z /= std::abs(z);
    equator.emplace_back(z.real(), z.imag(), 0);
  }
  Context context;
  const auto flat = centerDisk(context, disk.points, disk.weights);
  const auto round = centerByMobius(context, equator, disk.weights);
  ASSERT_OK(flat);
  ASSERT_OK(round);
  const Complex turn = Complex(round->points[0].x(), round->points[0].y()) / flat->points[0];
  for (std::size_t i = 0; i < equator.size(); ++i) {
    const Complex z(round->points[i].x(), round->points[i].y());
    EXPECT_LT(std::abs(turn * flat->points[i] - z), 1e-13);
  }
}

TEST(CenterDisk, RefusesWhatHasNoCentre) {
  Context context;
  EXPECT_THAT(centerDisk(context, {1.0, 0.0}, {1}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(centerDisk(context, {1.0, 0.5i, 0.0}, {2, 1, 1}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(centerDisk(context, {1.5, 0.5i}, {1, 1}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(centerDisk(context, {0.1, 0.5i}, {0, 0}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(centerDisk(context, {0.1, 0.5i}, {1, -1}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(centerDisk(context, {NAN, 0.5i}, {1, 1}), FailsWith(Reason::kInvalidOption));
  // Inside the disk any weight is well.
  EXPECT_OK(centerDisk(context, {0.9, 0.5i}, {9, 1}));
}

}  // namespace
}  // namespace moduli
