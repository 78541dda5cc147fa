#include "core/intrinsic/undo_flips.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/intrinsic/intrinsic_samples.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

/// Triangles of a surface, each given by its sides.
SignedTriangles trianglesOf(Geometry geometry, const Connectivity& surface,
                            const std::vector<double>& lengths) {
  SignedTriangles triangles;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    TriangleValues sides;
    for (int c = 0; c < 3; ++c) sides[c] = lengths[surface.edge(3 * f + c)];
    const TriangleValues opposite = triangleAngles(geometry, sides);
    triangles.lengths.insert(triangles.lengths.end(), sides.begin(), sides.end());
    for (int c = 0; c < 3; ++c) triangles.angles.push_back(opposite[(c + 1) % 3]);
  }
  return triangles;
}

double angleBetween(double a, double b) {
  return std::abs(std::remainder(a - b, 2 * std::numbers::pi));
}

/// Flips a triangulation at random, convex or not, and what it is like then as a start of its own.
struct Flipped {
  IntrinsicTriangulation there;  ///< With the flips from the start.
  IntrinsicTriangulation back;   ///< From what they end with, with flips back to the start.
  Flipped(const Connectivity& surface, int count, unsigned seed)
      : there(surface, std::vector<double>(surface.edgeCount(), 1.0)), back(there) {
    std::mt19937 random(seed);
    std::vector<Index> flips;
    while (static_cast<int>(flips.size()) < count) {
      const auto h = static_cast<Index>(random() % there.halfedgeCount());
      if (!there.canFlip(h)) continue;
      there.flip(h, 1);
      flips.push_back(h);
    }
    const Connectivity end = there.connectivity();
    back = IntrinsicTriangulation(end, std::vector<double>(end.edgeCount(), 1.0));
    // Four flips of an edge put it back in its place.
    for (auto h = flips.rbegin(); h != flips.rend(); ++h) {
      for (int times = 0; times < 3; ++times) back.flip(*h, 1);
    }
  }
};

/// There and back again through triangulations whose straight edges fold over one another, some of
/// them loops that are points. Rounding grows with the lengths, some ten or twenty edges; at 1e-9 a
/// direction that was lost shows at once.
void expectReturn(Geometry geometry, const Connectivity& surface,
                  const std::vector<double>& lengths, int flips) {
  const SignedTriangles start = trianglesOf(geometry, surface, lengths);
  int shrunk = 0, folded = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Flipped flipped(surface, flips, seed);
    const SignedTriangles there = undoFlips(geometry, flipped.back, start);
    for (std::size_t h = 0; h < there.lengths.size(); ++h) {
      shrunk += there.lengths[h] < 1e-9;
      folded += there.angles[h] < 0;
    }
    const SignedTriangles again = undoFlips(geometry, flipped.there, there);
    for (std::size_t h = 0; h < start.lengths.size(); ++h) {
      EXPECT_NEAR(again.lengths[h], start.lengths[h], 1e-9);
      EXPECT_LT(angleBetween(again.angles[h], start.angles[h]), 1e-9);
    }
  }
  EXPECT_GT(folded, 100);
  EXPECT_GT(shrunk, 0);
}

TEST(UndoFlips, ComesBackFromWildTriangulationsOfAFlatTorus) {
  const MetricSurface torus = insertVertices(flatTorus({0.3, 1.2}, 3, 3, 0.2, 1), 12, 0.05, 5);
  expectReturn(Geometry::kEuclidean, torus.surface, torus.lengths, 60);
}

TEST(UndoFlips, ComesBackFromWildTriangulationsOfAHyperbolicSurface) {
  const auto bolza = makeIntrinsicSample("bolza");
  ASSERT_OK(bolza);
  std::vector<double> lengths;
  for (Index e = 0; e < bolza->connectivity.edgeCount(); ++e) {
    lengths.push_back(bolza->lengths[e]);
  }
  expectReturn(Geometry::kHyperbolic, bolza->connectivity, lengths, 30);
}

}  // namespace
}  // namespace moduli
