#include "core/optimize/affine_normal.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/optimize/changed_objective.h"
#include "core/optimize/third_trace.h"
#include "tests/core/optimize/functions.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr std::array kForms{AffineForm::kInverse, AffineForm::kBordered, AffineForm::kTangent};

AffineNormalOptions by(AffineForm form, ThirdSource third = ThirdSource::kAutomatic) {
  AffineNormalOptions options;
  options.form = form;
  options.third = third;
  return options;
}

/// The direction scaled so that its product with the gradient is the gradient's length: what no
/// form and no labelling of the level sets changes.
Eigen::VectorXd unit(Objective& objective, const Eigen::VectorXd& x,
                     const AffineNormalOptions& options) {
  Context context;
  const auto normal = affineNormal(context, objective, x, options);
  EXPECT_OK(normal);
  if (!normal.ok()) return Eigen::VectorXd::Constant(x.size(), std::nan(""));
  return normal->direction * (objective.gradient().norm() / normal->decrease);
}

/// Sine of the angle between two lines.
double angle(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd u = a.normalized(), v = b.normalized();
  return (u - u.dot(v) * v).norm();
}

TEST(AffineNormal, OfAQuadraticLeadsToItsMinimizerAtAnyCondition) {
  // A backward stable solve leaves x - d off by rounding times the condition; 1e-12 * condition
  // has four digits to spare.
  for (const Eigen::Index n : {1, 2, 10, 40}) {
    for (const double condition : {1.0, 1e2, 1e4, 1e6, 1e8}) {
      const NamedObjective f = named("quadratic", n, condition);
      Context context;
      const auto normal = affineNormal(context, *f.objective, f.start);
      ASSERT_OK(normal);
      EXPECT_LE((f.start - normal->direction - *f.minimizer).norm(), 1e-12 * condition)
          << n << " unknowns, condition " << condition;
    }
  }
}

TEST(AffineNormal, OfTheQuarticPlaneCurveIsTheRationalFunctionItShouldBe) {
  // x^4 + y^4 at (1, t): d = (7 + 2 t^4, (7 t^4 + 2) / t^3) / 27.
  Quartic quartic(2);
  Context context;
  for (const double t : {0.7, 1.0, 1.9, 0.25}) {
    const auto normal = affineNormal(context, quartic, Eigen::Vector2d(1, t));
    ASSERT_OK(normal);
    const double t4 = t * t * t * t;
    const Eigen::Vector2d exact((7 + 2 * t4) / 27, (7 * t4 + 2) / (27 * t * t * t));
    EXPECT_LE((normal->direction - exact).norm(), 1e-14 * exact.norm()) << t;
  }
  const auto normal = affineNormal(context, quartic, Eigen::Vector2d(1, 0.7));
  EXPECT_NEAR(normal->direction[0], .27704444, 5e-9);
  EXPECT_NEAR(normal->direction[1], .39744088, 5e-9);
}

TEST(AffineNormal, OfTheLogarithmicBarrierIsRadial) {
  LogBarrier barrier(Eigen::VectorXd::Zero(3));
  Context context;
  const Eigen::Vector3d x(.5, 2, 1.3);
  const auto normal = affineNormal(context, barrier, x);
  ASSERT_OK(normal);
  EXPECT_LE((normal->direction + x).norm(), 1e-15 * x.norm());
  EXPECT_NEAR(normal->decrease, 3, 3e-15);  // g.d = (-1/x).(-x).
}

TEST(AffineNormal, OfTheExponentialCurveHasTwiceTheSlopeDownwards) {
  // Level curves y = e^x + const: the Hessian is singular, and the affine normal has slope -2 e^x.
  GraphOf graph([](double x, int) { return std::exp(x); });
  for (const AffineForm form : {AffineForm::kBordered, AffineForm::kTangent}) {
    for (const double x : {-2.0, 0.0, 0.6, 2.0}) {
      const Eigen::VectorXd d = unit(graph, Eigen::Vector2d(x, 0.3), by(form));
      EXPECT_NEAR(d[1] / d[0], -2 * std::exp(x), 1e-13 * 2 * std::exp(x) * 10) << x;
    }
  }
  Context context;
  EXPECT_THAT(affineNormal(context, graph, Eigen::Vector2d(0.5, 0)),
              FailsWith(Reason::kNotPositiveDefinite));
}

TEST(AffineNormal, OfPlaneCurvesIsThatOfTheirThirdOrderContact) {
  // y = phi(x): (-phi''' / (3 phi''^2), 1 - phi' phi''' / (3 phi''^2)).
  const auto sine = [](double x, int k) { return std::sin(x + k * std::acos(0.0)); };
  const auto cubic = [](double x, int k) {
    return std::array<double, 4>{x * x * x + x, 3 * x * x + 1, 6 * x, 6}[static_cast<size_t>(k)];
  };
  const std::vector<std::function<double(double, int)>> curves{sine, cubic};
  for (const auto& phi : curves) {
    GraphOf graph(phi);
    for (const double x : {0.4, 1.1, 1.7}) {
      const double p2 = phi(x, 2), p3 = phi(x, 3);
      const Eigen::Vector2d exact(-p3 / (3 * p2 * p2), 1 - phi(x, 1) * p3 / (3 * p2 * p2));
      for (const AffineForm form : {AffineForm::kBordered, AffineForm::kTangent}) {
        EXPECT_LE(angle(unit(graph, Eigen::Vector2d(x, -0.2), by(form)), exact), 1e-13) << x;
      }
    }
  }
}

TEST(AffineNormal, OfConicsLeadsThroughTheCentreOrAlongTheAxis) {
  const Eigen::Vector2d center(0.3, -1.2);
  const Eigen::Matrix2d ellipse{{2, .5}, {.5, 1}}, hyperbola{{2, 1.5}, {1.5, -1}};
  for (const Eigen::Matrix2d& A : {ellipse, hyperbola}) {
    Quadratic conic(A, center);
    for (const Eigen::Vector2d& x : {Eigen::Vector2d(2, 1), Eigen::Vector2d(-1, 0.5)}) {
      for (const AffineForm form : {AffineForm::kBordered, AffineForm::kTangent}) {
        EXPECT_LE(angle(unit(conic, x, by(form)), x - center), 1e-12);
      }
    }
  }
  GraphOf parabola([](double x, int k) {
    return k == 0 ? x * x : k == 1 ? 2 * x : k == 2 ? 2 : 0;
  });
  for (const double x : {-3.0, 0.0, 1.5}) {
    const Eigen::VectorXd d = unit(parabola, Eigen::Vector2d(x, 0), by(AffineForm::kBordered));
    EXPECT_LE(angle(d, Eigen::Vector2d(0, 1)), 1e-12);
  }
}

TEST(AffineNormal, OfAFunctionOfTheFunctionIsTheSame) {
  using Kind = MonotoneTransform::Kind;
  for (const Kind kind : {Kind::kExponential, Kind::kSquareRoot, Kind::kLogarithm}) {
    for (const Eigen::Index n : {2, 3, 6}) {
      NamedObjective f = named("exp-sum", n);
      const Eigen::VectorXd at = unit(*f.objective, f.start, by(AffineForm::kInverse));
      MonotoneTransform changed(std::move(f.objective), kind, 0.1);
      // Roots and logarithms bend the value so that the Hessian itself may be indefinite.
      const Eigen::VectorXd there = unit(changed, f.start, by(AffineForm::kBordered));
      EXPECT_LE((there - at).norm(), 1e-14 * at.norm() * static_cast<double>(10 * n)) << n;
      if (kind != Kind::kExponential) continue;
      const Eigen::VectorXd inverse = unit(changed, f.start, by(AffineForm::kInverse));
      EXPECT_LE((inverse - at).norm(), 1e-14 * at.norm() * static_cast<double>(10 * n)) << n;
    }
  }
}

TEST(AffineNormal, IsCarriedAlongByAffineMaps) {
  for (const std::string name : {"exp-sum", "log-sum-exp", "rosenbrock", "log-barrier"}) {
    for (const Eigen::Index n : {2, 3, 7}) {
      NamedObjective f = named(name, n);
      const Eigen::VectorXd x = f.start;
      const bool convex = name != "rosenbrock";
      const AffineForm form = convex ? AffineForm::kInverse : AffineForm::kBordered;
      const Eigen::VectorXd d = unit(*f.objective, x, by(form));
      const Eigen::MatrixXd B = randomMap(n, 7);
      AffineChange changed(std::move(f.objective), B, NormalDeviates(3).vector(n));
      const Eigen::VectorXd image = B * unit(changed, changed.backward(x), by(form));
      EXPECT_LE(angle(image, d), 1e-12) << name << n;
    }
  }
}

TEST(AffineNormal, IsTheSameByEveryFormAndEverySourceOfThirdDerivatives) {
  // Fourth-order differences of step 1e-3: 1e-12 of the fifth derivative, and as much of rounding.
  for (const std::string name : {"exp-sum", "log-sum-exp", "log-barrier", "quartic"}) {
    for (const Eigen::Index n : {2, 3, 5, 8}) {
      const NamedObjective f = named(name, n);
      const Eigen::VectorXd x = f.start;
      const Eigen::VectorXd d =
          unit(*f.objective, x, by(AffineForm::kInverse, ThirdSource::kAnalytic));
      for (const AffineForm form : kForms) {
        const double analytic =
            (unit(*f.objective, x, by(form, ThirdSource::kAnalytic)) - d).norm() / d.norm();
        const double log_det =
            (unit(*f.objective, x, by(form, ThirdSource::kLogDeterminant)) - d).norm() / d.norm();
        const double columns =
            (unit(*f.objective, x, by(form, ThirdSource::kEigenColumns)) - d).norm() / d.norm();
        EXPECT_LE(analytic, 1e-12) << name << n;
        EXPECT_LE(log_det, 1e-9) << name << n;
        EXPECT_LE(columns, 1e-5) << name << n;
      }
    }
  }
}

TEST(AffineNormal, DecreasesAsNewtonDoesWhateverTheThirdDerivativesAre) {
  for (const Eigen::Index n : {2, 5, 30}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      NamedObjective f = named("exp-sum", n, 1, seed);
      Context context;
      ASSERT_OK(f.objective->moveTo(context, f.start));
      const Eigen::VectorXd g = f.objective->gradient();
      const double q = g.dot(denseOf(f.objective->hessian()).fullPivLu().solve(g));
      Wrapped made_up(std::move(f.objective));
      made_up.random_third = seed;
      const auto normal = affineNormal(context, made_up, f.start);
      ASSERT_OK(normal);
      EXPECT_NEAR(g.dot(normal->direction), q, 1e-13 * q);
      EXPECT_NEAR(normal->decrease, q, 1e-13 * q);
    }
  }
}

TEST(AffineNormal, OfGradientsAloneWithAllEigenColumnsIsExact) {
  for (const Eigen::Index n : {2, 6}) {
    NamedObjective f = named("exp-sum", n);
    Context context;
    const auto exact = affineNormal(context, *f.objective, f.start);
    Wrapped gradients(std::move(f.objective));
    gradients.third = false;  // The automatic choice then is eigen-columns.
    const auto normal = affineNormal(context, gradients, f.start);
    ASSERT_OK(exact);
    ASSERT_OK(normal);
    EXPECT_LE((normal->tau - exact->tau).norm(), 1e-6 * exact->tau.norm()) << n;
  }
}

TEST(AffineNormal, OfGradientsAloneConvergesWithTheSquareOfTheStep) {
  const NamedObjective f = named("exp-sum", 20);
  const Eigen::VectorXd x = 0.3 * f.start;
  Context context;
  const auto exact = affineNormal(context, *f.objective, x);
  ASSERT_OK(exact);
  const auto error = [&](double step) {
    AffineNormalOptions options = by(AffineForm::kInverse, ThirdSource::kEigenColumns);
    options.difference_step = step;
    return (affineNormal(context, *f.objective, x, options)->tau - exact->tau).norm();
  };
  // The next term is of fourth order; rounding leaves 1e-16 |g| / step^2.
  EXPECT_NEAR(error(0.1) / error(0.05), 4, 0.05);
  EXPECT_NEAR(error(0.05) / error(0.025), 4, 0.05);
}

/// The variance of one sample: twice the sum over c of tr (P T_c)^2. And the exact tau.
struct Spread {
  Eigen::VectorXd tau;
  double variance = 0;
};

Spread spreadOf(Objective& objective, const Eigen::MatrixXd& P) {
  const Eigen::Index n = P.rows();
  const SparseMatrix pattern = objective.hessian();
  std::vector<Eigen::MatrixXd> T(static_cast<std::size_t>(n), Eigen::MatrixXd::Zero(n, n));
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b <= a; ++b) {
      Eigen::MatrixXd unit_matrix = Eigen::MatrixXd::Zero(n, n);
      unit_matrix(a, b) += 0.5;
      unit_matrix(b, a) += 0.5;
      const Eigen::VectorXd column = objective.thirdContraction(onPattern(unit_matrix, pattern));
      for (Eigen::Index c = 0; c < n; ++c) {
        T[static_cast<std::size_t>(c)](a, b) = T[static_cast<std::size_t>(c)](b, a) = column[c];
      }
    }
  }
  Spread spread{Eigen::VectorXd::Zero(n), 0};
  for (Eigen::Index c = 0; c < n; ++c) {
    const Eigen::MatrixXd PT = P * T[static_cast<std::size_t>(c)];
    spread.tau[c] = PT.trace();
    spread.variance += 2 * (PT * PT).trace();
  }
  return spread;
}

TEST(AffineNormal, BySamplesErrsAsTheirVarianceTells) {
  // The variance of T(w, w, c), w normal of covariance P, is 2 tr (P T_c)^2. Over 40 seeds the mean
  // square error is that by the number of samples, up to 3 sqrt(2 / 40) = 0.67 of itself if one
  // direction has all of the error.
  NamedObjective f = named("exp-sum", 6);
  Context context;
  ASSERT_OK(f.objective->moveTo(context, 0.3 * f.start));
  const auto tangent =
      tangentInverseBordered(denseOf(f.objective->hessian()), f.objective->gradient());
  ASSERT_OK(tangent);
  const Spread spread = spreadOf(*f.objective, tangent->P);
  for (const AffineForm form : {AffineForm::kInverse, AffineForm::kBordered}) {
    AffineNormalOptions options = by(form, ThirdSource::kGaussian);
    options.samples = 400;
    double mean_square = 0;
    for (options.seed = 1; options.seed <= 40; ++options.seed) {
      const auto normal = affineNormal(context, *f.objective, 0.3 * f.start, options);
      ASSERT_OK(normal);
      mean_square += (normal->tau - spread.tau).squaredNorm() / 40;
    }
    EXPECT_NEAR(mean_square * options.samples / spread.variance, 1, 0.67);
  }
  AffineNormalOptions many = by(AffineForm::kInverse, ThirdSource::kGaussian);
  many.samples = 4000;
  const auto normal = affineNormal(context, *f.objective, 0.3 * f.start, many);
  const double error = (normal->tau - spread.tau).norm();
  EXPECT_LE(error, 3 * std::sqrt(spread.variance / 4000));
  std::printf("4000 samples: relative error %.3g of tau, one sigma is %.3g\n",
              error / spread.tau.norm(), std::sqrt(spread.variance / 4000) / spread.tau.norm());
}

TEST(AffineNormal, BySamplesIsTheSameForTheSameSeed) {
  const NamedObjective f = named("log-sum-exp", 5);
  Context context;
  AffineNormalOptions options = by(AffineForm::kInverse, ThirdSource::kGaussian);
  const auto first = affineNormal(context, *f.objective, f.start, options);
  const auto again = affineNormal(context, *f.objective, f.start, options);
  options.seed = 2;
  const auto other = affineNormal(context, *f.objective, f.start, options);
  ASSERT_OK(first);
  EXPECT_EQ(first->direction, again->direction);
  EXPECT_NE(first->direction, other->direction);
}

TEST(AffineNormal, ModuloConstantsIsThatOfTheFunctionWithOneUnknownFixed) {
  const Eigen::VectorXd b = NormalDeviates(4).vector(7);
  const Eigen::VectorXd x = NormalDeviates(5).vector(7);
  Ring ring(b, false), pinned(b, true);
  const Eigen::VectorXd slice = x.head(6).array() - x[6];
  Context context;
  const auto reference = affineNormal(context, pinned, slice);
  ASSERT_OK(reference);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(7);
  expected.head(6) = reference->direction;
  expected.array() -= expected.mean();
  for (const AffineForm form : kForms) {
    for (const ThirdSource third :
         {ThirdSource::kAnalytic, ThirdSource::kEigenColumns, ThirdSource::kLogDeterminant}) {
      const auto normal = affineNormal(context, ring, x, by(form, third));
      ASSERT_OK(normal);
      const Eigen::VectorXd scaled = normal->direction * (reference->decrease / normal->decrease);
      const double tolerance = third == ThirdSource::kAnalytic         ? 1e-11
                               : third == ThirdSource::kLogDeterminant ? 1e-8
                                                                       : 1e-5;
      EXPECT_LE((scaled - expected).norm(), tolerance * expected.norm());
      EXPECT_NEAR(normal->direction.sum(), 0, 1e-14);
    }
  }
  // The length by the inverse is the natural one, too.
  const auto natural = affineNormal(context, ring, x);
  EXPECT_NEAR(natural->decrease, reference->decrease, 1e-12 * reference->decrease);
}

TEST(AffineNormal, OfOneUnknownIsTheNewtonStep) {
  const NamedObjective f = named("exp-sum", 1);
  Context context;
  const auto normal = affineNormal(context, *f.objective, f.start);
  ASSERT_OK(normal);
  const double newton = f.objective->gradient()[0] / f.objective->hessian().coeff(0, 0);
  EXPECT_NEAR(normal->direction[0], newton, 1e-15 * std::abs(newton));
}

TEST(AffineNormal, LeavesTheObjectiveWhereItWasAsked) {
  const NamedObjective f = named("exp-sum", 4);
  Context context;
  ASSERT_OK(f.objective->moveTo(context, f.start));
  const double value = f.objective->value();
  for (const ThirdSource third : {ThirdSource::kAnalytic, ThirdSource::kLogDeterminant,
                                  ThirdSource::kEigenColumns, ThirdSource::kGaussian}) {
    for (const AffineForm form : kForms) {
      ASSERT_OK(affineNormal(context, *f.objective, f.start, by(form, third)));
      EXPECT_EQ(f.objective->value(), value);
    }
  }
}

TEST(AffineNormal, DifferencesStayInsideTheDomain) {
  // The eigen-columns of P at (x, 1) are of length x and 1: a step of 3 of them leaves x > 0.
  LogBarrier barrier(Eigen::Vector2d(1, 1));
  AffineNormalOptions options = by(AffineForm::kInverse, ThirdSource::kEigenColumns);
  options.difference_step = 3;
  Context context;
  EXPECT_OK(affineNormal(context, barrier, Eigen::Vector2d(1e-3, 2), options));
}

TEST(AffineNormal, RefusesWhatHasNone) {
  Quadratic bowl(Eigen::Matrix2d::Identity(), Eigen::Vector2d(1, 2));
  LogBarrier barrier(Eigen::Vector2d(1, 1));
  Linear flat(Eigen::Vector3d(1, 2, 3));
  Context context;
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const AffineForm form : kForms) {
    const AffineNormalOptions options = by(form);
    const auto refuse = [&](Objective& objective, const Eigen::VectorXd& x, Reason reason) {
      EXPECT_THAT(affineNormal(context, objective, x, options), FailsWith(reason));
    };
    refuse(bowl, Eigen::Vector3d(1, 2, 3), Reason::kInvalidOption);
    refuse(bowl, Eigen::Vector2d(1, nan), Reason::kInvalidOption);
    refuse(bowl, Eigen::Vector2d(infinity, 1), Reason::kInvalidOption);
    refuse(bowl, Eigen::Vector2d(1, 2), Reason::kInvalidOption);      // The minimizer.
    refuse(barrier, Eigen::Vector2d(-1, 2), Reason::kInvalidOption);  // Outside its domain.
    refuse(flat, Eigen::Vector3d(0, 0, 0), Reason::kNotPositiveDefinite);
  }
  const auto message = affineNormal(context, bowl, Eigen::Vector2d(1, nan)).status().message();
  EXPECT_EQ(message, "entry 1 of the point is nan");
}

TEST(AffineNormal, RefusesOptionsThatMakeNoSense) {
  const NamedObjective f = named("exp-sum", 3);
  Context context;
  AffineNormalOptions options;
  options.samples = 0;
  EXPECT_THAT(affineNormal(context, *f.objective, f.start, options),
              FailsWith(Reason::kInvalidOption));
  for (const double step : {0.0, -1.0, std::nan("")}) {
    options = {};
    options.difference_step = step;
    EXPECT_THAT(affineNormal(context, *f.objective, f.start, options),
                FailsWith(Reason::kInvalidOption));
  }
  NamedObjective g = named("exp-sum", 3);
  Wrapped gradients(std::move(g.objective));
  gradients.third = false;
  EXPECT_THAT(
      affineNormal(context, gradients, g.start, by(AffineForm::kInverse, ThirdSource::kAnalytic)),
      FailsWith(Reason::kInvalidOption));
  // No normal distribution has the P of a saddle-shaped level set for its covariance.
  Quadratic saddle(Eigen::Vector3d(1, -1, 2).asDiagonal(), Eigen::Vector3d::Zero());
  EXPECT_THAT(affineNormal(context, saddle, Eigen::Vector3d(1, .2, .3),
                           by(AffineForm::kBordered, ThirdSource::kGaussian)),
              FailsWith(Reason::kNotPositiveDefinite));
}

TEST(AffineNormal, StopsWhenCancelled) {
  NamedObjective f = named("exp-sum", 12);
  Wrapped wrapped(std::move(f.objective));
  CancelToken token;
  Context context;
  context.setCancelToken(token);
  int moves = 0;
  wrapped.on_move = [&](const Eigen::VectorXd&) {
    if (++moves == 5) token.cancel();
  };
  EXPECT_THAT(
      affineNormal(context, wrapped, f.start, by(AffineForm::kInverse, ThirdSource::kEigenColumns)),
      FailsWith(Reason::kCancelled));
  EXPECT_LE(moves, 6);
}

}  // namespace
}  // namespace moduli
