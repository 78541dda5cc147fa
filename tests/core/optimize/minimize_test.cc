#include "core/optimize/minimize.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/optimize/changed_objective.h"
#include "tests/core/optimize/functions.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr std::array kMethods{MinimizeMethod::kAffineNormal, MinimizeMethod::kNewton,
                              MinimizeMethod::kLbfgs, MinimizeMethod::kGradient};
constexpr std::array kSecondOrder{MinimizeMethod::kAffineNormal, MinimizeMethod::kNewton};
constexpr std::array kSearches{LineSearchKind::kBacktracking, LineSearchKind::kExact};

MinimizeOptions by(MinimizeMethod method, LineSearchKind search = LineSearchKind::kBacktracking) {
  MinimizeOptions options;
  options.method = method;
  options.line_search = search;
  options.keep_path = true;
  return options;
}

Minimum run(Objective& objective, const Eigen::VectorXd& start, const MinimizeOptions& options) {
  Context context;
  auto result = minimize(context, objective, start, options);
  EXPECT_OK(result);
  return result.ok() ? *std::move(result) : Minimum();
}

std::string label(MinimizeMethod method, LineSearchKind search) {
  return std::string(methodName(method)) + ", " + std::string(lineSearchName(search));
}

/// The largest distance between points of two paths, from the same row, over the rows of both.
double apart(const std::vector<Eigen::VectorXd>& a, const std::vector<Eigen::VectorXd>& b) {
  double largest = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    largest = std::max(largest, (a[k] - b[k]).norm());
  }
  return largest;
}

TEST(Minimize, OfAQuadraticTakesOneStepAtAnyCondition) {
  for (const MinimizeMethod method : kSecondOrder) {
    for (const LineSearchKind search : kSearches) {
      for (const Eigen::Index n : {1, 2, 10, 50}) {
        for (const double condition : {1.0, 1e2, 1e4, 1e6, 1e8}) {
          const NamedObjective f = named("quadratic", n, condition);
          const Minimum found = run(*f.objective, f.start, by(method, search));
          EXPECT_TRUE(found.converged);
          EXPECT_EQ(found.iterations, 1) << label(method, search) << n << ", " << condition;
          EXPECT_LE((found.x - *f.minimizer).norm(), 1e-12 * condition);
        }
      }
    }
  }
}

TEST(Minimize, OfRosenbrocksValleyArrivesAtItsEnd) {
  for (const MinimizeMethod method :
       {MinimizeMethod::kAffineNormal, MinimizeMethod::kNewton, MinimizeMethod::kLbfgs}) {
    for (const LineSearchKind search : kSearches) {
      const NamedObjective f = named("rosenbrock", 2);
      const Minimum found = run(*f.objective, Eigen::Vector2d(-1.2, 1), by(method, search));
      EXPECT_TRUE(found.converged) << label(method, search);
      // The least eigenvalue there is 0.4: |x - 1| <= 1e-10 / 0.4.
      EXPECT_LE((found.x - Eigen::Vector2d(1, 1)).norm(), 2.5e-10) << label(method, search);
      std::printf("rosenbrock, %s: %d iterations, %d evaluations\n", label(method, search).c_str(),
                  found.iterations, found.evaluations);
    }
  }
  const NamedObjective f = named("rosenbrock", 2);
  MinimizeOptions slow = by(MinimizeMethod::kGradient);
  slow.max_iterations = 100000;
  slow.gradient_tolerance = 1e-6;
  const Minimum found = run(*f.objective, Eigen::Vector2d(-1.2, 1), slow);
  EXPECT_TRUE(found.converged);
  EXPECT_LE((found.x - Eigen::Vector2d(1, 1)).norm(), 2.5e-6);
}

TEST(Minimize, OfAChainOfRosenbrocksArrivesFromNearby) {
  for (const MinimizeMethod method : kMethods) {
    if (method == MinimizeMethod::kGradient) continue;
    for (const LineSearchKind search : kSearches) {
      const NamedObjective f = named("rosenbrock", 8);
      const Minimum found =
          run(*f.objective, Eigen::VectorXd::Constant(8, 0.5), by(method, search));
      EXPECT_TRUE(found.converged) << label(method, search);
      EXPECT_LE((found.x - Eigen::VectorXd::Ones(8)).norm(), 1e-9) << label(method, search);
    }
  }
}

TEST(Minimize, ByAllMethodsFindsTheSameMinimum) {
  for (const std::string name : {"exp-sum", "log-sum-exp", "log-barrier"}) {
    const NamedObjective f = named(name, 6);
    MinimizeOptions options = by(MinimizeMethod::kNewton);
    options.gradient_tolerance = 1e-13;
    const Eigen::VectorXd reference = run(*f.objective, f.start, options).x;
    const double stiffness =
        denseOf(f.objective->hessian()).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff();
    for (const MinimizeMethod method : kMethods) {
      for (const LineSearchKind search : kSearches) {
        MinimizeOptions other = by(method, search);
        other.max_iterations = 20000;
        const Minimum found = run(*f.objective, f.start, other);
        EXPECT_TRUE(found.converged) << name << ", " << label(method, search);
        EXPECT_LE(found.gradient_norm, 1e-10) << name << ", " << label(method, search);
        EXPECT_LE((found.x - reference).norm(), 1.1e-10 / stiffness)
            << name << ", " << label(method, search);
      }
    }
  }
}

TEST(Minimize, ConvergesQuadraticallyNearAMinimum) {
  for (const MinimizeMethod method : kSecondOrder) {
    for (const std::string name : {"exp-sum", "log-sum-exp", "log-barrier"}) {
      const NamedObjective f = named(name, 5);
      MinimizeOptions options = by(method);
      options.gradient_tolerance = 1e-13;
      const Eigen::VectorXd near = run(*f.objective, f.start, options).x;
      const Eigen::VectorXd away = NormalDeviates(9).vector(5).normalized();
      const Minimum found = run(*f.objective, near + 0.02 * away, options);
      // |e'| <= C e^2 with C = |T| / |H| times a condition of at most 10 and |T| / |H| < 10 here;
      // the points themselves are known to some 1e-13.
      int pairs = 0;
      for (std::size_t k = 0; k + 1 < found.path.size(); ++k) {
        const double before = (found.path[k] - near).norm();
        const double after = (found.path[k + 1] - near).norm();
        EXPECT_LE(after, std::max(100 * before * before, 1e-12)) << name << k;
        EXPECT_EQ(found.trace[k + 1].step, 1) << "a full step, " << name << k;
        if (after > 1e-12) ++pairs;
      }
      EXPECT_GE(pairs, 2) << name;
    }
  }
}

TEST(Minimize, TakesPointsToPointsUnderAffineMaps) {
  for (const MinimizeMethod method : kSecondOrder) {
    for (const LineSearchKind search : kSearches) {
      for (const std::string name : {"exp-sum", "log-sum-exp", "log-barrier"}) {
        NamedObjective f = named(name, 4);
        const Eigen::VectorXd start = f.start;
        MinimizeOptions options = by(method, search);
        options.slope_tolerance = 1e-10;
        const Minimum plain = run(*f.objective, start, options);
        AffineChange changed(std::move(f.objective), randomMap(4, 8), NormalDeviates(2).vector(4));
        const Minimum image = run(changed, changed.backward(start), options);
        std::vector<Eigen::VectorXd> back;
        for (const Eigen::VectorXd& x : image.path) back.push_back(changed.forward(x));
        // Rounding, times the condition of B (below 100) at each step.
        EXPECT_LE(apart(plain.path, back), 1e-10) << name << ", " << label(method, search);
        EXPECT_NEAR(plain.iterations, image.iterations, 1) << name << ", " << label(method, search);
      }
    }
  }
}

TEST(Minimize, ByGradientsIsNotBlindToAffineMapsButToRotations) {
  const Eigen::MatrixXd rotation = NormalDeviates(6).matrix(4, 4).householderQr().householderQ();
  for (const MinimizeMethod method : {MinimizeMethod::kLbfgs, MinimizeMethod::kGradient}) {
    NamedObjective f = named("exp-sum", 4), g = named("exp-sum", 4);
    MinimizeOptions options = by(method);
    options.max_iterations = 12;
    const Minimum plain = run(*f.objective, f.start, options);
    AffineChange turned(std::move(f.objective), rotation, Eigen::VectorXd::Zero(4));
    AffineChange sheared(std::move(g.objective), randomMap(4, 8), Eigen::VectorXd::Zero(4));
    const Minimum image = run(turned, turned.backward(f.start), options);
    const Minimum other = run(sheared, sheared.backward(f.start), options);
    std::vector<Eigen::VectorXd> back, unlike;
    for (const Eigen::VectorXd& x : image.path) back.push_back(turned.forward(x));
    for (const Eigen::VectorXd& x : other.path) unlike.push_back(sheared.forward(x));
    EXPECT_LE(apart(plain.path, back), 1e-9) << methodName(method);
    EXPECT_GE(apart(plain.path, unlike), 1e-2) << methodName(method);
  }
}

TEST(Minimize, AlongAffineNormalsIsBlindToTheLabelsOfLevelSetsAndNewtonIsNot) {
  // By exact searches, to 1e-12 of the slope; the maps of one step to the next stretch by less than
  // a thousand here. (phi' H + phi'' g g^T)^{-1} g is parallel to H^{-1} g, so that Newton goes
  // along the same lines while that matrix is positive definite. That of log (1 + f) is not for
  // q > 1 + f: the barrier c.x - sum log x at x = (9, 5, 3) has q = 13 and f = 4.4.
  using Kind = MonotoneTransform::Kind;
  struct Case {
    std::string name;
    Kind kind;
    bool definite;
  };
  for (const Case& c :
       {Case{"exp-sum", Kind::kExponential, true}, Case{"exp-sum", Kind::kSquareRoot, true},
        Case{"exp-sum", Kind::kLogarithm, true}, Case{"log-barrier", Kind::kLogarithm, false}}) {
    for (const MinimizeMethod method : kSecondOrder) {
      NamedObjective f = named(c.name, 3);
      const Eigen::VectorXd start =
          c.definite ? f.start : Eigen::VectorXd(Eigen::Vector3d(9, 5, 3));
      MinimizeOptions options = by(method, LineSearchKind::kExact);
      options.slope_tolerance = 1e-12;
      options.max_iterations = 4;
      const Minimum plain = run(*f.objective, start, options);
      MonotoneTransform changed(std::move(f.objective), c.kind, 1);
      const Minimum image = run(changed, start, options);
      const double distance = apart(plain.path, image.path);
      if (c.definite || method == MinimizeMethod::kAffineNormal) {
        EXPECT_LE(distance, 1e-7) << changed.name() << ", " << methodName(method);
      } else {
        EXPECT_GE(distance, 1e-2) << changed.name() << ", " << methodName(method);
      }
    }
  }
}

TEST(Minimize, ByNewtonsMethodTakesLongerWhereValuesAreExponentiated) {
  // The same line, but steps shrink where values are exponentiated: without exact searches that
  // costs iterations.
  NamedObjective f = named("exp-sum", 3);
  MinimizeOptions options = by(MinimizeMethod::kNewton);
  const int plain = run(*f.objective, f.start, options).iterations;
  MonotoneTransform changed(std::move(f.objective), MonotoneTransform::Kind::kExponential, 1);
  const int image = run(changed, f.start, options).iterations;
  EXPECT_GT(image, plain + 3);
}

TEST(Minimize, ReachesSmallGradientsWhereValuesAreRounded) {
  // A constant of 1e6 rounds values to 1e-10: gains below are judged by slopes.
  for (const MinimizeMethod method : kMethods) {
    for (const LineSearchKind search : kSearches) {
      NamedObjective f = named("exp-sum", 5);
      Wrapped lifted(std::move(f.objective));
      lifted.change = [](double value) { return value + 1e6; };
      MinimizeOptions options = by(method, search);
      const Minimum found = run(lifted, f.start, options);
      EXPECT_TRUE(found.converged) << label(method, search);
      EXPECT_LE(found.gradient_norm, 1e-10) << label(method, search);
    }
  }
}

TEST(Minimize, ReachesTwelveDigitsOfTheFirstGradient) {
  for (const MinimizeMethod method :
       {MinimizeMethod::kAffineNormal, MinimizeMethod::kNewton, MinimizeMethod::kLbfgs}) {
    for (const std::string name : {"exp-sum", "log-sum-exp", "rosenbrock", "quadratic"}) {
      const NamedObjective f = named(name, 4);
      MinimizeOptions options = by(method);
      options.gradient_tolerance = 0;
      options.relative_tolerance = 1e-12;
      const Minimum found = run(*f.objective, f.start, options);
      EXPECT_TRUE(found.converged) << name << ", " << methodName(method);
      EXPECT_LE(found.gradient_norm, 1e-12 * found.trace.front().gradient_norm) << name;
    }
  }
}

TEST(Minimize, WithoutThirdDerivativesFollowsTheSamePath) {
  NamedObjective f = named("exp-sum", 4);
  const MinimizeOptions options = by(MinimizeMethod::kAffineNormal);
  const Minimum exact = run(*f.objective, f.start, options);
  Wrapped gradients(std::move(f.objective));
  gradients.third = false;
  const Minimum differences = run(gradients, f.start, options);
  EXPECT_TRUE(differences.converged);
  EXPECT_LE(apart(exact.path, differences.path), 1e-5);
  EXPECT_GT(differences.evaluations, exact.evaluations + 2 * 3 * exact.iterations);
}

TEST(Minimize, BySamplesConvergesAndIsReproducible) {
  const NamedObjective f = named("exp-sum", 8);
  MinimizeOptions options = by(MinimizeMethod::kAffineNormal);
  options.affine.third = ThirdSource::kGaussian;
  options.affine.samples = 16;
  const Minimum first = run(*f.objective, f.start, options);
  const Minimum again = run(*f.objective, f.start, options);
  options.affine.seed = 77;
  const Minimum other = run(*f.objective, f.start, options);
  EXPECT_TRUE(first.converged);
  EXPECT_TRUE(other.converged);
  EXPECT_EQ(first.path, again.path);
  EXPECT_GT(apart(first.path, other.path), 1e-6);
}

TEST(Minimize, ModuloConstantsFindsTheMinimumOfEveryRing) {
  // exp(x_i - x_{i+1}) + b_i (x_i - x_{i+1}) with b constant: least where all x are equal.
  Ring ring(Eigen::VectorXd::Constant(6, -0.7), false);
  const Eigen::VectorXd start = NormalDeviates(3).vector(6);
  for (const MinimizeMethod method : kMethods) {
    const Minimum found = run(ring, start, by(method));
    EXPECT_TRUE(found.converged) << methodName(method);
    EXPECT_NEAR(found.value, 6, 1e-14);
    EXPECT_LE((found.x.array() - found.x.mean()).abs().maxCoeff(), 1e-9) << methodName(method);
    EXPECT_NEAR(found.x.mean(), start.mean(), 1e-13) << methodName(method);
  }
}

TEST(Minimize, KeepsATraceThatAddsUp) {
  for (const MinimizeMethod method : kMethods) {
    const NamedObjective f = named("log-sum-exp", 5);
    const Minimum found = run(*f.objective, f.start, by(method));
    ASSERT_EQ(found.trace.size(), static_cast<std::size_t>(found.iterations) + 1);
    ASSERT_EQ(found.path.size(), found.trace.size());
    EXPECT_EQ(found.path.front(), f.start);
    EXPECT_EQ(found.path.back(), found.x);
    EXPECT_EQ(found.trace.back().value, found.value);
    EXPECT_EQ(found.trace.back().gradient_norm, found.gradient_norm);
    EXPECT_EQ(found.trace.front().evaluations, 1);
    EXPECT_EQ(found.trace.front().factorizations, 0);
    for (std::size_t k = 1; k < found.trace.size(); ++k) {
      const MinimizeStep &before = found.trace[k - 1], &row = found.trace[k];
      EXPECT_EQ(row.iteration, static_cast<int>(k));
      EXPECT_GT(row.evaluations, before.evaluations);
      EXPECT_GE(row.factorizations, before.factorizations);
      EXPECT_GT(row.step, 0);
      EXPECT_GT(row.decrease, 0);
      EXPECT_LE(row.value, before.value + 1e-10 * std::abs(before.value));
    }
    EXPECT_GE(found.evaluations, found.trace.back().evaluations);
    const int judged = found.factorizations - found.trace.back().factorizations;
    EXPECT_EQ(judged, 1) << methodName(method);
    // The objective is left at the result.
    EXPECT_EQ(f.objective->value(), found.value);
    EXPECT_EQ(f.objective->gradient().norm(), found.gradient_norm);
  }
}

TEST(Minimize, GivesTheSameBytesAgain) {
  for (const MinimizeMethod method : kMethods) {
    const NamedObjective f = named("exp-sum", 7);
    const Minimum a = run(*f.objective, f.start, by(method));
    const Minimum b = run(*f.objective, f.start, by(method));
    EXPECT_EQ(a.path, b.path) << methodName(method);
  }
}

TEST(Minimize, OfPermutedUnknownsIsPermuted) {
  // A permutation is an affine map that all methods are blind to, but for the order of sums.
  for (const MinimizeMethod method : kMethods) {
    NamedObjective f = named("log-sum-exp", 4);
    const Minimum plain = run(*f.objective, f.start, by(method));
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(4, 4);
    for (int i = 0; i < 4; ++i) P(i, (i + 1) % 4) = 1;
    AffineChange permuted(std::move(f.objective), P, Eigen::VectorXd::Zero(4));
    const Minimum image = run(permuted, permuted.backward(f.start), by(method));
    EXPECT_LE((permuted.forward(image.x) - plain.x).norm(), 1e-9) << methodName(method);
  }
}

}  // namespace
}  // namespace moduli
