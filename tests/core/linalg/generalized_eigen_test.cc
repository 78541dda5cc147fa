#include "core/linalg/generalized_eigen.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "tests/core/testing.h"

namespace moduli {
namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

SparseMatrix lowerTriangle(Eigen::Index n, const Entries& entries) {
  SparseMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

void addEdge(Entries& entries, int i, int j, double weight) {
  entries.emplace_back(i, i, weight);
  entries.emplace_back(j, j, weight);
  entries.emplace_back(std::max(i, j), std::min(i, j), -weight);
}

/// Graph Laplacian of a torus of rows x columns vertices; its eigenvalues are sums of
/// 4 sin^2(pi k / rows) and 4 sin^2(pi l / columns).
SparseMatrix torusGraph(int rows, int columns) {
  Entries entries;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      addEdge(entries, i * columns + j, ((i + 1) % rows) * columns + j, 1);
      addEdge(entries, i * columns + j, i * columns + (j + 1) % columns, 1);
    }
  }
  return lowerTriangle(rows * columns, entries);
}

std::vector<double> torusValues(int rows, int columns) {
  std::vector<double> values;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double a = std::sin(std::numbers::pi * i / rows);
      const double b = std::sin(std::numbers::pi * j / columns);
      values.push_back(4 * a * a + 4 * b * b);
    }
  }
  std::sort(values.begin(), values.end());
  return values;
}

/// Uneven weights on a torus graph, and masses between 1/2 and 2, by a fixed rule.
struct Problem {
  SparseMatrix stiffness;
  Eigen::VectorXd mass;
};

Problem unevenProblem(int rows, int columns) {
  const auto wave = [](int i) { return std::sin(12.9898 * i + 1); };
  Problem problem{torusGraph(rows, columns), Eigen::VectorXd(rows * columns)};
  Entries entries;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int at = i * columns + j;
      addEdge(entries, at, ((i + 1) % rows) * columns + j, 1.5 + wave(at));
      addEdge(entries, at, i * columns + (j + 1) % columns, 1.5 + wave(at + 7));
      problem.mass[at] = std::exp2(wave(at + 3));
    }
  }
  problem.stiffness = lowerTriangle(rows * columns, entries);
  return problem;
}

EigenOptions wanting(Eigen::Index count, double shift) {
  EigenOptions options;
  options.count = count;
  options.shift = shift;
  return options;
}

TEST(GeneralizedEigen, OfATorusGraphAreSumsOfSquaredSinesWithTheirMultiplicities) {
  // A square torus has multiplets of 4 and 8; residuals of 1e-8 leave values right to 1e-8 of
  // value + shift.
  Context context;
  const std::vector<double> exact = torusValues(40, 40);
  const auto pairs = smallestEigenpairs(context, torusGraph(40, 40), Eigen::VectorXd::Ones(1600),
                                        wanting(60, 0.02));
  ASSERT_OK(pairs);
  for (int k = 0; k < 60; ++k) EXPECT_NEAR(pairs->values[k], exact[k], 1e-8 * (exact[k] + 0.02));
  EXPECT_LE(pairs->largest_residual, 1e-8);
  EXPECT_GT(pairs->dimension, 60);
}

TEST(GeneralizedEigen, OfFewRowsAreTheSame) {
  Context context;
  const std::vector<double> exact = torusValues(12, 15);
  const auto pairs =
      smallestEigenpairs(context, torusGraph(12, 15), Eigen::VectorXd::Ones(180), wanting(180, 1));
  ASSERT_OK(pairs);
  for (int k = 0; k < 180; ++k) EXPECT_NEAR(pairs->values[k], exact[k], 1e-12);
}

TEST(GeneralizedEigen, AgreeWithADenseSolver) {
  Context context;
  const Problem problem = unevenProblem(25, 30);
  const auto pairs =
      smallestEigenpairs(context, problem.stiffness, problem.mass, wanting(50, 0.05));
  ASSERT_OK(pairs);
  const Eigen::MatrixXd whole =
      Eigen::MatrixXd(problem.stiffness.selfadjointView<Eigen::Lower>() *
                      Eigen::MatrixXd::Identity(problem.mass.size(), problem.mass.size()));
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> dense(
      whole, problem.mass.asDiagonal().toDenseMatrix());
  for (int k = 0; k < 50; ++k) {
    EXPECT_NEAR(pairs->values[k], dense.eigenvalues()[k], 1e-8 * (dense.eigenvalues()[k] + 0.05));
  }
  // Eigen equations and orthonormality of the vectors themselves.
  const Eigen::MatrixXd& x = pairs->vectors;
  const Eigen::MatrixXd gram = x.transpose() * problem.mass.asDiagonal() * x;
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(50, 50)).cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::MatrixXd residual =
      whole * x - problem.mass.asDiagonal() * x * pairs->values.asDiagonal();
  // |A x - nu x| <= 1e-8 nu, times |stiffness + shift mass| <= 30 in units of |mass^(1/2) x|.
  EXPECT_LT(residual.cwiseAbs().maxCoeff(), 30 * 1e-8 * 2);
}

TEST(GeneralizedEigen, DoNotDependOnTheOrderOfTheRows) {
  Context context;
  const Problem problem = unevenProblem(25, 30);
  const Eigen::Index n = problem.mass.size();
  Eigen::PermutationMatrix<Eigen::Dynamic> order(n);
  for (int i = 0; i < n; ++i) order.indices()[i] = static_cast<int>(Eigen::Index{7919} * i % n);
  const Eigen::MatrixXd whole = Eigen::MatrixXd(problem.stiffness.selfadjointView<Eigen::Lower>() *
                                                Eigen::MatrixXd::Identity(n, n));
  const Eigen::MatrixXd turned = order * whole * order.transpose();
  const SparseMatrix renumbered =
      Eigen::MatrixXd(turned.triangularView<Eigen::Lower>()).sparseView();
  const auto one = smallestEigenpairs(context, problem.stiffness, problem.mass, wanting(50, 0.05));
  const auto two = smallestEigenpairs(context, renumbered, order * problem.mass, wanting(50, 0.05));
  ASSERT_OK(one);
  ASSERT_OK(two);
  // Both to the square of the residual over the gaps; see the header.
  EXPECT_LT((one->values - two->values).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(GeneralizedEigen, FindAMultipletOfSixteen) {
  // Sixteen equal cycles: every eigenvalue of one of them, sixteen or thirty-two times.
  Context context;
  Entries entries;
  for (int copy = 0; copy < 16; ++copy) {
    for (int i = 0; i < 30; ++i) addEdge(entries, copy * 30 + i, copy * 30 + (i + 1) % 30, 1);
  }
  const auto pairs = smallestEigenpairs(context, lowerTriangle(480, entries),
                                        Eigen::VectorXd::Ones(480), wanting(32, 0.01));
  ASSERT_OK(pairs);
  const double sine = std::sin(std::numbers::pi / 30);
  for (int k = 0; k < 16; ++k) EXPECT_NEAR(pairs->values[k], 0, 1e-10);
  for (int k = 16; k < 32; ++k) EXPECT_NEAR(pairs->values[k], 4 * sine * sine, 1e-8);
}

TEST(GeneralizedEigen, StopWhenCancelled) {
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  const SparseMatrix graph = torusGraph(40, 40);
  EXPECT_THAT(smallestEigenpairs(context, graph, Eigen::VectorXd::Ones(1600), wanting(20, 0.1)),
              FailsWith(Reason::kCancelled));
}

TEST(GeneralizedEigen, RefuseWhatDoesNotFit) {
  Context context;
  const SparseMatrix graph = torusGraph(5, 5);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(25);
  EXPECT_THAT(smallestEigenpairs(context, graph, ones, wanting(26, 1)),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(smallestEigenpairs(context, graph, Eigen::VectorXd::Ones(24), wanting(2, 1)),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(smallestEigenpairs(context, graph, ones, wanting(2, 0)),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(smallestEigenpairs(context, graph, -ones, wanting(2, 1)),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(smallestEigenpairs(context, -graph, ones, wanting(2, 1)),
              FailsWith(Reason::kNotPositiveDefinite));
}

}  // namespace
}  // namespace moduli
