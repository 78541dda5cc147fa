#include "core/hyperbolic/bounded_su11.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/core/testing.h"

namespace moduli {
namespace {

double uniform(std::mt19937& random) {
  return static_cast<double>(random()) / 4294967296.0;
}

WideSu11 randomElement(std::mt19937& random) {
  return widened(rotation(6.3 * uniform(random)) * translation(4 * uniform(random)) *
                 rotation(6.3 * uniform(random)));
}

/// The larger error of an entry.
double errorOf(const BoundedSu11& g, const WideSu11& exact) {
  const WideSu11 wide{{g.g.a.real(), g.g.a.imag()}, {g.g.b.real(), g.g.b.imag()}};
  const Su11 off = rounded(WideSu11{wide.a - exact.a, wide.b - exact.b});
  return std::max(std::abs(off.a), std::abs(off.b));
}

TEST(BoundedSu11, ErrorsOfProductsAreWithinTheirBounds) {
  std::mt19937 random(7);
  double nearest = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    WideSu11 exact = randomElement(random);
    BoundedSu11 g(exact);
    for (int letter = 0; letter < 12; ++letter) {
      EXPECT_LE(errorOf(g, exact), g.error);
      nearest = std::max(nearest, errorOf(g, exact) / g.error);
      EXPECT_LE(leastDisplacement(g), displacement(rounded(exact)));
      const WideSu11 next = randomElement(random);
      exact = exact * inverse(next);
      g = g * inverse(BoundedSu11(next));
    }
  }
  // Not so far within that they would be useless.
  EXPECT_GT(nearest, 0.1);
}

TEST(BoundedSu11, AWordThatComesBackIsNotTakenForALongOne) {
  std::mt19937 random(3);
  std::vector<WideSu11> letters;
  for (int letter = 0; letter < 30; ++letter) letters.push_back(randomElement(random));
  WideSu11 exact;
  BoundedSu11 g;
  for (const WideSu11& letter : letters) {
    exact = exact * letter;
    g = g * BoundedSu11(letter);
  }
  const double longest = displacement(rounded(exact));
  EXPECT_GT(leastDisplacement(g), 0.99 * longest);
  EXPECT_LE(leastDisplacement(g), longest);
  std::reverse(letters.begin(), letters.end());
  for (const WideSu11& letter : letters) g = g * inverse(BoundedSu11(letter));
  // Doubles do not find back to 1.
  EXPECT_GT(displacement(g.g), 1e-6);
  EXPECT_EQ(leastDisplacement(g), 0);
}

}  // namespace
}  // namespace moduli
