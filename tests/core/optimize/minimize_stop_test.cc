#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/optimize/minimize.h"
#include "tests/core/optimize/functions.h"
#include "tests/core/testing.h"

/// Why a search ends, and what it refuses to begin.
namespace moduli {
namespace {

constexpr std::array kMethods{MinimizeMethod::kAffineNormal, MinimizeMethod::kNewton,
                              MinimizeMethod::kLbfgs, MinimizeMethod::kGradient};
constexpr std::array kSearches{LineSearchKind::kBacktracking, LineSearchKind::kExact};

Minimum run(Objective& objective, const Eigen::VectorXd& start, const MinimizeOptions& options) {
  Context context;
  auto result = minimize(context, objective, start, options);
  EXPECT_OK(result);
  return result.ok() ? *std::move(result) : Minimum();
}

/// Runs all methods and searches, and expects the reason of each.
void expectReason(Objective& objective, const Eigen::VectorXd& start, StopReason reason,
                  const MinimizeOptions& given = {}) {
  for (const MinimizeMethod method : kMethods) {
    for (const LineSearchKind search : kSearches) {
      MinimizeOptions options = given;
      options.method = method;
      options.line_search = search;
      const Minimum found = run(objective, start, options);
      EXPECT_EQ(stopReasonName(found.reason), stopReasonName(reason))
          << methodName(method) << ", " << lineSearchName(search);
      EXPECT_EQ(found.converged, reason == StopReason::kConverged);
      EXPECT_TRUE(found.x.allFinite());
      EXPECT_EQ(found.value, found.trace.back().value);
    }
  }
}

TEST(MinimizeStop, AtTheMinimumAtOnce) {
  Quadratic bowl(Eigen::Vector3d(1, 2, 3).asDiagonal(), Eigen::Vector3d(1, 1, 1));
  expectReason(bowl, Eigen::Vector3d(1, 1, 1), StopReason::kConverged);
  EXPECT_EQ(run(bowl, Eigen::Vector3d(1, 1, 1), {}).iterations, 0);
}

TEST(MinimizeStop, AtAMinimumWithoutCurvature) {
  Quartic quartic(3);
  expectReason(quartic, Eigen::Vector3d(0, 0, 0), StopReason::kConverged);
}

TEST(MinimizeStop, WhereOnlyRoundingIsLeftAndNoToleranceWasGiven) {
  // At 0 the size of the point tells nothing of the rounding of the gradient.
  Eigen::MatrixXd a = NormalDeviates(5).matrix(3, 12);
  a.colwise() -= a.rowwise().mean().eval();
  LogSumExp centered(a, Eigen::VectorXd::Zero(12)), shifted(a, NormalDeviates(6).vector(12));
  MinimizeOptions options;
  options.gradient_tolerance = 0;
  for (const MinimizeMethod method :
       {MinimizeMethod::kAffineNormal, MinimizeMethod::kNewton, MinimizeMethod::kLbfgs}) {
    options.method = method;
    for (LogSumExp* f : {&centered, &shifted}) {
      const Minimum found = run(*f, Eigen::Vector3d(.3, -.2, .1), options);
      EXPECT_EQ(stopReasonName(found.reason), "converged") << methodName(method);
      EXPECT_LE(found.gradient_norm, 1e-14) << methodName(method);
    }
  }
}

TEST(MinimizeStop, AfterTheMostIterationsAllowed) {
  const NamedObjective f = named("rosenbrock", 4);
  MinimizeOptions options;
  options.max_iterations = 3;
  expectReason(*f.objective, f.start, StopReason::kMaxIterations, options);
  options.max_iterations = 0;
  expectReason(*f.objective, f.start, StopReason::kMaxIterations, options);
}

TEST(MinimizeStop, WhereTheValueFallsForEver) {
  Linear slope(Eigen::Vector3d(1, -2, 0.5));
  expectReason(slope, Eigen::Vector3d(1, 2, 3), StopReason::kUnboundedBelow);
  Quadratic saddle(Eigen::Vector2d(1, -1).asDiagonal(), Eigen::Vector2d(0, 0));
  expectReason(saddle, Eigen::Vector2d(1, 0.5), StopReason::kUnboundedBelow);
}

TEST(MinimizeStop, WhereTheUnknownsGoToInfinityOfAConvexFunction) {
  // -log x falls for ever, and its gradient vanishes at infinity: no minimum for all that.
  LogBarrier barrier(Eigen::Vector2d(0, 0));
  MinimizeOptions options;
  options.method = MinimizeMethod::kNewton;
  const Minimum newton = run(barrier, Eigen::Vector2d(1, 2), options);
  EXPECT_EQ(newton.reason, StopReason::kUnboundedBelow);
  options.method = MinimizeMethod::kAffineNormal;
  EXPECT_EQ(run(barrier, Eigen::Vector2d(1, 2), options).reason, StopReason::kUnboundedBelow);
  options.line_search = LineSearchKind::kExact;
  EXPECT_EQ(run(barrier, Eigen::Vector2d(1, 2), options).reason, StopReason::kUnboundedBelow);
}

TEST(MinimizeStop, AtASaddle) {
  Quadratic saddle(Eigen::Vector2d(1, -1).asDiagonal(), Eigen::Vector2d(0, 0));
  expectReason(saddle, Eigen::Vector2d(0, 0), StopReason::kSaddle);
  // From where the gradient points at the saddle.
  MinimizeOptions options;
  options.method = MinimizeMethod::kGradient;
  options.line_search = LineSearchKind::kExact;
  EXPECT_EQ(run(saddle, Eigen::Vector2d(1, 0), options).reason, StopReason::kSaddle);
}

TEST(MinimizeStop, WhereTheValueIsNotANumber) {
  for (const MinimizeMethod method : kMethods) {
    NamedObjective f = named("rosenbrock", 2);
    Wrapped broken(std::move(f.objective));
    int seen = 0;
    broken.on_move = [&](const Eigen::VectorXd&) { ++seen; };
    broken.change = [&](double value) { return seen > 5 ? std::nan("") : value; };
    MinimizeOptions options;
    options.method = method;
    const Minimum found = run(broken, f.start, options);
    EXPECT_EQ(found.reason, StopReason::kNonFiniteValue) << methodName(method);
    EXPECT_TRUE(std::isfinite(found.value));
  }
}

TEST(MinimizeStop, WhereTheHessianIsIndefiniteAndNoShiftIsAllowed) {
  Quadratic saddle(Eigen::Vector3d(1, -1, 2).asDiagonal(), Eigen::Vector3d::Zero());
  MinimizeOptions options;
  options.shift_indefinite = false;
  options.method = MinimizeMethod::kNewton;
  EXPECT_EQ(run(saddle, Eigen::Vector3d(1, 1, 1), options).reason, StopReason::kIndefiniteHessian);
  options.method = MinimizeMethod::kAffineNormal;
  EXPECT_EQ(run(saddle, Eigen::Vector3d(1, 1, 1), options).reason, StopReason::kIndefiniteHessian);
  Linear flat(Eigen::Vector2d(1, 1));
  EXPECT_EQ(run(flat, Eigen::Vector2d(0, 0), options).reason, StopReason::kIndefiniteHessian);
}

TEST(MinimizeStop, WhereGradientsContradictValues) {
  NamedObjective f = named("exp-sum", 3);
  Wrapped liar(std::move(f.objective));
  liar.gradient_scale = -1;
  expectReason(liar, f.start, StopReason::kLineSearchStuck);
}

TEST(MinimizeStop, StepsBackFromTheEdgeOfTheDomain) {
  // A Newton step from x = 5 on x - log x leads to 5 (2 - 5) < 0.
  LogBarrier barrier(Eigen::VectorXd::Ones(1));
  expectReason(barrier, Eigen::VectorXd::Constant(1, 5.0), StopReason::kConverged);
}

TEST(MinimizeStop, ShiftsHessiansThatAreIndefinite) {
  // Between its two minima (+-1, 0) the function (x^2 - 1)^2 + y^2 bends the wrong way.
  class Wells : public FormulaObjective {
   public:
    Wells() : FormulaObjective("wells", 2) {}
    Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override {
      return Eigen::Vector2d(24 * x()[0] * weights.coeff(0, 0), 0);
    }

   protected:
    double evaluate(Eigen::VectorXd& gradient) override {
      const double off = x()[0] * x()[0] - 1;
      gradient = Eigen::Vector2d(4 * x()[0] * off, 2 * x()[1]);
      return off * off + x()[1] * x()[1];
    }
    SparseMatrix secondDerivatives() const override {
      return diagonalMatrix(Eigen::Vector2d(12 * x()[0] * x()[0] - 4, 2));
    }
  } wells;
  expectReason(wells, Eigen::Vector2d(0.1, 1), StopReason::kConverged);
  for (const MinimizeMethod method : kMethods) {
    MinimizeOptions options;
    options.method = method;
    const Minimum found = run(wells, Eigen::Vector2d(0.1, 1), options);
    EXPECT_NEAR(std::abs(found.x[0]), 1, 1e-10) << methodName(method);
    EXPECT_NEAR(found.x[1], 0, 1e-10) << methodName(method);
  }
  expectReason(wells, Eigen::Vector2d(0, 0), StopReason::kSaddle);
}

TEST(Minimize, RefusesBadInputNamingIt) {
  const NamedObjective f = named("exp-sum", 3);
  const NamedObjective barrier = named("log-barrier", 2);
  Context context;
  const auto refuse = [&](Objective& objective, const Eigen::VectorXd& start,
                          const MinimizeOptions& options, const std::string& part) {
    const auto result = minimize(context, objective, start, options);
    EXPECT_THAT(result, FailsWith(Reason::kInvalidOption));
    EXPECT_NE(result.status().message().find(part), std::string::npos)
        << result.status().toString();
  };
  refuse(*f.objective, Eigen::Vector2d(1, 2), {}, "2 entries");
  refuse(*f.objective, Eigen::Vector3d(1, std::nan(""), 2), {}, "entry 1 of the start is nan");
  refuse(*f.objective, Eigen::Vector3d(1, 0, -std::numeric_limits<double>::infinity()), {},
         "entry 2 of the start is -inf");
  refuse(*f.objective, Eigen::Vector3d(1e4, 1e4, 1e4), {}, "the value inf");
  refuse(*barrier.objective, Eigen::Vector2d(-1, 1), {}, "log-barrier has the value inf");
  MinimizeOptions options;
  options.gradient_tolerance = -1;
  refuse(*f.objective, f.start, options, "gradient_tolerance");
  options = {};
  options.relative_tolerance = std::nan("");
  refuse(*f.objective, f.start, options, "relative_tolerance");
  options = {};
  options.max_iterations = -1;
  refuse(*f.objective, f.start, options, "max_iterations");
  options = {};
  options.memory = 0;
  refuse(*f.objective, f.start, options, "memory");
  for (const double tolerance : {0.0, 1.0, std::nan("")}) {
    options = {};
    options.slope_tolerance = tolerance;
    refuse(*f.objective, f.start, options, "slope_tolerance");
  }
  options = {};
  options.affine.samples = 0;
  refuse(*f.objective, f.start, options, "samples");
  options.method = MinimizeMethod::kNewton;  // Which does not care.
  EXPECT_OK(minimize(context, *f.objective, f.start, options));
}

TEST(Minimize, StopsWhenCancelledOrOutOfTime) {
  for (const MinimizeMethod method : kMethods) {
    NamedObjective f = named("rosenbrock", 6);
    Wrapped wrapped(std::move(f.objective));
    CancelToken token;
    int moves = 0;
    wrapped.on_move = [&](const Eigen::VectorXd&) {
      if (++moves == 4) token.cancel();
    };
    Context context;
    context.setCancelToken(token);
    MinimizeOptions options;
    options.method = method;
    EXPECT_THAT(minimize(context, wrapped, f.start, options), FailsWith(Reason::kCancelled));
    EXPECT_LE(moves, 5);
    Context late;
    late.setDeadline(Context::Clock::now() - std::chrono::seconds(1));
    EXPECT_THAT(minimize(late, wrapped, f.start, options), FailsWith(Reason::kDeadlineExceeded));
  }
}

TEST(Minimize, TellsHowFarItIs) {
  const NamedObjective f = named("exp-sum", 6);
  Context context;
  std::vector<double> fractions;
  context.setProgressSink([&](const Progress& progress) {
    if (progress.stage == "minimize") fractions.push_back(progress.fraction);
  });
  ASSERT_OK(minimize(context, *f.objective, f.start));
  ASSERT_GE(fractions.size(), 4U);
  EXPECT_EQ(fractions.front(), 0);
  EXPECT_EQ(fractions.back(), 1);
  for (const double fraction : fractions) {
    EXPECT_GE(fraction, 0);
    EXPECT_LE(fraction, 1);
  }
  EXPECT_TRUE(context.timing().contains("minimize"));
}

TEST(Minimize, KnowsItsNames) {
  for (const MinimizeMethod method : kMethods) {
    const auto found = methodFromName(methodName(method));
    ASSERT_OK(found);
    EXPECT_EQ(*found, method);
  }
  for (const LineSearchKind search : kSearches) {
    const auto found = lineSearchFromName(lineSearchName(search));
    ASSERT_OK(found);
    EXPECT_EQ(*found, search);
  }
  EXPECT_THAT(lineSearchFromName("armijo"), FailsWith(Reason::kInvalidOption));
  const auto unknown = methodFromName("bfgs");
  EXPECT_THAT(unknown, FailsWith(Reason::kInvalidOption));
  EXPECT_NE(unknown.status().hint().find("affine-normal, newton, lbfgs, gradient"),
            std::string::npos);
  std::set<std::string_view> names;
  for (const StopReason reason :
       {StopReason::kConverged, StopReason::kMaxIterations, StopReason::kUnboundedBelow,
        StopReason::kNonFiniteValue, StopReason::kSaddle, StopReason::kIndefiniteHessian,
        StopReason::kLineSearchStuck}) {
    EXPECT_FALSE(stopReasonName(reason).empty());
    names.insert(stopReasonName(reason));
  }
  EXPECT_EQ(names.size(), 7U);
}

}  // namespace
}  // namespace moduli
