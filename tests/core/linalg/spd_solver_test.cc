#include "core/linalg/spd_solver.h"

#include <cmath>
#include <limits>
#include <thread>

#include "core/linalg/factor_backend.h"
#include "tests/core/linalg/matrices.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

class SpdSolverTest : public testing::TestWithParam<BackendKind> {
 protected:
  Result<SpdSolver> make(const SparseMatrix& matrix) {
    return SpdSolver::make(context_, matrix, makeBackend(GetParam()));
  }

  Context context_;
};

INSTANTIATE_TEST_SUITE_P(EveryBackend, SpdSolverTest, testing::ValuesIn(availableBackends()),
                         [](const auto& kind) {
                           return kind.param == BackendKind::kCholmod ? "Cholmod" : "Eigen";
                         });

TEST_P(SpdSolverTest, RecoversKnownSolutions) {
  const SparseMatrix matrix = gridLaplacian({40, 50, 1}, 1e-3);
  auto solver = make(matrix);
  ASSERT_OK(solver);
  const Eigen::MatrixXd expected = randomMatrix(matrix.rows(), 7, 1);
  const auto x =
      solver->solve(context_, Eigen::MatrixXd(matrix.selfadjointView<Eigen::Lower>() * expected));
  ASSERT_OK(x);
  // The condition number is (8 + 1e-3) / 1e-3 < 1e4, so rounding leaves less than 1e4 * 1e-15.
  EXPECT_LT((*x - expected).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT(solver->largestResidual(), 1e-15);
}

TEST_P(SpdSolverTest, SolvesTheSameUnjudged) {
  const SparseMatrix matrix = gridLaplacian({20, 30, 1}, 0.1);
  auto solver = make(matrix);
  ASSERT_OK(solver);
  const Eigen::MatrixXd b = randomMatrix(matrix.rows(), 3, 8);
  const auto judged = solver->solve(context_, b), unjudged = solver->solveUnjudged(context_, b);
  ASSERT_OK(judged);
  ASSERT_OK(unjudged);
  // The condition number is 8.1 / 0.1, b is below 1 and the matrix above 0.1.
  EXPECT_LT((*judged - *unjudged).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_THAT(solver->solveUnjudged(context_, randomMatrix(5, 1, 1)),
              FailsWith(Reason::kInvalidOption));
}

TEST_P(SpdSolverTest, RefactorizeSolvesWithTheNewValues) {
  const SparseMatrix matrix = gridLaplacian({20, 30, 1}, 0.1);
  auto solver = make(matrix);
  ASSERT_OK(solver);
  const Eigen::MatrixXd b = randomMatrix(matrix.rows(), 2, 2);
  const auto before = solver->solve(context_, b);
  ASSERT_OK(before);
  ASSERT_OK(solver->refactorize(context_, SparseMatrix(matrix * 4.0)));
  const auto after = solver->solve(context_, b);
  ASSERT_OK(after);
  EXPECT_LT((*after * 4.0 - *before).cwiseAbs().maxCoeff(), 1e-12);
}

// An edge of a graph flipped: another pattern of the same size.
TEST_P(SpdSolverTest, ReanalyzeSolvesAnotherPatternAndRefactorizesItThen) {
  auto solver = make(gridLaplacian({20, 30, 1}, 0.1));
  ASSERT_OK(solver);
  const SparseMatrix other = gridLaplacian({30, 20, 1}, 0.2);
  const Eigen::MatrixXd b = randomMatrix(other.rows(), 2, 2);
  for (const double factor : {1.0, 4.0}) {
    const SparseMatrix matrix = other * factor;
    ASSERT_OK(factor == 1 ? solver->reanalyze(context_, matrix)
                          : solver->refactorize(context_, matrix));
    const auto x = solver->solve(context_, b);
    ASSERT_OK(x);
    // A diagonally dominant system with excess 0.2: the inverse has norm 5.
    EXPECT_LT((matrix.selfadjointView<Eigen::Lower>() * *x - b).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST_P(SpdSolverTest, ReanalyzeRefusesAnotherSizeAndRecoversFromAnIndefiniteMatrix) {
  const SparseMatrix matrix = gridLaplacian({5, 6, 1}, 0.1);
  auto solver = make(matrix);
  ASSERT_OK(solver);
  EXPECT_THAT(solver->reanalyze(context_, gridLaplacian({5, 7, 1}, 0.1)),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(solver->reanalyze(context_, SparseMatrix(matrix * -1.0)),
              FailsWith(Reason::kNotPositiveDefinite));
  EXPECT_FALSE(solver->solve(context_, Eigen::MatrixXd::Ones(30, 1)).ok());
  EXPECT_OK(solver->reanalyze(context_, matrix));
  EXPECT_OK(solver->solve(context_, Eigen::MatrixXd::Ones(30, 1)));
}

TEST_P(SpdSolverTest, RefactorizeRefusesAnotherPattern) {
  auto solver = make(gridLaplacian({5, 6, 1}, 0.1));
  ASSERT_OK(solver);
  EXPECT_THAT(solver->refactorize(context_, gridLaplacian({6, 5, 1}, 0.1)),
              FailsWith(Reason::kInvalidOption));
}

TEST_P(SpdSolverTest, NamesTheColumnThatIsNotPositive) {
  SparseMatrix matrix = gridLaplacian({12, 1, 1}, 5);
  matrix.coeffRef(7, 7) = -100;
  const auto negative = make(matrix);
  ASSERT_THAT(negative, FailsWith(Reason::kNotPositiveDefinite));
  EXPECT_THAT(negative.status().message(), testing::EndsWith("column 7"));
  matrix.coeffRef(7, 7) = std::numeric_limits<double>::quiet_NaN();
  const auto undefined = make(matrix);
  ASSERT_THAT(undefined, FailsWith(Reason::kNotPositiveDefinite));
  EXPECT_THAT(undefined.status().message(), testing::EndsWith("column 7"));
}

TEST_P(SpdSolverTest, FindsIndefiniteMatricesWithPositiveDiagonal) {
  SparseMatrix matrix(2, 2);
  matrix.insert(0, 0) = 1;
  matrix.insert(1, 0) = 2;
  matrix.insert(1, 1) = 1;
  matrix.makeCompressed();
  EXPECT_THAT(make(matrix), FailsWith(Reason::kNotPositiveDefinite));
}

TEST_P(SpdSolverTest, RecoversFromAMatrixThatWasNotPositive) {
  const SparseMatrix good = gridLaplacian({9, 9, 1}, 1);
  SparseMatrix bad = good;
  bad.coeffRef(40, 40) = -1;
  auto solver = make(good);
  ASSERT_OK(solver);
  const Eigen::MatrixXd b = randomMatrix(good.rows(), 1, 3);
  EXPECT_THAT(solver->refactorize(context_, bad), FailsWith(Reason::kNotPositiveDefinite));
  EXPECT_THAT(solver->solve(context_, b), FailsWith(Reason::kInvalidOption));
  EXPECT_OK(solver->refactorize(context_, good));
  EXPECT_OK(solver->solve(context_, b));
}

TEST_P(SpdSolverTest, RefusesWhatIsNotALowerTriangle) {
  SparseMatrix upper(3, 3);
  upper.insert(0, 2) = 1;
  upper.makeCompressed();
  EXPECT_THAT(make(upper), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(make(SparseMatrix(3, 4)), FailsWith(Reason::kInvalidOption));
  auto solver = make(gridLaplacian({3, 1, 1}, 1));
  ASSERT_OK(solver);
  EXPECT_THAT(solver->solve(context_, Eigen::MatrixXd::Ones(4, 1)),
              FailsWith(Reason::kInvalidOption));
}

TEST_P(SpdSolverTest, SolvesEmptySystems) {
  auto solver = make(SparseMatrix(0, 0));
  ASSERT_OK(solver);
  const auto x = solver->solve(context_, Eigen::MatrixXd(0, 2));
  ASSERT_OK(x);
  EXPECT_EQ(x->cols(), 2);
}

TEST_P(SpdSolverTest, SolvesForZeroRightHandSides) {
  auto solver = make(gridLaplacian({4, 4, 1}, 1));
  ASSERT_OK(solver);
  const auto x = solver->solve(context_, Eigen::MatrixXd::Zero(16, 3));
  ASSERT_OK(x);
  EXPECT_EQ(x->cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(solver->largestResidual(), 0);
}

TEST_P(SpdSolverTest, ScalingChangesNoResidual) {
  for (const double scale : {1e-200, 1e200}) {
    const SparseMatrix matrix = gridLaplacian({20, 20, 1}, 1e-6) * scale;
    auto solver = make(matrix);
    ASSERT_OK(solver);
    EXPECT_OK(solver->solve(context_, randomMatrix(400, 2, 4)));
    EXPECT_LT(solver->largestResidual(), 1e-15);
  }
}

TEST_P(SpdSolverTest, StopsBetweenThePhasesWhenCancelled) {
  for (const std::string_view phase : {"analyse", "factorize", "solve"}) {
    Context context;
    CancelToken token;
    context.setCancelToken(token);
    context.setProgressSink([&](const Progress& progress) {
      if (progress.stage == phase) token.cancel();
    });
    const SparseMatrix matrix = gridLaplacian({10, 10, 1}, 1);
    auto solver = SpdSolver::make(context, matrix, makeBackend(GetParam()));
    if (phase == "solve") {
      ASSERT_OK(solver);
      EXPECT_THAT(solver->solve(context, Eigen::MatrixXd::Ones(100, 1)),
                  FailsWith(Reason::kCancelled));
    } else {
      EXPECT_THAT(solver, FailsWith(Reason::kCancelled));
    }
  }
}

/// The larger cubic grid fills in so much that CHOLMOD orders by nested dissection, whose random
/// numbers come from the state that all threads of the process share.
TEST_P(SpdSolverTest, SameBytesFromSeveralThreadsAtOnce) {
  const int side = GetParam() == BackendKind::kCholmod ? 25 : 12;
  const SparseMatrix matrix = gridLaplacian({side, side, side}, 0.01);
  const Eigen::MatrixXd b = randomMatrix(matrix.rows(), 2, 5);
  std::vector<Eigen::MatrixXd> answers(4);
  std::vector<std::thread> threads;
  for (Eigen::MatrixXd& answer : answers) {
    threads.emplace_back([&] {
      Context context;
      auto solver = SpdSolver::make(context, matrix, makeBackend(GetParam()));
      if (solver.ok()) answer = *solver->solve(context, b);
    });
  }
  for (std::thread& thread : threads) thread.join();
  ASSERT_EQ(answers[0].rows(), matrix.rows());
  for (const Eigen::MatrixXd& answer : answers) EXPECT_TRUE(answer == answers[0]);
}

TEST(SpdSolverBackends, Agree) {
  const SparseMatrix matrix = gridLaplacian({30, 30, 1}, 1e-2);
  const Eigen::MatrixXd b = randomMatrix(matrix.rows(), 3, 6);
  Context context;
  std::vector<Eigen::MatrixXd> answers;
  for (const BackendKind kind : availableBackends()) {
    auto solver = SpdSolver::make(context, matrix, makeBackend(kind));
    ASSERT_OK(solver);
    auto x = solver->solve(context, b);
    ASSERT_OK(x);
    answers.push_back(*x);
  }
  // Condition number below 1e3, solutions up to 1e2.
  for (const auto& x : answers) EXPECT_LT((x - answers[0]).cwiseAbs().maxCoeff(), 1e-11);
}

using Fault = std::function<void(Eigen::MatrixXd&)>;

/// A back end that computes rightly and answers wrongly.
class FaultyBackend : public FactorBackend {
 public:
  FaultyBackend(BackendKind kind, Fault fault)
      : sound_(makeBackend(kind)), fault_(std::move(fault)) {}
  Status analyze(const SparseMatrix& matrix) override { return sound_->analyze(matrix); }
  Status factorize(const SparseMatrix& matrix) override { return sound_->factorize(matrix); }
  Result<Eigen::MatrixXd> solve(const Eigen::MatrixXd& b) override {
    auto x = sound_->solve(b);
    if (x.ok()) fault_(*x);
    return x;
  }
  Result<BlockFactor> blocks() override { return sound_->blocks(); }

 private:
  std::unique_ptr<FactorBackend> sound_;
  Fault fault_;
};

TEST_P(SpdSolverTest, PlantedWrongAnswersAreErrors) {
  const SparseMatrix matrix = gridLaplacian({40, 40, 1}, 1e-4);
  const std::vector<Fault> faults{
      [](Eigen::MatrixXd& x) { x(17, 1) = 0; },
      [](Eigen::MatrixXd& x) { x(17, 1) += 1e-6; },
      [](Eigen::MatrixXd& x) { x(17, 1) = std::numeric_limits<double>::quiet_NaN(); },
      [](Eigen::MatrixXd& x) { x(17, 1) = std::numeric_limits<double>::infinity(); },
      [](Eigen::MatrixXd& x) { x *= 2; },
      [](Eigen::MatrixXd& x) { x.row(3).swap(x.row(4)); },
      [](Eigen::MatrixXd& x) { x.col(1).setZero(); },
      [](Eigen::MatrixXd& x) { x.setConstant(std::numeric_limits<double>::max()); },
  };
  for (std::size_t i = 0; i < faults.size(); ++i) {
    auto solver =
        SpdSolver::make(context_, matrix, std::make_unique<FaultyBackend>(GetParam(), faults[i]));
    ASSERT_OK(solver);
    EXPECT_THAT(solver->solve(context_, randomMatrix(matrix.rows(), 2, 7)),
                FailsWith(Reason::kResidualTooLarge))
        << "fault " << i;
    EXPECT_GT(solver->largestResidual(), 1e-12);
  }
}

TEST_P(SpdSolverTest, RefinementRepairsSmallErrors) {
  const SparseMatrix matrix = gridLaplacian({40, 40, 1}, 1e-4);
  auto solver = SpdSolver::make(
      context_, matrix,
      std::make_unique<FaultyBackend>(GetParam(), [](Eigen::MatrixXd& x) { x *= 1 + 1e-5; }));
  ASSERT_OK(solver);
  const Eigen::MatrixXd expected = randomMatrix(matrix.rows(), 2, 8);
  const auto x =
      solver->solve(context_, Eigen::MatrixXd(matrix.selfadjointView<Eigen::Lower>() * expected));
  ASSERT_OK(x);
  // Each of two steps shrinks the error 1e-5 by 1e-5; rounding leaves 1e5 (condition) * 1e-15.
  EXPECT_LT((*x - expected).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace moduli
