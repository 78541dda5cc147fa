#include "core/optimize/line_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "core/optimize/lbfgs_memory.h"
#include "tests/core/optimize/functions.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

LineStep search(Objective& objective, const Eigen::VectorXd& x, const Eigen::VectorXd& direction,
                const LineSearchOptions& options) {
  Context context;
  EXPECT_OK(objective.moveTo(context, x));
  auto found = searchLine(context, objective, x, direction, options);
  EXPECT_OK(found);
  return found.ok() ? *std::move(found) : LineStep();
}

LineSearchOptions exact(double first_step) {
  LineSearchOptions options;
  options.kind = LineSearchKind::kExact;
  options.first_step = first_step;
  options.slope_tolerance = 1e-10;
  return options;
}

TEST(LineSearch, OfAParabolaIsExactWhereverItBegins) {
  // (x - 3)^2 from 0 along -1: t = 3, slope 6 to 1e-10 of itself.
  Quadratic parabola(Eigen::MatrixXd::Constant(1, 1, 2.0), Eigen::VectorXd::Constant(1, 3.0));
  for (const double first : {1e-6, 0.1, 1.0, 3.0, 50.0, 1e6}) {
    const LineStep found = search(parabola, Eigen::VectorXd::Zero(1),
                                  Eigen::VectorXd::Constant(1, -1.0), exact(first));
    EXPECT_EQ(found.end, LineSearchEnd::kFound);
    EXPECT_NEAR(found.step, 3, 3e-10) << first;
    EXPECT_LE(found.evaluations, 30) << first;
    EXPECT_EQ(found.x[0], found.step);
    EXPECT_EQ(parabola.gradient(), found.gradient);  // The objective is there.
  }
}

TEST(LineSearch, OfABarrierStaysInsideAndFindsTheRoot) {
  // x - log x from 5 towards 0: the minimum at t = 4, the edge at 5.
  LogBarrier barrier(Eigen::VectorXd::Ones(1));
  for (const double first : {1e-3, 1.0, 4.999, 5.0, 100.0}) {
    const LineStep found =
        search(barrier, Eigen::VectorXd::Constant(1, 5.0), Eigen::VectorXd::Ones(1), exact(first));
    EXPECT_EQ(found.end, LineSearchEnd::kFound);
    EXPECT_NEAR(found.x[0], 1, 1e-9) << first;
  }
}

TEST(LineSearch, BacktracksToAStepThatGainsEnough) {
  // From x = 1 of x^2 along 2 times 100: 100 is far too long; f must fall by 1e-4 t q.
  Quadratic parabola(Eigen::MatrixXd::Constant(1, 1, 2.0), Eigen::VectorXd::Zero(1));
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(1);
  const LineStep found = search(parabola, x, Eigen::VectorXd::Constant(1, 200.0), {});
  EXPECT_EQ(found.end, LineSearchEnd::kFound);
  EXPECT_LT(found.step, 0.01);
  EXPECT_LE(found.value, 1 - 1e-4 * found.step * 400);
}

TEST(LineSearch, LengthensStepsThatAreFarTooShort) {
  Quadratic parabola(Eigen::MatrixXd::Constant(1, 1, 2.0), Eigen::VectorXd::Zero(1));
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(1);
  LineSearchOptions options;
  options.lengthen = true;
  const LineStep found = search(parabola, x, Eigen::VectorXd::Constant(1, 1e-8), options);
  EXPECT_EQ(found.end, LineSearchEnd::kFound);
  // Slope at the end at most 9/10 of 2: x at most 0.9.
  EXPECT_LE(found.x[0], 0.9);
  options.lengthen = false;
  EXPECT_EQ(search(parabola, x, Eigen::VectorXd::Constant(1, 1e-8), options).step, 1);
}

TEST(LineSearch, SeesValuesThatFallForEver) {
  Linear slope(Eigen::VectorXd::Ones(1));
  LineSearchOptions lengthening;
  lengthening.lengthen = true;
  for (const LineSearchOptions& options : {lengthening, exact(1)}) {
    const LineStep found =
        search(slope, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1), options);
    EXPECT_EQ(found.end, LineSearchEnd::kUnbounded);
  }
}

TEST(LineSearch, JudgesBySlopesWhereValuesAreRounded) {
  // 1e8 + x^2 from 1e-6: the gain of 1e-12 is far below the rounding of 1e-8.
  Wrapped lifted(
      std::make_unique<Quadratic>(Eigen::MatrixXd::Constant(1, 1, 2.0), Eigen::VectorXd::Zero(1)));
  lifted.change = [](double value) { return 1e8 + value; };
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 1e-6);
  for (const LineSearchOptions& options : {LineSearchOptions(), exact(1)}) {
    const LineStep found = search(lifted, x, x, options);
    EXPECT_EQ(found.end, LineSearchEnd::kFound);
    EXPECT_EQ(found.x[0], 0);
    // A step three times too long is seen to be.
    const LineStep shortened = search(lifted, x, 3 * x, options);
    EXPECT_EQ(shortened.end, LineSearchEnd::kFound);
    EXPECT_LE(std::abs(shortened.x[0]), 1e-7);
  }
}

TEST(LineSearch, JudgesBySlopesWhereValuesAreNoise) {
  // Noise above what the size of the value tells, as of a sum of terms that cancel.
  Wrapped noisy(
      std::make_unique<Quadratic>(Eigen::MatrixXd::Constant(1, 1, 2.0), Eigen::VectorXd::Zero(1)));
  int turn = 0;
  noisy.change = [&](double) { return 1e-9 * ++turn; };
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 1e-6);
  const LineStep found = search(noisy, x, x, {});
  EXPECT_EQ(found.end, LineSearchEnd::kFound);
  EXPECT_EQ(found.x[0], 0);
}

TEST(LineSearch, TakesFailuresToConvergeForStepsTooLong) {
  class Picky : public Wrapped {
   public:
    using Wrapped::Wrapped;
    Status moveTo(Context& context, const Eigen::VectorXd& x) override {
      if (x[0] < 0.5) return {Reason::kNoConvergence, "too far"};
      if (x[0] > 10) return {Reason::kInternal, "broken"};
      return Wrapped::moveTo(context, x);
    }
  } picky(
      std::make_unique<Quadratic>(Eigen::MatrixXd::Constant(1, 1, 2.0), Eigen::VectorXd::Ones(1)));
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 2.0);
  for (const LineSearchOptions& options : {LineSearchOptions(), exact(1)}) {
    const LineStep found = search(picky, x, Eigen::VectorXd::Constant(1, 2.0), options);
    EXPECT_EQ(found.end, LineSearchEnd::kFound);
    EXPECT_GE(found.x[0], 0.5);
    Context context;
    ASSERT_OK(picky.moveTo(context, x));
    EXPECT_THAT(searchLine(context, picky, x, Eigen::VectorXd::Constant(1, -20.0), options),
                FailsWith(Reason::kInternal));
  }
}

TEST(LbfgsMemory, ReproducesTheStepOfTheLastChange) {
  // The secant equation: the inverse takes the last change of the gradient to the last step.
  LbfgsMemory memory(3);
  const Eigen::MatrixXd H = Eigen::Vector4d(1, 2, 3, 4).asDiagonal();
  NormalDeviates deviates(1);
  EXPECT_TRUE(memory.empty());
  for (int k = 0; k < 6; ++k) {
    const Eigen::VectorXd step = deviates.vector(4);
    memory.add(step, H * step);
    EXPECT_LE((memory.apply(H * step) - step).norm(), 1e-14 * step.norm());
    // And stays positive definite.
    const Eigen::VectorXd g = deviates.vector(4);
    EXPECT_GT(g.dot(memory.apply(g)), 0);
  }
}

TEST(LbfgsMemory, IsTheDenseRecursionOfItsPairs) {
  // H' = (1 - s y^T / s.y) H (1 - y s^T / s.y) + s s^T / s.y, from the last s.y / y.y.
  const Eigen::MatrixXd A = randomMap(5, 2) * randomMap(5, 2).transpose();
  const Eigen::MatrixXd S = NormalDeviates(3).matrix(5, 3), Y = A * S;
  LbfgsMemory memory(3);
  Eigen::MatrixXd H =
      Eigen::MatrixXd::Identity(5, 5) * S.col(2).dot(Y.col(2)) / Y.col(2).squaredNorm();
  for (int k = 0; k < 3; ++k) {
    memory.add(S.col(k), Y.col(k));
    const double curvature = S.col(k).dot(Y.col(k));
    const Eigen::MatrixXd left =
        Eigen::MatrixXd::Identity(5, 5) - S.col(k) * Y.col(k).transpose() / curvature;
    H = (left * H * left.transpose() + S.col(k) * S.col(k).transpose() / curvature).eval();
  }
  const Eigen::VectorXd g = NormalDeviates(4).vector(5);
  EXPECT_LE((memory.apply(g) - H * g).norm(), 1e-13 * g.norm());
}

TEST(LbfgsMemory, IsTheInverseOfAQuadraticAfterConjugateSteps) {
  LbfgsMemory memory(4);
  const Eigen::Vector4d values(1, 5, 30, 200);
  for (int k = 0; k < 4; ++k)
    memory.add(Eigen::Vector4d::Unit(k), values[k] * Eigen::Vector4d::Unit(k));
  const Eigen::Vector4d g(1, 2, 3, 4);
  EXPECT_LE((memory.apply(g) - g.cwiseQuotient(values)).norm(), 1e-14);
}

TEST(LbfgsMemory, RefusesNegativeCurvature) {
  LbfgsMemory memory(4);
  memory.add(Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0));
  EXPECT_TRUE(memory.empty());
  EXPECT_EQ(memory.apply(Eigen::Vector2d(1, 2)), Eigen::Vector2d(1, 2));
}

}  // namespace
}  // namespace moduli
