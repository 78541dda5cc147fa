#include "core/forms/cotan.h"

#include <Eigen/Dense>
#include <cmath>
#include <numeric>

#include "core/forms/flat_triangle.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

MetricSurface triangle(double a, double b, double c) {
  return fromHalfedges(3, {{0, 1, 2}}, {kNone, kNone, kNone}, {a, b, c});
}

/// An isosceles triangle with legs 1 has the base angle's cotangent b / (2 h), h^2 = 1 - b^2 / 4.
TEST(FlatTriangle, IsAccurateForNeedles) {
  for (double b = 1; b > 1e-15; b /= 10) {
    const double h = std::sqrt((1 - b / 2) * (1 + b / 2));
    const double area = triangleArea(1, b, 1);
    EXPECT_NEAR(area / (b * h / 2), 1, 2e-15) << b;
    EXPECT_NEAR(oppositeCotangent(1, b, 1, area) / (b / (2 * h)), 1, 4e-15) << b;
    // At the apex, cot = (1 - b^2 / 2) / (2 area).
    EXPECT_NEAR(oppositeCotangent(b, 1, 1, area) / ((1 - b * b / 2) / (b * h)), 1, 4e-15) << b;
  }
}

/// Legs 1 and a base that is shorter than 2 by s: h^2 = s (1 - s / 4).
TEST(FlatTriangle, IsAccurateForCaps) {
  for (double s = 0.5; s > 1e-12; s /= 4) {  // 2 - s is exact.
    const double h = std::sqrt(s * (1 - s / 4));
    const double area = triangleArea(1, 2 - s, 1);
    EXPECT_NEAR(area / (h * (1 - s / 2)), 1, 4e-15) << s;
    EXPECT_NEAR(oppositeCotangent(1, 2 - s, 1, area) / ((1 - s / 2) / h), 1, 8e-15) << s;
  }
}

TEST(FlatTriangle, KnowsPythagoreanTriangles) {
  EXPECT_EQ(triangleArea(3, 4, 5), 6);
  EXPECT_EQ(triangleArea(5, 12, 13), 30);
  EXPECT_EQ(oppositeCotangent(5, 3, 4, 6), 0);
  EXPECT_EQ(oppositeCotangent(3, 4, 5, 6), 4.0 / 3);
  EXPECT_EQ(triangleArea(1, 2, 3), 0);
  EXPECT_EQ(triangleArea(1, 2, 4), 0);
}

TEST(FlatTriangle, GradientOfALinearFunctionHasItsLength) {
  const std::array<Eigen::Vector2d, 3> corner{Eigen::Vector2d(0.2, -0.1), {1.7, 0.4}, {0.9, 1.1}};
  const Eigen::Vector2d slope(0.6, -2.3);
  for (int turn = 0; turn < 3; ++turn) {
    std::array<double, 3> lengths{};
    std::array<double, 3> along{};
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector2d side = corner[(c + turn + 1) % 3] - corner[(c + turn) % 3];
      lengths[c] = side.norm();
      along[c] = slope.dot(side);
    }
    EXPECT_NEAR(TriangleFrame(lengths).gradient(along).norm(), slope.norm(), 1e-14);
  }
}

TEST(Cotan, EquilateralWeights) {
  const MetricSurface one = triangle(2, 2, 2);
  for (const double w : cotanWeights(one.surface, one.lengths)) {
    EXPECT_NEAR(w, 0.5 / std::sqrt(3.0), 1e-16);
  }
  EXPECT_NEAR(faceAreas(one.surface, one.lengths)[0], std::sqrt(3.0), 1e-15);
}

TEST(Cotan, WeightsDoNotDependOnScale) {
  const MetricSurface torus = torusOfRevolution(2, 1, 12, 8);
  const auto weights = cotanWeights(torus.surface, torus.lengths);
  const MetricSurface large = scale(torus, 0x1p100);
  EXPECT_EQ(cotanWeights(large.surface, large.lengths), weights);
}

TEST(Cotan, VertexAreasAddUpToTheArea) {
  const MetricSurface torus = torusOfRevolution(2, 1, 12, 8);
  const auto faces = faceAreas(torus.surface, torus.lengths);
  const auto vertices = vertexAreas(torus.surface, torus.lengths);
  EXPECT_NEAR(std::accumulate(vertices.begin(), vertices.end(), 0.0),
              std::accumulate(faces.begin(), faces.end(), 0.0), 1e-12);
}

Eigen::MatrixXd dense(const SparseMatrix& lower) {
  return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
}

TEST(Cotan, StiffnessIsPositiveSemidefiniteWithConstantsAsKernel) {
  // Thin triangles: many weights are negative.
  const MetricSurface torus = insertVertices(torusOfRevolution(2, 0.3, 14, 5), 60, 0.001, 3);
  const auto weights = cotanWeights(torus.surface, torus.lengths);
  EXPECT_LT(*std::min_element(weights.begin(), weights.end()), -1);
  const Eigen::MatrixXd L = dense(stiffnessMatrix(torus.surface, weights));
  const double size = L.cwiseAbs().rowwise().sum().maxCoeff();
  EXPECT_LT(L.rowwise().sum().cwiseAbs().maxCoeff(), 1e-14 * size);
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(L).eigenvalues() / size;
  EXPECT_GT(values[0], -1e-14);
  EXPECT_GT(values[1], 1e-10);
}

/// On a flat surface the coordinates are harmonic away from the boundary, and their energy is the
/// area.
TEST(Cotan, LinearFunctionsAreHarmonicOnTheFlatDisk) {
  std::mt19937 random(7);
  std::vector<Eigen::Vector3d> positions;
  std::vector<Triangle> faces;
  const int n = 9;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      positions.emplace_back(i + 0.4 * uniform(random), j + 0.4 * uniform(random), 0);
      if (i + 1 == n || j + 1 == n) continue;
      const Index v = i * n + j;
      faces.push_back({v, v + n, v + n + 1});
      faces.push_back({v, v + n + 1, v + 1});
    }
  }
  const MetricSurface disk = fromPositions(positions, faces);
  const SparseMatrix lower =
      stiffnessMatrix(disk.surface, cotanWeights(disk.surface, disk.lengths));
  Eigen::VectorXd x(n * n);
  for (int v = 0; v < n * n; ++v) x[v] = positions[v].x() - 2 * positions[v].y();
  const Eigen::VectorXd Lx = lower.selfadjointView<Eigen::Lower>() * x;
  for (Index v = 0; v < n * n; ++v) {
    if (disk.surface.isBoundaryVertex(v)) continue;
    EXPECT_NEAR(Lx[v], 0, 1e-12);
  }
  const auto areas = faceAreas(disk.surface, disk.lengths);
  EXPECT_NEAR(x.dot(Lx), 5 * std::accumulate(areas.begin(), areas.end(), 0.0), 1e-10);
}

TEST(Cotan, PinnedStiffnessLacksOneRowAndColumn) {
  const MetricSurface torus = torusOfRevolution(2, 1, 7, 5);
  const auto weights = cotanWeights(torus.surface, torus.lengths);
  const Eigen::MatrixXd whole = dense(stiffnessMatrix(torus.surface, weights));
  for (const Index pinned : {0, 17, 34}) {
    const Eigen::MatrixXd part = dense(pinnedStiffness(torus.surface, weights, pinned));
    ASSERT_EQ(part.rows(), 34);
    for (Index i = 0; i < 34; ++i) {
      for (Index j = 0; j < 34; ++j) {
        EXPECT_EQ(part(i, j), whole(i + (i >= pinned), j + (j >= pinned)));
      }
    }
  }
}

TEST(Cotan, SeveralEdgesBetweenTwoVerticesAddUpAndLoopsCountForNothing) {
  const MetricSurface loops = flatTorus({0.2, 1.1}, 1, 1, 0, 1);
  const SparseMatrix none =
      stiffnessMatrix(loops.surface, cotanWeights(loops.surface, loops.lengths));
  ASSERT_EQ(none.rows(), 1);
  EXPECT_EQ(none.coeff(0, 0), 0);

  const MetricSurface pair = flatTorus({0.2, 1.1}, 2, 1, 0, 1);
  const auto weights = cotanWeights(pair.surface, pair.lengths);
  const SparseMatrix lower = stiffnessMatrix(pair.surface, weights);
  double between = 0;
  for (Index e = 0; e < pair.surface.edgeCount(); ++e) {
    const Index h = pair.surface.halfedge(e);
    if (pair.surface.tail(h) != pair.surface.head(h)) between += weights[e];
  }
  EXPECT_EQ(lower.nonZeros(), 3);
  EXPECT_NEAR(lower.coeff(1, 0), -between, 1e-14);
  EXPECT_NEAR(lower.coeff(0, 0), between, 1e-14);
}

}  // namespace
}  // namespace moduli
