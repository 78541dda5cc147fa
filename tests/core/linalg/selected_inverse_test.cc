#include "core/linalg/selected_inverse.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "core/linalg/factor_backend.h"
#include "tests/core/linalg/matrices.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

class SelectedInverseTest : public testing::TestWithParam<BackendKind> {
 protected:
  SpdSolver make(const SparseMatrix& matrix) {
    auto solver = SpdSolver::make(context_, matrix, makeBackend(GetParam()));
    EXPECT_OK(solver);
    return *std::move(solver);
  }

  Context context_;
};

INSTANTIATE_TEST_SUITE_P(EveryBackend, SelectedInverseTest, testing::ValuesIn(availableBackends()),
                         [](const auto& kind) {
                           return kind.param == BackendKind::kCholmod ? "Cholmod" : "Eigen";
                         });

Eigen::MatrixXd whole(const SparseMatrix& lower) {
  return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
}

/// B B^T + I of a matrix with `entries` random entries: the condition number is about `entries`
/// squared over the size.
SparseMatrix randomSpd(int size, int entries, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Eigen::Triplet<double>> triplets;
  for (int k = 0; k < entries; ++k) {
    const auto row = static_cast<int>(random() % static_cast<unsigned>(size));
    const auto column = static_cast<int>(random() % static_cast<unsigned>(size));
    triplets.emplace_back(row, column, static_cast<double>(random()) / 2147483648.0 - 1.0);
  }
  SparseMatrix b(size, size), one(size, size);
  b.setFromTriplets(triplets.begin(), triplets.end());
  one.setIdentity();
  SparseMatrix lower = SparseMatrix(b * b.transpose() + one).triangularView<Eigen::Lower>();
  lower.makeCompressed();
  return lower;
}

/// The largest error of entries beside the dense inverse, in units of its largest entry.
double errorOf(const SparseMatrix& matrix, const SparseMatrix& selected) {
  const Eigen::MatrixXd inverse = whole(matrix).inverse();
  double error = 0;
  for (Eigen::Index column = 0; column < selected.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(selected, column); it; ++it) {
      error = std::max(error, std::abs(it.value() - inverse(it.row(), column)));
    }
  }
  return error / inverse.cwiseAbs().maxCoeff();
}

double condition(const SparseMatrix& matrix) {
  const Eigen::VectorXd values = whole(matrix).selfadjointView<Eigen::Lower>().eigenvalues();
  return values.maxCoeff() / values.minCoeff();
}

TEST_P(SelectedInverseTest, IsTheDenseInverseOfRandomMatrices) {
  for (const int size : {1, 2, 3, 10, 60, 200}) {
    for (const int fill : {1, 2, 6}) {
      const SparseMatrix matrix = randomSpd(size, fill * size / 2, 7u * size + fill);
      const auto selected = make(matrix).inverseOnPattern(context_, matrix);
      ASSERT_OK(selected);
      ASSERT_EQ(selected->nonZeros(), matrix.nonZeros());
      // Both inverses are good to some epsilons times the condition number.
      EXPECT_LT(errorOf(matrix, *selected), 20 * kEpsilon * condition(matrix)) << size;
    }
  }
}

TEST_P(SelectedInverseTest, IsTheDenseInverseOfLaplacians) {
  for (const double shift : {1e-6, 1e-2, 10.0}) {
    for (const std::array<int, 3> grid : {std::array{30, 1, 1}, {17, 23, 1}, {7, 8, 9}}) {
      const SparseMatrix matrix = gridLaplacian(grid, shift);
      const auto selected = make(matrix).inverseOnPattern(context_, matrix);
      ASSERT_OK(selected);
      EXPECT_LT(errorOf(matrix, *selected), 20 * kEpsilon * condition(matrix)) << shift;
    }
  }
}

TEST_P(SelectedInverseTest, OfADenseMatrixIsAllOfTheInverse) {
  const Eigen::MatrixXd b = randomMatrix(90, 90, 3);
  const Eigen::MatrixXd dense = b * b.transpose() + Eigen::MatrixXd::Identity(90, 90);
  const SparseMatrix matrix = Eigen::MatrixXd(dense.triangularView<Eigen::Lower>()).sparseView();
  const auto selected = make(matrix).inverseOnPattern(context_, matrix);
  ASSERT_OK(selected);
  EXPECT_EQ(selected->nonZeros(), 90 * 91 / 2);
  EXPECT_LT(errorOf(matrix, *selected), 20 * kEpsilon * condition(matrix));
}

// A tridiagonal matrix of -1, 2 + shift, -1 has (A^{-1})_ij = sinh((i + 1) t) sinh((n - j) t) /
// (sinh t sinh((n + 1) t)), i <= j, with 2 cosh t = 2 + shift.
TEST_P(SelectedInverseTest, IsTheKnownInverseOfAChain) {
  const int size = 500;
  const double t = 0.01;
  SparseMatrix matrix(size, size);
  for (int k = 0; k < size; ++k) {
    matrix.insert(k, k) = 2 * std::cosh(t);
    if (k + 1 < size) matrix.insert(k + 1, k) = -1;
  }
  matrix.makeCompressed();
  const auto selected = make(matrix).inverseOnPattern(context_, matrix);
  ASSERT_OK(selected);
  for (int j = 0; j < size; ++j) {
    for (SparseMatrix::InnerIterator it(*selected, j); it; ++it) {
      const auto i = static_cast<double>(it.row());
      const double expected = std::sinh((j + 1) * t) * std::sinh((size - i) * t) /
                              (std::sinh(t) * std::sinh((size + 1) * t));
      // Condition number 4 / t^2.
      EXPECT_NEAR(it.value() / expected, 1, 4 / (t * t) * 10 * kEpsilon);
    }
  }
}

TEST_P(SelectedInverseTest, FollowsTheValuesAndPatternsOfTheSolver) {
  const SparseMatrix first = gridLaplacian({12, 15, 1}, 0.1), other = gridLaplacian({15, 12, 1}, 1);
  SpdSolver solver = make(first);
  const auto before = solver.inverseOnPattern(context_, first);
  ASSERT_OK(before);
  ASSERT_OK(solver.refactorize(context_, SparseMatrix(first * 4.0)));
  const auto scaled = solver.inverseOnPattern(context_, first);
  ASSERT_OK(scaled);
  EXPECT_LT((*scaled * 4.0 - *before).norm(), 1e-12 * before->norm());
  ASSERT_OK(solver.reanalyze(context_, other));
  const auto after = solver.inverseOnPattern(context_, other);
  ASSERT_OK(after);
  EXPECT_LT(errorOf(other, *after), 20 * kEpsilon * condition(other));
  // The factor is untouched.
  const Eigen::MatrixXd b = randomMatrix(other.rows(), 1, 5);
  const auto x = solver.solve(context_, b);
  ASSERT_OK(x);
  EXPECT_LT((whole(other) * *x - b).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_P(SelectedInverseTest, GivesFewerEntriesWhereFewerAreAskedFor) {
  const SparseMatrix matrix = gridLaplacian({9, 9, 1}, 0.3);
  SparseMatrix diagonal(81, 81);
  diagonal.setIdentity();
  const auto selected = make(matrix).inverseOnPattern(context_, diagonal);
  ASSERT_OK(selected);
  EXPECT_EQ(selected->nonZeros(), 81);
  EXPECT_LT(errorOf(matrix, *selected), 1e-13);
}

TEST_P(SelectedInverseTest, RefusesWhatTheFactorHasNoPlaceFor) {
  // A forest of single edges: nothing fills in.
  SparseMatrix matrix(200, 200);
  for (int k = 0; k < 200; ++k) {
    matrix.insert(k, k) = 3;
    if (k % 2 == 0) matrix.insert(k + 1, k) = 1;
  }
  matrix.makeCompressed();
  SpdSolver solver = make(matrix);
  SparseMatrix outside = matrix;
  outside.coeffRef(151, 17) = 1;
  outside.makeCompressed();
  const auto refused = solver.inverseOnPattern(context_, outside);
  ASSERT_THAT(refused, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(refused.status().message(), testing::HasSubstr("(151, 17)"));
  EXPECT_THAT(solver.inverseOnPattern(context_, SparseMatrix(3, 3)),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(solver.inverseOnPattern(context_, SparseMatrix(outside.transpose())),
              FailsWith(Reason::kInvalidOption));
  EXPECT_FALSE(solver.refactorize(context_, SparseMatrix(matrix * -1.0)).ok());
  EXPECT_THAT(solver.inverseOnPattern(context_, matrix), FailsWith(Reason::kInvalidOption));
}

TEST_P(SelectedInverseTest, OfNothingIsNothing) {
  const auto selected = make(SparseMatrix(0, 0)).inverseOnPattern(context_, SparseMatrix(0, 0));
  ASSERT_OK(selected);
  EXPECT_EQ(selected->rows(), 0);
}

TEST_P(SelectedInverseTest, IsTheSameBytesAgainAndScales) {
  for (const double scale : {1.0, 0x1p-600, 0x1p600}) {
    const SparseMatrix matrix = gridLaplacian({25, 25, 1}, 1e-3);
    const auto once = make(matrix).inverseOnPattern(context_, matrix);
    const auto again = make(matrix * scale).inverseOnPattern(context_, matrix);
    ASSERT_OK(once);
    ASSERT_OK(again);
    // Powers of two with even exponents: the factor is scaled exactly.
    EXPECT_EQ((*again * scale - *once).norm(), 0);
  }
}

TEST_P(SelectedInverseTest, StopsWhenCancelled) {
  const SparseMatrix matrix = gridLaplacian({10, 10, 1}, 1);
  SpdSolver solver = make(matrix);
  Context context;
  CancelToken token;
  context.setCancelToken(token);
  context.setProgressSink([&](const Progress& progress) {
    if (progress.stage == "invert") token.cancel();
  });
  EXPECT_THAT(solver.inverseOnPattern(context, matrix), FailsWith(Reason::kCancelled));
}

/// A back end whose factor is wrong when it is asked for.
class FaultyBlocks : public FactorBackend {
 public:
  FaultyBlocks(BackendKind kind, std::function<void(BlockFactor&)> fault)
      : sound_(makeBackend(kind)), fault_(std::move(fault)) {}
  Status analyze(const SparseMatrix& matrix) override { return sound_->analyze(matrix); }
  Status factorize(const SparseMatrix& matrix) override { return sound_->factorize(matrix); }
  Result<Eigen::MatrixXd> solve(const Eigen::MatrixXd& b) override { return sound_->solve(b); }
  Result<BlockFactor> blocks() override {
    auto blocks = sound_->blocks();
    if (blocks.ok()) fault_(*blocks);
    return blocks;
  }

 private:
  std::unique_ptr<FactorBackend> sound_;
  std::function<void(BlockFactor&)> fault_;
};

TEST_P(SelectedInverseTest, OfAWrongFactorIsAnError) {
  const SparseMatrix matrix = gridLaplacian({20, 20, 1}, 0.1);
  const std::vector<std::function<void(BlockFactor&)>> faults{
      [](BlockFactor& blocks) { blocks.values[0] *= 1 + 1e-6; },
      [](BlockFactor& blocks) { blocks.values.back() *= 2; },
      [](BlockFactor& blocks) { blocks.values[0] = std::nan(""); },
      [](BlockFactor& blocks) { std::swap(blocks.order[3], blocks.order[300]); },
  };
  for (std::size_t k = 0; k < faults.size(); ++k) {
    auto solver =
        SpdSolver::make(context_, matrix, std::make_unique<FaultyBlocks>(GetParam(), faults[k]));
    ASSERT_OK(solver);
    const auto inverse = solver->inverseOnPattern(context_, matrix);
    EXPECT_FALSE(inverse.ok()) << "fault " << k;
    if (k < 3) {
      EXPECT_THAT(inverse, FailsWith(Reason::kResidualTooLarge)) << "fault " << k;
    }
  }
}

}  // namespace
}  // namespace moduli
