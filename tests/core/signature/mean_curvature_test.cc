#include "core/signature/mean_curvature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "tests/core/mesh/shapes.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

double total(const TriangleSoup& soup) {
  const std::vector<double> shares = integratedMeanCurvature(surfaces::mesh(soup));
  return std::accumulate(shares.begin(), shares.end(), 0.0);
}

TriangleSoup cube() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
          {{0, 2, 1},
           {0, 3, 2},
           {4, 5, 6},
           {4, 6, 7},
           {0, 1, 5},
           {0, 5, 4},
           {1, 2, 6},
           {1, 6, 5},
           {2, 3, 7},
           {2, 7, 6},
           {3, 0, 4},
           {3, 4, 7}}};
}

/// Splits a face at a point of its edge from corner 0 to corner 1 on its own side only, and fills
/// the gap with a face without area.
TriangleSoup withCap(TriangleSoup soup, std::size_t face, double at) {
  const auto [a, b, c] = soup.faces[face];
  const auto middle = static_cast<Index>(soup.vertices.size());
  soup.vertices.push_back((1 - at) * soup.vertices[a] + at * soup.vertices[b]);
  soup.faces[face] = {a, middle, c};
  soup.faces.push_back({middle, b, c});
  soup.faces.push_back({a, b, middle});
  return soup;
}

TEST(MeanCurvature, OfAUnitCubeIsThreePi) {
  // Half of twelve edges times a quarter turn; diagonals are flat.
  EXPECT_NEAR(total(cube()), 3 * kPi, 1e-13);
  for (const double share : integratedMeanCurvature(surfaces::mesh(cube()))) {
    EXPECT_NEAR(share, 3 * kPi / 8, 1e-14);
  }
}

TEST(MeanCurvature, OfASphereConvergesToItsRadius) {
  // H = 1 / R over 4 pi R^2, at second order.
  const double coarse = total(surfaces::sample("sphere", {{"radius", 3}, {"resolution", 6}}));
  const double fine = total(surfaces::sample("sphere", {{"radius", 3}, {"resolution", 12}}));
  const double exact = 4 * kPi * 3;
  EXPECT_NEAR(fine, exact, 0.01 * exact);
  EXPECT_NEAR((coarse - exact) / (fine - exact), 4, 0.3);
}

TEST(MeanCurvature, ChangesSignInsideOut) {
  EXPECT_NEAR(total(surfaces::reversed(cube())), -3 * kPi, 1e-13);
}

TEST(MeanCurvature, DoesNotSeeFacesWithoutArea) {
  // Along a true edge (face 0 has its edge from corner 1 to 2 on the rim; 4 lies across 0-1) and
  // along a flat diagonal, and a cap on the cap.
  for (std::size_t face = 0; face < 12; ++face) {
    const TriangleSoup capped = withCap(cube(), face, 0.3);
    EXPECT_NEAR(total(capped), 3 * kPi, 1e-12) << face;
    EXPECT_NEAR(total(withCap(capped, 13, 0.6)), 3 * kPi, 1e-12) << face;
    EXPECT_NEAR(total(surfaces::moved(capped, 1)), 3 * kPi, 1e-12) << face;
  }
}

TEST(MeanCurvature, DoesNotSeeNeedlesOfEqualPoints) {
  // A vertex doubled in place along an edge: two faces of zero width.
  TriangleSoup soup = cube();
  const auto twin = static_cast<Index>(soup.vertices.size());
  soup.vertices.push_back(soup.vertices[0]);
  // Faces (0 2 1) and (0 3 2) keep vertex 0; the other faces at 0 get its twin, and the fan is
  // closed by two needles.
  for (std::size_t f = 2; f < soup.faces.size(); ++f) {
    for (Index& v : soup.faces[f]) v = v == 0 ? twin : v;
  }
  soup.faces.push_back({0, 1, twin});
  soup.faces.push_back({0, twin, 3});
  EXPECT_NEAR(total(soup), 3 * kPi, 1e-13);
}

TEST(MeanCurvature, OfAFlatDoubleIsThatOfItsConvexRim) {
  TriangleSoup soup{{{0, 0, 0}, {3, 0, 0}, {0, 4, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  // Half of the perimeter 12 times pi, however it lies in space.
  EXPECT_NEAR(total(soup), 6 * kPi, 1e-12);
  EXPECT_NEAR(total(surfaces::moved(soup, 1)), 6 * kPi, 1e-12);
}

TEST(MeanCurvature, ScalesWithLength) {
  EXPECT_NEAR(total(surfaces::moved(cube(), 1e-160)) * 1e160, 3 * kPi, 1e-12);
  EXPECT_NEAR(total(surfaces::moved(cube(), 1e150)) * 1e-150, 3 * kPi, 1e-12);
}

}  // namespace
}  // namespace moduli
