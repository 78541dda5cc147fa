#include "core/signature/canonical_circles.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "tests/core/testing.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Circles = std::vector<Circle>;

/// Canonical already, and without symmetry.
const Circles kThreeHoles = {{0, 1}, {0, 0.25}, {0.6, 0.12}, {{-0.2, 0.65}, 0.08}};

double difference(const Circles& a, const Circles& b) {
  if (a.size() != b.size()) return 1;
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    largest = std::max(
        {largest, std::abs(a[k].center - b[k].center), std::abs(a[k].radius - b[k].radius)});
  }
  return largest;
}

Circles mapped(const Circles& circles, const DiskTranslation& map) {
  Circles result = {{0, 1}};
  for (std::size_t k = 1; k < circles.size(); ++k) result.push_back(map(circles[k]));
  return result;
}

Circles mirrored(Circles circles) {
  for (Circle& circle : circles) circle.center = std::conj(circle.center);
  return circles;
}

/// The image under z -> 1 / (z - c), where c lies in the hole that becomes the outer circle.
Circles inverted(const Circles& circles, std::size_t outer) {
  const Complex c = circles[outer].center + 0.3 * circles[outer].radius;
  Circles result;
  for (const Circle& circle : circles) {
    const Complex center = circle.center - c;
    const double power = std::norm(center) - circle.radius * circle.radius;
    result.push_back({std::conj(center) / power, circle.radius / std::abs(power)});
  }
  std::rotate(result.begin(), result.begin() + static_cast<std::ptrdiff_t>(outer),
              result.begin() + static_cast<std::ptrdiff_t>(outer) + 1);
  return result;
}

/// Holes in another order, and each a little beside its place.
Circles disturbed(Circles circles, unsigned seed, double noise) {
  std::mt19937 random(seed);
  std::shuffle(circles.begin() + 1, circles.end(), random);
  const auto next = [&] { return noise * (static_cast<double>(random()) / 2147483648.0 - 1); };
  for (Circle& circle : circles) {
    circle.center += Complex(next(), next());
    circle.radius *= 1 + next();
  }
  return circles;
}

// Rounding of a few operations, larger where a small circle becomes the outer one.
TEST(CanonicalCircles, AreTheSameAfterMoebiusMaps) {
  EXPECT_LT(difference(canonicalCircles(kThreeHoles), kThreeHoles), 1e-15);
  for (const Complex zero : {Complex(0.3, 0.1), Complex(-0.6, 0.5), Complex(0.1, -0.9)}) {
    const Circles moved = mapped(kThreeHoles, {zero});
    EXPECT_LT(difference(canonicalCircles(moved), kThreeHoles), 1e-13);
    Circles similar;
    for (const Circle& circle : moved) {
      similar.push_back({Complex(3, 4) * circle.center - Complex(7, 2), 5 * circle.radius});
    }
    EXPECT_LT(difference(canonicalCircles(similar), kThreeHoles), 1e-13);
    for (const std::size_t outer : {1, 2, 3}) {
      EXPECT_LT(difference(canonicalCircles(inverted(moved, outer)), kThreeHoles), 1e-12);
    }
  }
}

TEST(CanonicalCircles, DoNotDependOnTheOrderOfTheLoops) {
  Circles holes = kThreeHoles;
  const auto larger = [](const Circle& a, const Circle& b) { return a.radius < b.radius; };
  std::sort(holes.begin() + 1, holes.end(), larger);
  do {
    EXPECT_LT(difference(canonicalCircles(holes), kThreeHoles), 1e-15);
  } while (std::next_permutation(holes.begin() + 1, holes.end(), larger));
}

TEST(CanonicalCircles, OfAMirrorImageAreMirrored) {
  for (const std::size_t outer : {1, 2, 3}) {
    EXPECT_LT(
        difference(canonicalCircles(mirrored(inverted(kThreeHoles, outer))), mirrored(kThreeHoles)),
        1e-13);
  }
  EXPECT_GT(difference(mirrored(kThreeHoles), kThreeHoles), 1);
}

TEST(CanonicalCircles, AreNormalized) {
  Circles circles = {{{1, 2}, 3}};
  for (int k = 0; k < 40; ++k) {
    circles.push_back({Complex(1, 2) + std::polar(0.4 * std::sqrt(k + 0.5), 2.4 * k),
                       0.12 + 0.03 * std::cos(7.0 * k)});
  }
  const Circles result = canonicalCircles(circles);
  ASSERT_EQ(result.size(), circles.size());
  EXPECT_EQ(result[0].center, Complex(0));
  EXPECT_EQ(result[0].radius, 1);
  EXPECT_EQ(result[1].center, Complex(0));
  EXPECT_EQ(result[2].center.imag(), 0);
  EXPECT_GT(result[2].center.real(), 0);
  for (std::size_t k = 1; k < result.size(); ++k) {
    EXPECT_LT(std::abs(result[k].center) + result[k].radius, 1);
    EXPECT_LT(result[k].radius, (1 + 2e-3) * result[k - 1].radius);
    for (std::size_t j = 1; j < k; ++j) {
      EXPECT_GT(std::abs(result[k].center - result[j].center), result[k].radius + result[j].radius);
    }
  }
  EXPECT_LT(difference(canonicalCircles(result), result), 1e-13);
}

// Domains with symmetries, of which a mesh knows less: the same up to what it does not know. Equal
// are: the holes around the middle one; two holes that a reflection exchanges, so that each choice
// mirrors the other one's domain; all circles around the corners of an icosahedron.
TEST(CanonicalCircles, OfSymmetricHolesAreTheSameForAllMeshes) {
  Circles ring = {{0, 1}, {0, 0.3}};
  for (int k = 0; k < 5; ++k) {
    ring.push_back({std::polar(0.65, 2 * std::numbers::pi * k / 5 + 0.1), 0.15});
  }
  const Circles reflected = {{0, 1}, {0.5, 0.25}, {-0.5, 0.25}, {{0, 0.7}, 0.15}, {{0, -0.8}, 0.1}};
  // Spherical caps of radius 0.4 around the corners of an icosahedron, from a point in one of them.
  Circles icosahedral = {{0, 1 / std::tan(0.2)}, {0, std::tan(0.2)}};
  for (int k = 0; k < 10; ++k) {
    const double polar = k % 2 == 0 ? std::atan(2.0) : std::numbers::pi - std::atan(2.0);
    const double inner = std::tan((polar - 0.4) / 2), outer = std::tan((polar + 0.4) / 2);
    icosahedral.push_back(
        {std::polar((inner + outer) / 2, std::numbers::pi * k / 5), (outer - inner) / 2});
  }
  for (const Circles& circles : {ring, reflected, icosahedral}) {
    const Circles exact = canonicalCircles(circles);
    double largest = 0;
    for (unsigned seed = 0; seed < 40; ++seed) {
      const Circles found = canonicalCircles(disturbed(circles, seed, 1e-6));
      largest = std::max(largest, difference(found, exact));
    }
    // Möbius maps that bring circles to the middle stretch others at most (1 + c) / (1 - c) times
    // for a centre of absolute value c, here 9; an error of a hole counts, and that of the circles
    // that the domain is placed by.
    EXPECT_LT(largest, 3 * 9 * 1e-6);
  }
}

}  // namespace
}  // namespace moduli
