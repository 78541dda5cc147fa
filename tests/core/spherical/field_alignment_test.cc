#include "core/spherical/field_alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/core/spherical/sphere_testing.h"

namespace moduli {
namespace {

using surfaces::MappedSurface;
using surfaces::RandomSphere;

/// A smooth field without symmetry.
double bumps(const Eigen::Vector3d& p) {
  double sum = 0;
  RandomSphere random(17);
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d centre = random.direction();
    sum += (random.uniform() - 0.4) * std::exp(8 * (p.dot(centre) - 1));
  }
  return sum;
}

std::vector<double> valuesOf(const Points3& points, const Eigen::Matrix3d& turn) {
  std::vector<double> values;
  for (const Eigen::Vector3d& p : points) values.push_back(bumps(turn.transpose() * p));
  return values;
}

SphereLocator locatorOf(const MappedSurface& map) {
  auto locator = SphereLocator::make(map.surface(), map.points);
  EXPECT_OK(locator);
  return *std::move(locator);
}

/// Enough for the bumps, which are 0.35 wide.
const FieldSearchOptions kQuick = {.rotations = 8192, .samples = 600, .candidates = 6};

double angleBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

std::vector<double> ones(const std::vector<double>& values) {
  return std::vector<double>(values.size(), 1.0);
}

TEST(GridRotation, LeavesNoLargeGap) {
  // Every rotation has one of the grid within 0.12, not much more than the spacing 0.13 (the volume
  // of the rotations, 8 pi^2 in angles, over their number, to the power 1/3) times sqrt(3) / 2.
  const int count = 32768;
  std::vector<Eigen::Quaterniond> grid;
  for (int i = 0; i < count; ++i) grid.emplace_back(gridRotation(i, count));
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Eigen::Quaterniond q(surfaces::rotation(seed));
    double best = 0;
    for (const Eigen::Quaterniond& g : grid) best = std::max(best, std::abs(q.dot(g)));
    EXPECT_LT(2 * std::acos(std::min(best, 1.0)), 0.15);
  }
}

TEST(FieldCorrelation, IsOneForMultiplesAndMinusOneForOpposites) {
  const MappedSurface map = surfaces::roundSphere(8, 1);
  const SphereLocator locator = locatorOf(map);
  const std::vector<double> values = valuesOf(map.points, Eigen::Matrix3d::Identity());
  std::vector<double> other = values, opposite = values;
  for (double& value : other) value = 3 * value + 7;
  for (double& value : opposite) value = -value;
  const std::vector<double> weights = ones(values), constant = ones(values);
  const SphereField field{locator, values};
  const Eigen::Matrix3d still = Eigen::Matrix3d::Identity();
  EXPECT_NEAR(fieldCorrelation(field, weights, {locator, other}, still), 1, 1e-12);
  EXPECT_NEAR(fieldCorrelation(field, weights, {locator, opposite}, still), -1, 1e-12);
  EXPECT_EQ(fieldCorrelation(field, weights, {locator, constant}, still), 0);
}

TEST(AlignFields, FindsAnyRotationOfAFieldToRounding) {
  const MappedSurface map = surfaces::roundSphere(12, 1);
  const std::vector<double> values = valuesOf(map.points, Eigen::Matrix3d::Identity());
  const SphereLocator locator = locatorOf(map);
  for (unsigned seed = 0; seed < 4; ++seed) {
    // The same vertices, turned: the field is carried along exactly.
    const Eigen::Matrix3d turn = surfaces::rotation(seed + 20);
    MappedSurface turned = map;
    for (Eigen::Vector3d& p : turned.points) p = (turn * p).normalized();
    const SphereLocator on_turned = locatorOf(turned);
    Context context;
    const auto found =
        alignFields(context, {locator, values}, ones(values), {on_turned, values}, kQuick);
    ASSERT_OK(found);
    // Gauss and Newton's method converges at once on fields that are linear in faces.
    EXPECT_LT(angleBetween(found->rotation, turn), 1e-12);
    EXPECT_NEAR(found->correlation, 1, 1e-12);
  }
}

TEST(AlignFields, FindsTheRotationAcrossTriangulations) {
  // The field is sampled at other vertices: off by the interpolation's error, second order in the
  // edge length.
  double previous = 0;
  for (const double resolution : {8.0, 16.0, 32.0}) {
    const MappedSurface a = surfaces::roundSphere(resolution, 1);
    const MappedSurface b = surfaces::roundSphere(resolution, 2);
    const Eigen::Matrix3d turn = surfaces::rotation(31);
    const std::vector<double> on_a = valuesOf(a.points, Eigen::Matrix3d::Identity());
    const std::vector<double> on_b = valuesOf(b.points, turn);
    const SphereLocator at_a = locatorOf(a), at_b = locatorOf(b);
    Context context;
    const auto found = alignFields(context, {at_a, on_a}, ones(on_a), {at_b, on_b}, kQuick);
    ASSERT_OK(found);
    const double off = 1 - found->correlation;
    EXPECT_LT(angleBetween(found->rotation, turn), 3e-3 * (8 / resolution) * (8 / resolution));
    // Errors of order h^2 leave 1 - correlation of order h^4.
    if (previous > 0) {
      EXPECT_GT(previous / off, 10);
    }
    previous = off;
  }
}

TEST(AlignFields, HasNoBetterNeighbour) {
  const MappedSurface map = surfaces::roundSphere(10, 1), other = surfaces::roundSphere(9, 4);
  const std::vector<double> values = valuesOf(map.points, Eigen::Matrix3d::Identity());
  std::vector<double> noisy = valuesOf(other.points, surfaces::rotation(3));
  RandomSphere random(9);
  for (double& value : noisy) value += 0.2 * random.uniform();
  const SphereLocator a = locatorOf(map), b = locatorOf(other);
  Context context;
  const auto found = alignFields(context, {a, values}, ones(values), {b, noisy}, kQuick);
  ASSERT_OK(found);
  EXPECT_LT(angleBetween(found->rotation, surfaces::rotation(3)), 0.1);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix3d near =
        Eigen::AngleAxisd(0.02, random.direction()).toRotationMatrix() * found->rotation;
    EXPECT_LT(fieldCorrelation({a, values}, ones(values), {b, noisy}, near), found->correlation);
  }
}

TEST(AlignFields, CommutesWithRotationsOfBothSpheres) {
  const MappedSurface a = surfaces::roundSphere(9, 1), b = surfaces::roundSphere(9, 4);
  const std::vector<double> on_a = valuesOf(a.points, Eigen::Matrix3d::Identity());
  const std::vector<double> on_b = valuesOf(b.points, surfaces::rotation(3));
  const Eigen::Matrix3d turn_a = surfaces::rotation(41), turn_b = surfaces::rotation(42);
  MappedSurface other_a = a, other_b = b;
  for (Eigen::Vector3d& p : other_a.points) p = (turn_a * p).normalized();
  for (Eigen::Vector3d& p : other_b.points) p = (turn_b * p).normalized();
  const SphereLocator at_a = locatorOf(a), at_b = locatorOf(b), at_other_a = locatorOf(other_a),
                      at_other_b = locatorOf(other_b);
  Context context;
  const auto found = alignFields(context, {at_a, on_a}, ones(on_a), {at_b, on_b}, kQuick);
  const auto other =
      alignFields(context, {at_other_a, on_a}, ones(on_a), {at_other_b, on_b}, kQuick);
  ASSERT_OK(found);
  ASSERT_OK(other);
  // The sum of squares has kinks where a vertex crosses an edge: two ends of the descent may differ
  // by a kink's distance, far below the edges of 0.1.
  EXPECT_LT(angleBetween(other->rotation, turn_b * found->rotation * turn_a.transpose()), 1e-4);
  EXPECT_NEAR(other->correlation, found->correlation, 1e-6);
}

TEST(AlignFields, RefusesWhatCannotBeCompared) {
  const MappedSurface map = surfaces::roundSphere(4, 1);
  const SphereLocator locator = locatorOf(map);
  const std::vector<double> values = valuesOf(map.points, Eigen::Matrix3d::Identity());
  const std::vector<double> weights = ones(values), constant = ones(values);
  std::vector<double> infinite = values, negative = weights;
  infinite[3] = HUGE_VAL;
  negative[5] = -1;
  const std::vector<double> few(3, 1.0), none(values.size(), 0.0);
  const SphereField field{locator, values};
  Context context;
  const auto refuses = [&](const SphereField& a, const std::vector<double>& w,
                           const SphereField& b) {
    EXPECT_THAT(alignFields(context, a, w, b), FailsWith(Reason::kInvalidOption));
  };
  refuses({locator, infinite}, weights, field);
  refuses(field, weights, {locator, constant});
  refuses(field, weights, {locator, few});
  refuses(field, few, field);
  refuses(field, none, field);
  refuses(field, negative, field);
}

}  // namespace
}  // namespace moduli
