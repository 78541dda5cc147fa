#include "core/forms/quadrilateral.h"

#include <cmath>
#include <string>
#include <vector>

#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Result<BoundedNumber> modulusOf(const MetricSurface& mesh, const std::array<Index, 4>& corners) {
  Context context;
  return quadrilateralModulus(context, mesh.surface, mesh.lengths, corners);
}

/// nx x ny cells of the given size, each cut along one diagonal; vertex (i, j) is j (nx + 1) + i.
MetricSurface rectangle(int nx, int ny, double width, double height) {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Triangle> faces;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) positions.emplace_back(width * i / nx, height * j / ny, 0);
  }
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const Index v = j * (nx + 1) + i;
      faces.push_back({v, v + 1, v + nx + 2});
      faces.push_back({v, v + nx + 2, v + nx + 1});
    }
  }
  return fromPositions(positions, std::move(faces));
}

/// CHECKS E6.
TEST(QuadrilateralModulus, OfARectangleIsWidthOverHeight) {
  const MetricSurface mesh = rectangle(6, 4, 3.2, 1.1);
  const std::array<Index, 4> corners{0, 6, 34, 28};
  for (const MetricSurface& other :
       {mesh, flipEdges(insertVertices(mesh, 50, 0.05, 3), 400, 4), scale(mesh, 1e200)}) {
    const auto modulus = modulusOf(other, corners);
    ASSERT_OK(modulus);
    EXPECT_NEAR(modulus->value / (3.2 / 1.1), 1, 1e-12);
    EXPECT_LE(modulus->lower, modulus->value);
    EXPECT_LE(modulus->value, modulus->upper);
    EXPECT_LT(modulus->upper / modulus->lower, 1 + 1e-11);
  }
  const auto turned = modulusOf(mesh, {6, 34, 28, 0});
  ASSERT_OK(turned);
  EXPECT_NEAR(turned->value / (1.1 / 3.2), 1, 1e-12);
}

/// CHECKS E7 and E8: a reflection that exchanges the pairs of sides forces 1; in any case the two
/// bounds are reciprocal to those of the quadrilateral turned by one corner.
TEST(QuadrilateralModulus, OfASymmetricSquareIsOneAndTurningGivesTheReciprocal) {
  MetricSurface square = plate(3, 3, {});
  // Corners of the plate by their places: found as the vertices with one cell.
  std::vector<Index> corners;
  for (Index v = 0; v < square.surface.vertexCount(); ++v) {
    if (!square.surface.isBoundaryVertex(v)) continue;
    int faces = 0;
    for (Index h = square.surface.outgoing(v); h != kNone; h = square.surface.rotate(h)) ++faces;
    if (faces == 2) corners.push_back(v);
  }
  ASSERT_EQ(corners.size(), 4U);
  // Numbered by columns: lower left, upper left, lower right, upper right.
  const std::array<Index, 4> around{corners[0], corners[2], corners[3], corners[1]};
  // A bump of the metric that both diagonals' reflections keep.
  for (double& length : square.lengths) length *= length < 0.9 ? 1.3 : 1;
  const auto modulus = modulusOf(subdivide(square, 2), around);
  ASSERT_OK(modulus);
  EXPECT_NEAR(modulus->value, 1, 1e-12);
  EXPECT_LT(modulus->lower, 1);

  const MetricSurface skew = insertVertices(rectangle(4, 3, 2, 1), 30, 0.1, 7);
  double before = 2;
  for (const int n : {1, 2, 4}) {
    const MetricSurface mesh = subdivide(skew, n);
    const auto there = modulusOf(mesh, {1, 4, 19, 16});  // Corner a in the middle of a side.
    const auto back = modulusOf(mesh, {4, 19, 16, 1});
    ASSERT_OK(there);
    ASSERT_OK(back);
    EXPECT_NEAR(there->value * back->value, 1, 1e-12);
    EXPECT_NEAR(there->lower * back->upper, 1, 1e-10);
    const double gap = there->lower * back->lower;  // M_h M'_h <= 1, and tends to it.
    EXPECT_LT(gap, 1);
    EXPECT_LT(1 - gap, 0.75 * before);
    before = 1 - gap;
  }
}

TEST(QuadrilateralModulus, RefusesWrongCornersByName) {
  const MetricSurface mesh = rectangle(4, 3, 2, 1);
  const auto inside = modulusOf(mesh, {0, 4, 19, 6});
  EXPECT_THAT(inside, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(inside.status().message(), testing::HasSubstr("corner 3 (vertex 6)"));
  EXPECT_THAT(modulusOf(mesh, {6, 4, 19, 15}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(modulusOf(mesh, {0, 15, 19, 4}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(modulusOf(mesh, {0, 4, 4, 15}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(modulusOf(mesh, {0, 4, 19, -7}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(modulusOf(plate(3, 3, {{1, 1}}), {0, 1, 2, 3}),
              FailsWith(Reason::kUnsupportedTopology));
}

}  // namespace
}  // namespace moduli
