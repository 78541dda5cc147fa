#include "core/optimize/hessian_factor.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/core/optimize/functions.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Indefinite = HessianFactor::Indefinite;

TEST(HessianFactor, SolvesAndInvertsOnThePattern) {
  const NamedObjective f = named("rosenbrock", 100);
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(100, 1.05);
  Context context;
  ASSERT_OK(f.objective->moveTo(context, x));
  HessianFactor factor;
  ASSERT_OK(factor.factorize(context, *f.objective, Indefinite::kFail));
  EXPECT_EQ(factor.shift(), 0);
  EXPECT_EQ(factor.fixed(), -1);
  EXPECT_EQ(factor.freedom(), 100);
  const Eigen::MatrixXd dense = denseOf(f.objective->hessian());
  const Eigen::MatrixXd inverse = dense.inverse();
  const Eigen::VectorXd b = NormalDeviates(1).vector(100);
  const auto solution = factor.solve(context, b);
  ASSERT_OK(solution);
  // The condition is below 1e5.
  EXPECT_LE((*solution - inverse * b).norm(), 1e-10 * solution->norm());
  const auto entries = factor.inverse(context);
  ASSERT_OK(entries);
  EXPECT_EQ(entries->nonZeros(), 199);
  const Eigen::MatrixXd expected = denseOf(onPattern(inverse, f.objective->hessian()));
  EXPECT_LE((denseOf(*entries) - expected).norm(), 1e-10 * expected.norm());
}

TEST(HessianFactor, ShiftsWhatIsNotDefiniteAndSaysByHowMuch) {
  Quadratic saddle(Eigen::Vector3d(1, -1, 2).asDiagonal(), Eigen::Vector3d::Zero());
  Context context;
  ASSERT_OK(saddle.moveTo(context, Eigen::Vector3d(1, 1, 1)));
  HessianFactor factor;
  EXPECT_THAT(factor.factorize(context, saddle, Indefinite::kFail),
              FailsWith(Reason::kNotPositiveDefinite));
  ASSERT_OK(factor.factorize(context, saddle, Indefinite::kShift));
  EXPECT_GT(factor.shift(), 1);
  EXPECT_LE(factor.shift(), 8);  // At most four times what was needed, 1 or 2 in the norm.
  EXPECT_EQ(factor.norm(), 2);
  const auto p = factor.solve(context, Eigen::Vector3d(1, 1, 1));
  ASSERT_OK(p);
  EXPECT_NEAR((*p)[1], 1 / (factor.shift() - 1), 1e-14);
  // A definite one is left alone again.
  Quadratic bowl(Eigen::Vector3d(1, 1, 2).asDiagonal(), Eigen::Vector3d::Zero());
  ASSERT_OK(factor.factorize(context, bowl, Indefinite::kShift));
  EXPECT_EQ(factor.shift(), 0);
}

TEST(HessianFactor, HealsASemidefiniteHessianWithAShiftOfRounding) {
  Quadratic gutter(Eigen::Vector2d(4, 0).asDiagonal(), Eigen::Vector2d::Zero());
  Linear flat(Eigen::Vector2d(1, 1));
  Context context;
  HessianFactor factor;
  ASSERT_OK(factor.factorize(context, gutter, Indefinite::kShift));
  EXPECT_EQ(factor.shift(), 4e-12);
  ASSERT_OK(factor.factorize(context, flat, Indefinite::kShift));
  EXPECT_EQ(factor.shift(), 1e-12);
}

TEST(HessianFactor, FixesOneUnknownWhereConstantsChangeNothing) {
  Ring ring(NormalDeviates(1).vector(6), false);
  Context context;
  const Eigen::VectorXd x = NormalDeviates(2).vector(6);
  ASSERT_OK(ring.moveTo(context, x));
  HessianFactor factor;
  ASSERT_OK(factor.factorize(context, ring, Indefinite::kFail));
  ASSERT_GE(factor.fixed(), 0);
  EXPECT_EQ(factor.freedom(), 5);
  const auto p = factor.solve(context, ring.gradient());
  ASSERT_OK(p);
  EXPECT_EQ((*p)[factor.fixed()], 0);
  // It solves the whole system, for the gradient sums to 0.
  EXPECT_LE((denseOf(ring.hessian()) * *p - ring.gradient()).norm(), 1e-13);
  const auto inverse = factor.inverse(context);
  ASSERT_OK(inverse);
  EXPECT_EQ(denseOf(*inverse).row(factor.fixed()).cwiseAbs().maxCoeff(), 0);
}

TEST(HessianFactor, RefusesEntriesThatAreNoNumbersAndUseBeforeFactorizing) {
  Quadratic broken(Eigen::Vector2d(1, std::nan("")).asDiagonal(), Eigen::Vector2d::Zero());
  Context context;
  HessianFactor factor;
  EXPECT_THAT(factor.solve(context, Eigen::Vector2d(1, 1)), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(factor.inverse(context), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(factor.factorize(context, broken, Indefinite::kShift),
              FailsWith(Reason::kNotPositiveDefinite));
}

}  // namespace
}  // namespace moduli
