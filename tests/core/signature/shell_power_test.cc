#include "core/signature/shell_power.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using surfaces::mesh;
using surfaces::sample;

constexpr double kPi = std::numbers::pi;
/// Entries of one degree.
constexpr int kDegreeLength = kShellCount * (kShellCount + 1) / 2;

ShellPower powerOf(const TriangleSoup& soup) {
  Context context;
  auto power = shellPower(context, surfacePoints(mesh(soup)));
  EXPECT_OK(power);
  return *std::move(power);
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

/// Appends a closed octahedron about a point.
void addOctahedron(TriangleSoup& soup, const Eigen::Vector3d& center, double radius) {
  const auto first = static_cast<Index>(soup.vertices.size());
  for (const double sign : {1.0, -1.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      soup.vertices.push_back(center + sign * radius * Eigen::Vector3d::Unit(axis));
    }
  }
  for (int octant = 0; octant < 8; ++octant) {
    Triangle face = {first + (octant & 1 ? 3 : 0), first + (octant & 2 ? 4 : 1),
                     first + (octant & 4 ? 5 : 2)};
    const int minuses = (octant & 1) + ((octant >> 1) & 1) + ((octant >> 2) & 1);
    if (minuses % 2 == 1) std::swap(face[1], face[2]);
    soup.faces.push_back(face);
  }
}

TEST(ShellPower, OfASphereHasDegreeZeroAlone) {
  // The surface is at radius of gyration 1, where shells 0 and 1 share it half and half:
  // coefficients 1/2 * Y_00 = 1 / (4 sqrt(pi)). The norm of (1/2, 1/2) goes through
  // f(s) = sqrt(s + 0.01) - 0.1 and is shared by the direction (1, 1) / sqrt(2).
  const ShellPower power = powerOf(sample("sphere", {{"resolution", 24}}));
  ASSERT_EQ(power.surface.size(), std::size_t{kShellPowerLength});
  const double s = std::sqrt(0.5) / std::sqrt(4 * kPi);
  const double pressed = (std::sqrt(s + 0.01) - 0.1) / 2;
  EXPECT_NEAR(power.surface[0], pressed, 1e-3);
  EXPECT_NEAR(power.surface[1], std::numbers::sqrt2 * pressed, 1e-3);
  EXPECT_NEAR(power.surface[4], pressed, 1e-3);
  for (int i = kDegreeLength; i < kShellPowerLength; ++i) {
    EXPECT_NEAR(power.surface[i], 0, 1e-3) << i;
    EXPECT_NEAR(power.solid[i], 0, 1e-3) << i;
  }
}

TEST(ShellPower, SolidOfASphereIsItsVolumeOnTheShells) {
  // Shell 0: r / 0.4 to 0.4, 1 to 0.8, (1.2 - r) / 0.4 to 1.2; shell 1: (r - 0.8) / 0.4 to 1.2.
  const auto integral = [](auto weight, double from, double to) {
    double sum = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double r = from + (to - from) * (i + 0.5) / kSteps;
      sum += weight(r) * r * r * (to - from) / kSteps;
    }
    return sum;
  };
  const double first = integral(
      [](double r) {
        return std::min({r / 0.4, 1.0, (1.2 - r) / 0.4});
      },
      0, 1);
  const double second = integral([](double r) { return (r - 0.8) / 0.4; }, 0.8, 1);
  const double norm = std::hypot(first, second);
  const double pressed = std::sqrt(norm * std::sqrt(4 * kPi) + 0.01) - 0.1;
  const ShellPower power = powerOf(sample("sphere", {{"resolution", 32}}));
  EXPECT_NEAR(power.solid[0], pressed * first * first / (norm * norm), 2e-3);
  EXPECT_NEAR(power.solid[1], std::numbers::sqrt2 * pressed * first * second / (norm * norm), 2e-3);
}

TEST(ShellPower, DoesNotDependOnOrderPlaceScaleOrHandedness) {
  for (const TriangleSoup& soup :
       {sample("ellipsoid", {{"b", 0.7}, {"c", 0.4}, {"resolution", 12}, {"seed", 2}}),
        sample("genus", {{"genus", 2}, {"resolution", 4}})}) {
    TriangleSoup mirrored = surfaces::reversed(soup);
    for (Eigen::Vector3d& p : mirrored.vertices) p.x() = -p.x();
    const ShellPower one = powerOf(soup);
    for (const TriangleSoup& other :
         {surfaces::moved(surfaces::renumbered(soup, 3), 1e5), mirrored}) {
      const ShellPower two = powerOf(other);
      EXPECT_LT(distance(one.surface, two.surface), 1e-10);
      EXPECT_LT(distance(one.solid, two.solid), 1e-10);
    }
  }
}

TEST(ShellPower, SeesHowShellsAreTurnedAgainstEachOther) {
  // Two small solids far out on one line, two larger ones nearer the centre on another: the power
  // of each shell alone does not know the angle between the lines.
  const auto crossed = [](double angle) {
    TriangleSoup soup;
    for (const double sign : {1.0, -1.0}) {
      addOctahedron(soup, {2 * sign, 0, 0}, 0.3);
      addOctahedron(soup, {sign * std::cos(angle), sign * std::sin(angle), 0}, 0.4);
    }
    return powerOf(soup);
  };
  const ShellPower along = crossed(0), across = crossed(kPi / 2);
  EXPECT_GT(distance(along.surface, across.surface), 0.1);
  EXPECT_GT(distance(along.solid, across.solid), 0.02);
}

TEST(ShellPower, OfAnotherTriangulationIsNearlyTheSame) {
  const ShellPower coarse =
      powerOf(sample("ellipsoid", {{"b", 0.7}, {"c", 0.4}, {"resolution", 8}}));
  const ShellPower fine =
      powerOf(sample("ellipsoid", {{"b", 0.7}, {"c", 0.4}, {"resolution", 24}, {"seed", 4}}));
  EXPECT_LT(distance(coarse.surface, fine.surface), 0.02);
  EXPECT_LT(distance(coarse.solid, fine.solid), 0.02);
}

TEST(ShellPower, InsideOutChangesNothingButTheSignThatRootsForget) {
  const TriangleSoup soup = sample("torus", {{"R", 2}, {"resolution", 10}});
  const ShellPower one = powerOf(soup), two = powerOf(surfaces::reversed(soup));
  EXPECT_LT(distance(one.solid, two.solid), 1e-12);
}

}  // namespace
}  // namespace moduli
