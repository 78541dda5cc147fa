#include "core/optimize/named_objectives.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/optimize/changed_objective.h"
#include "tests/core/optimize/functions.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

/// Central difference of fourth order along w of what `look` sees.
Eigen::MatrixXd difference(Objective& objective, const Eigen::VectorXd& x, const Eigen::VectorXd& w,
                           const std::function<Eigen::MatrixXd()>& look) {
  constexpr double kStep = 1e-3;
  const auto at = [&](int k) {
    Context context;
    EXPECT_OK(objective.moveTo(context, x + k * kStep * w));
    return look();
  };
  return (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * kStep);
}

/// Each derivative is the difference of the one before: 1e-12 of the fifth derivative, which is
/// some 10 to 1000 times the value compared, and rounding 1e-16 / 1e-3 of the greatest value.
void expectDerivatives(Objective& f, const Eigen::VectorXd& x, const std::string& what) {
  const Eigen::Index n = f.dimension();
  const Eigen::VectorXd w = NormalDeviates(11).vector(n).normalized();
  const auto value = [&]() -> Eigen::MatrixXd { return Eigen::VectorXd::Constant(1, f.value()); };
  const auto gradient = [&]() -> Eigen::MatrixXd { return f.gradient(); };
  const auto hessian = [&]() -> Eigen::MatrixXd { return denseOf(f.hessian()); };
  const Eigen::MatrixXd slope = difference(f, x, w, value);
  const Eigen::MatrixXd turn = difference(f, x, w, gradient);
  const Eigen::MatrixXd change = difference(f, x, w, hessian);
  Context context;
  ASSERT_OK(f.moveTo(context, x));
  const double size = std::abs(f.value()) + f.gradient().norm() + hessian().norm() + change.norm();
  EXPECT_NEAR(slope(0, 0), f.gradient().dot(w), 1e-9 * size) << what;
  EXPECT_LE((turn - hessian() * w).norm(), 1e-9 * size) << what;
  // w . tau(P) = sum P_ab (dH/dw)_ab, for a P on the pattern of the Hessian.
  const Eigen::MatrixXd random = NormalDeviates(12).matrix(n, n);
  const SparseMatrix weights = onPattern(random + random.transpose(), f.hessian());
  const double expected = denseOf(weights).cwiseProduct(change).sum();
  EXPECT_NEAR(f.thirdContraction(weights).dot(w), expected, 1e-8 * size) << what;
}

TEST(NamedObjectives, HaveTheDerivativesTheySay) {
  for (const std::string& name : objectiveNames()) {
    for (const Eigen::Index n : {2, 3, 8}) {
      const NamedObjective f = named(name, n);
      EXPECT_TRUE(f.objective->hasThirdDerivatives());
      EXPECT_EQ(f.objective->name(), name);
      expectDerivatives(*f.objective, 0.8 * f.start + Eigen::VectorXd::Constant(n, 0.3), name);
    }
  }
  Ring ring(NormalDeviates(1).vector(5), false), pinned(NormalDeviates(1).vector(5), true);
  expectDerivatives(ring, NormalDeviates(2).vector(5), "ring");
  expectDerivatives(pinned, NormalDeviates(2).vector(4), "pinned ring");
}

TEST(ChangedObjectives, HaveTheDerivativesTheySay) {
  using Kind = MonotoneTransform::Kind;
  for (const std::string name : {"exp-sum", "rosenbrock", "quartic"}) {
    for (const Kind kind : {Kind::kExponential, Kind::kSquareRoot, Kind::kLogarithm}) {
      MonotoneTransform changed(named(name, 3).objective, kind, 0.05);
      expectDerivatives(changed, Eigen::Vector3d(.4, -.2, .3), changed.name());
    }
    AffineChange changed(named(name, 4).objective, randomMap(4, 1) / 4,
                         NormalDeviates(2).vector(4));
    expectDerivatives(changed, Eigen::Vector4d(.4, -.2, .3, .1), changed.name());
  }
}

TEST(ChangedObjectives, OfAnAffineMapTakePointsThereAndBack) {
  AffineChange changed(named("exp-sum", 5).objective, randomMap(5, 3), NormalDeviates(4).vector(5));
  const Eigen::VectorXd x = NormalDeviates(5).vector(5);
  EXPECT_LE((changed.backward(changed.forward(x)) - x).norm(), 1e-14 * x.norm());
}

TEST(NamedObjectives, AreStationaryAtTheirMinimizers) {
  for (const std::string& name : objectiveNames()) {
    const NamedObjective f = named(name, 6);
    if (!f.minimizer) continue;
    Context context;
    ASSERT_OK(f.objective->moveTo(context, *f.minimizer));
    EXPECT_LE(f.objective->gradient().norm(), 1e-13) << name;
    const double least = f.objective->value();
    ASSERT_OK(f.objective->moveTo(context, *f.minimizer + Eigen::VectorXd::Constant(6, 1e-3)));
    EXPECT_GT(f.objective->value(), least) << name;
  }
}

TEST(NamedObjectives, OfAQuadraticHasTheConditionAskedFor) {
  const NamedObjective f = named("quadratic", 12, 1e4);
  const Eigen::VectorXd values =
      denseOf(f.objective->hessian()).selfadjointView<Eigen::Lower>().eigenvalues();
  EXPECT_NEAR(values.minCoeff(), 1, 1e-10);
  EXPECT_NEAR(values.maxCoeff(), 1e4, 1e-8);
}

TEST(NamedObjectives, OutsideTheDomainIsInfinite) {
  const NamedObjective f = named("log-barrier", 2);
  Context context;
  ASSERT_OK(f.objective->moveTo(context, Eigen::Vector2d(1, 0)));
  EXPECT_EQ(f.objective->value(), std::numeric_limits<double>::infinity());
  ASSERT_OK(f.objective->moveTo(context, Eigen::Vector2d(1, 1)));
  EXPECT_TRUE(std::isfinite(f.objective->value()));
}

TEST(NamedObjectives, OfExponentsDoNotOverflowInTheirLogarithm) {
  const NamedObjective f = named("log-sum-exp", 3);
  Context context;
  ASSERT_OK(f.objective->moveTo(context, Eigen::Vector3d(1e4, -1e4, 1e4)));
  EXPECT_TRUE(std::isfinite(f.objective->value()));
  EXPECT_TRUE(f.objective->gradient().allFinite());
}

TEST(NamedObjectives, AreTheSameForTheSameSeed) {
  for (const std::string name : {"quadratic", "log-sum-exp", "exp-sum"}) {
    const NamedObjective a = named(name, 4, 10, 5), b = named(name, 4, 10, 5),
                         other = named(name, 4, 10, 6);
    Context context;
    const Eigen::Vector4d x(1, 2, 3, 4);
    ASSERT_OK(a.objective->moveTo(context, x));
    ASSERT_OK(b.objective->moveTo(context, x));
    ASSERT_OK(other.objective->moveTo(context, x));
    EXPECT_EQ(a.objective->value(), b.objective->value());
    EXPECT_NE(a.objective->value(), other.objective->value());
  }
}

TEST(NamedObjectives, RefuseWhatTheyAreNotAndSayWhatThereIs) {
  const auto unknown = makeObjective("himmelblau", {});
  ASSERT_THAT(unknown, FailsWith(Reason::kInvalidOption));
  for (const std::string& name : objectiveNames()) {
    EXPECT_NE(unknown.status().hint().find(name), std::string::npos) << name;
  }
  ObjectiveOptions options;
  for (const Eigen::Index n : {-1, 0, 1001}) {
    options.dimension = n;
    EXPECT_THAT(makeObjective("exp-sum", options), FailsWith(Reason::kInvalidOption)) << n;
  }
  options.dimension = 1;
  EXPECT_THAT(makeObjective("rosenbrock", options), FailsWith(Reason::kInvalidOption));
  EXPECT_OK(makeObjective("quadratic", options));
  options.dimension = 10001;
  EXPECT_THAT(makeObjective("quartic", options), FailsWith(Reason::kInvalidOption));
  options.dimension = 3;
  for (const double condition : {0.5, std::nan(""), std::numeric_limits<double>::infinity()}) {
    options.condition = condition;
    EXPECT_THAT(makeObjective("quadratic", options), FailsWith(Reason::kInvalidOption));
  }
}

TEST(NamedObjectives, RefuseAPointOfAnotherSize) {
  const NamedObjective f = named("quartic", 3);
  Context context;
  EXPECT_THAT(f.objective->moveTo(context, Eigen::Vector2d(1, 2)),
              FailsWith(Reason::kInvalidOption));
}

TEST(NormalDeviates, AreOfMeanZeroAndVarianceOne) {
  // Of 100000: the mean to 4 / sqrt(n), the variance to 4 sqrt(2 / n), the fourth moment 3 to
  // 4 sqrt(96 / n).
  const Eigen::ArrayXd sample = NormalDeviates(1).vector(100000).array();
  EXPECT_NEAR(sample.mean(), 0, 0.0127);
  EXPECT_NEAR(sample.square().mean(), 1, 0.018);
  EXPECT_NEAR(sample.square().square().mean(), 3, 0.124);
}

TEST(NormalDeviates, AreTheseNumbersOnEveryMachine) {
  NormalDeviates deviates(1);
  EXPECT_NEAR(deviates.next(), -0.03939995675415531, 1e-14);
  EXPECT_NEAR(deviates.next(), -0.3868317616210395, 1e-14);
}

}  // namespace
}  // namespace moduli
