#include "core/ricci/flow.h"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/ricci/circle_packing.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr FlowSteps kBoth[] = {FlowSteps::kExplicit, FlowSteps::kSemiImplicit};

FlowOptions followed(FlowSteps steps, double tolerance) {
  FlowOptions options;
  options.steps = steps;
  options.tolerance = tolerance;
  return options;
}

CirclePackingModel makeModel(MetricSurface metric, Geometry geometry, Scheme scheme) {
  if (geometry == Geometry::kHyperbolic) {
    for (double& length : metric.lengths) length = lengthOfHalfChord(geometry, length);
  }
  auto model = CirclePackingModel::make(metric.surface, geometry, scheme, metric.lengths);
  EXPECT_OK(model);
  return *std::move(model);
}

Eigen::VectorXd shaken(const Eigen::VectorXd& u, double far, unsigned seed) {
  std::mt19937 random(seed);
  return u.unaryExpr([&](double x) { return x + far * (2 * uniform(random) - 1); });
}

Eigen::VectorXd zero(const CurvatureModel& model) {
  return Eigen::VectorXd::Zero(model.size());
}

/// Half chords times e^{(s_i + s_j) / 2} for random s up to `far`: another metric, with circles
/// that neither all touch nor are all of one size.
MetricSurface irregular(MetricSurface metric, double far, unsigned seed) {
  const Connectivity& surface = metric.surface;
  const Eigen::VectorXd s = shaken(Eigen::VectorXd::Zero(surface.vertexCount()), far, seed);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    metric.lengths[e] *= std::exp((s[surface.tail(h)] + s[surface.head(h)]) / 2);
  }
  return metric;
}

TEST(RicciFlow, FindsTheHyperbolicMetricOfRegularMaps) {
  // CHECKS F7 and F8: all circles have one radius, and every edge cosh(l / 2) = 1 / (2 sin(pi /
  // d)). The residual of 1e-13 over the smallest eigenvalue, above 0.3, is the error of u.
  struct Case {
    MetricSurface surface;
    int degree;
  };
  for (const Case& map : {Case{octahedronCover(), 8}, Case{kleinQuartic(), 7}}) {
    CirclePackingModel model = makeModel(map.surface, Geometry::kHyperbolic, Scheme::kTangential);
    const double length = 2 * std::acosh(1 / (2 * std::sin(kPi / map.degree)));
    for (const FlowSteps steps : kBoth) {
      Context context;
      const auto flow = ricciFlow(context, model, zero(model), shaken(model.initial(), 0.5, 1),
                                  followed(steps, 1e-13));
      ASSERT_OK(flow);
      for (const double u : flow->u) EXPECT_NEAR(u, std::log(std::tanh(length / 4)), 1e-12);
      for (const double l : model.lengths()) EXPECT_NEAR(l, length, 1e-12);
    }
  }
}

TEST(RicciFlow, FindsEqualCirclesOnATorusGrid) {
  // Six around each: flat, whatever torus of revolution it was.
  const MetricSurface grid = torusOfRevolution(2, 1, 8, 6);
  CirclePackingModel model = makeModel(grid, Geometry::kEuclidean, Scheme::kTangential);
  const double mean = model.initial().mean();
  for (const FlowSteps steps : kBoth) {
    Context context;
    const auto flow =
        ricciFlow(context, model, zero(model), model.initial(), followed(steps, 1e-12));
    ASSERT_OK(flow);
    for (const double u : flow->u) EXPECT_NEAR(u, mean, 1e-11);
    EXPECT_LE(flow->residual, 1e-12);
    EXPECT_EQ(flow->history.back().residual, flow->residual);
    const std::size_t most = steps == FlowSteps::kSemiImplicit ? 30 : 1000;
    EXPECT_LE(flow->history.size(), most);
  }
}

TEST(RicciFlow, ReachesTheSameMetricByBothKindsOfSteps) {
  for (const Scheme scheme : {Scheme::kThurston, Scheme::kTangential, Scheme::kInversiveDistance}) {
    CirclePackingModel model = makeModel(irregular(subdivide(octahedronCover(), 3), 0.3, 7),
                                         Geometry::kHyperbolic, scheme);
    Context context;
    const auto slow = ricciFlow(context, model, zero(model), model.initial(),
                                followed(FlowSteps::kExplicit, 1e-10));
    ASSERT_OK(slow);
    const auto fast = ricciFlow(context, model, zero(model), shaken(model.initial(), 0.2, 2),
                                followed(FlowSteps::kSemiImplicit, 1e-12));
    ASSERT_OK(fast);
    // The residuals over the smallest eigenvalue, above 0.01.
    EXPECT_LT((slow->u - fast->u).cwiseAbs().maxCoeff(), 1e-8);
    EXPECT_LE(fast->history.size(), 40U);
    EXPECT_GT(slow->history.size(), 3 * fast->history.size());
  }
}

TEST(RicciFlow, DecaysExponentiallyAtTheRateOfTheSmallestEigenvalue) {
  // MATH 6.5: near the metric, d(target - K)/dt = -H (target - K). The last decades are taken.
  CirclePackingModel model =
      makeModel(subdivide(octahedronCover(), 2), Geometry::kHyperbolic, Scheme::kTangential);
  Context context;
  const auto flow = ricciFlow(context, model, zero(model), shaken(model.initial(), 0.3, 3),
                              followed(FlowSteps::kExplicit, 1e-12));
  ASSERT_OK(flow);
  const Eigen::MatrixXd lower = model.hessian();
  const double slowest = lower.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff();
  FlowPoint from;
  for (const FlowPoint& point : flow->history) {
    if (point.residual > 1e-9) from = point;
  }
  const FlowPoint& to = flow->history.back();
  const double rate = std::log(from.residual / to.residual) / (to.time - from.time);
  // An explicit step multiplies by 1 - dt c, not e^{-dt c}: a little faster, by dt c / 2.
  EXPECT_GT(rate / slowest, 0.99);
  EXPECT_LT(rate / slowest, 1.25);
  for (std::size_t k = 1; k < flow->history.size(); ++k) {
    EXPECT_GT(flow->history[k].time, flow->history[k - 1].time);
  }
}

TEST(RicciFlow, FindsTheMetricThatATargetWasTakenFrom) {
  // With boundary, all schemes, from starts where some faces of separate circles are broken.
  for (const Scheme scheme : {Scheme::kThurston, Scheme::kTangential, Scheme::kInversiveDistance}) {
    for (const Geometry geometry : {Geometry::kEuclidean, Geometry::kHyperbolic}) {
      CirclePackingModel model =
          makeModel(irregular(scale(plate(4, 3, {{2, 1}}), 0.2), 0.3, 6), geometry, scheme);
      const Eigen::VectorXd wanted = shaken(model.initial(), 0.1, 4);
      Context context;
      ASSERT_OK(model.moveTo(context, wanted));
      ASSERT_EQ(model.brokenFaces(), 0);
      const Eigen::VectorXd target = model.curvature();
      const Eigen::VectorXd start = shaken(model.initial(), 2.5, 5);
      ASSERT_OK(model.moveTo(context, start));
      EXPECT_EQ(model.brokenFaces() > 0, scheme == Scheme::kInversiveDistance);
      for (const FlowSteps steps : kBoth) {
        const auto flow = ricciFlow(context, model, target, start, followed(steps, 1e-11));
        ASSERT_OK(flow);
        Eigen::VectorXd error = flow->u - wanted;
        if (geometry == Geometry::kEuclidean) {
          EXPECT_NEAR(flow->u.mean(), start.mean(), 1e-12);
          error.array() -= error.mean();
        }
        EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-8);
      }
    }
  }
}

TEST(RicciFlow, LeavesTheMeanOfAnImpossibleTargetAlone) {
  // A target whose sum is off by 1: K ends at target plus the same number everywhere.
  CirclePackingModel model =
      makeModel(torusOfRevolution(2, 1, 8, 6), Geometry::kEuclidean, Scheme::kTangential);
  const Eigen::VectorXd target =
      Eigen::VectorXd::Constant(model.size(), 1.0 / static_cast<double>(model.size()));
  Context context;
  ASSERT_OK(ricciFlow(context, model, target, model.initial(), {}));
  EXPECT_LT(model.curvature().cwiseAbs().maxCoeff(), 1e-10);
}

TEST(RicciFlow, SaysSoWhereThereIsNoSuchMetric) {
  // Thurston's condition at vertex 0: its seven angles cannot add up to 7 pi + 1.
  CirclePackingModel model = makeModel(kleinQuartic(), Geometry::kEuclidean, Scheme::kTangential);
  const auto count = static_cast<double>(model.size());
  Eigen::VectorXd target =
      Eigen::VectorXd::Constant(model.size(), (-8 * kPi - (2 * kPi - 7 * kPi - 1)) / (count - 1));
  target[0] = 2 * kPi - 7 * kPi - 1;
  for (const FlowSteps steps : kBoth) {
    Context context;
    FlowOptions options = followed(steps, 1e-10);
    options.max_steps = 300;
    const auto flow = ricciFlow(context, model, target, model.initial(), options);
    EXPECT_THAT(flow, FailsWith(Reason::kNoConvergence));
  }
}

TEST(RicciFlow, TellsAMetricFromARunawayAtTheBorder) {
  // Equality in Thurston's condition: the residual falls as the circle shrinks, and the angles lack
  // the square root of its radius, so that a step of Newton moves u by 2.
  CirclePackingModel model = makeModel(kleinQuartic(), Geometry::kEuclidean, Scheme::kTangential);
  Eigen::VectorXd target =
      Eigen::VectorXd::Constant(model.size(), -3 * kPi / (static_cast<double>(model.size()) - 1));
  target[0] = 2 * kPi - 7 * kPi;
  Context context;
  const FlowOptions options = followed(FlowSteps::kSemiImplicit, 1e-4);
  const auto runaway = ricciFlow(context, model, target, model.initial(), options);
  ASSERT_OK(runaway);
  EXPECT_GT(runaway->last_change, 0.5);
  EXPECT_LT(runaway->u.minCoeff(), runaway->u.mean() - 10);
  target.setConstant(-8 * kPi / static_cast<double>(model.size()));
  const auto metric = ricciFlow(context, model, target, shaken(model.initial(), 1, 9), options);
  ASSERT_OK(metric);
  EXPECT_LT(metric->last_change, 0.05);
}

/// K = A u, the pattern of A being stored now with and now without a zero.
class LinearModel final : public CurvatureModel {
 public:
  Geometry geometry() const override { return Geometry::kHyperbolic; }
  Eigen::Index size() const override { return 3; }
  Status moveTo(Context&, const Eigen::VectorXd& u) override {
    if (u.cwiseAbs().maxCoeff() > 10) return {Reason::kNoConvergence, "too far"};
    ++version_;
    matrix_.resize(3, 3);
    std::vector<Eigen::Triplet<double>> entries{{0, 0, 2}, {1, 1, 2}, {2, 2, 2}, {1, 0, -1}};
    if (version_ % 2 == 0) entries.emplace_back(2, 0, 0);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    curvature_ = matrix_.selfadjointView<Eigen::Lower>() * u;
    return {};
  }
  const Eigen::VectorXd& curvature() const override { return curvature_; }
  const SparseMatrix& hessian() override { return matrix_; }
  int patternVersion() const override { return version_; }

 private:
  int version_ = 0;
  Eigen::VectorXd curvature_;
  SparseMatrix matrix_;
};

TEST(RicciFlow, FollowsAModelWhosePatternChanges) {
  for (const FlowSteps steps : kBoth) {
    LinearModel model;
    Context context;
    const Eigen::Vector3d target(1, 1, -4);
    const auto flow =
        ricciFlow(context, model, target, Eigen::Vector3d(9, -9, 9), followed(steps, 1e-12));
    ASSERT_OK(flow);
    EXPECT_LT((flow->u - Eigen::Vector3d(1, 1, -2)).norm(), 1e-11);
  }
}

/// K = u^3 for |u| <= 10: nearly stiffless at its start, so that steps from there are far too long.
class CubicModel final : public CurvatureModel {
 public:
  Geometry geometry() const override { return Geometry::kHyperbolic; }
  Eigen::Index size() const override { return 1; }
  Status moveTo(Context&, const Eigen::VectorXd& u) override {
    if (std::abs(u[0]) > 10) return {Reason::kNoConvergence, "too far"};
    curvature_ = u.array().cube();
    matrix_.resize(1, 1);
    matrix_.coeffRef(0, 0) = 3 * u[0] * u[0];
    matrix_.makeCompressed();
    return {};
  }
  const Eigen::VectorXd& curvature() const override { return curvature_; }
  const SparseMatrix& hessian() override { return matrix_; }
  int patternVersion() const override { return 0; }

 private:
  Eigen::VectorXd curvature_;
  SparseMatrix matrix_;
};

TEST(RicciFlow, ShortensStepsThatAreTooLong) {
  // The first one would lead to some 3000, the next ones to places of larger residual.
  for (const FlowSteps steps : kBoth) {
    CubicModel model;
    Context context;
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
    const auto flow = ricciFlow(context, model, one, 0.01 * one, followed(steps, 1e-13));
    ASSERT_OK(flow);
    EXPECT_NEAR(flow->u[0], 1, 1e-13);
    EXPECT_EQ(model.curvature()[0], std::pow(flow->u[0], 3));
    EXPECT_GE(flow->rejected_steps, 4);
    for (std::size_t k = 1; k < flow->history.size(); ++k) {
      EXPECT_LE(flow->history[k].residual, flow->history[k - 1].residual + 1e-13);
    }
  }
}

TEST(RicciFlow, PassesFailuresOn) {
  LinearModel model;
  Context context;
  const Eigen::Vector3d three(1, 1, 1);
  const Eigen::VectorXd two = Eigen::VectorXd::Ones(2);
  EXPECT_THAT(ricciFlow(context, model, two, three, {}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(ricciFlow(context, model, three, two, {}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(ricciFlow(context, model, three, three, followed(FlowSteps::kExplicit, 0)),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(ricciFlow(context, model, three * std::nan(""), three, {}),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(ricciFlow(context, model, three, 100 * three, {}), FailsWith(Reason::kNoConvergence));
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(ricciFlow(context, model, three, three, {}), FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
