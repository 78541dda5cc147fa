#include "core/ricci/ricci_objective.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/double_cover.h"
#include "core/mesh/samples.h"
#include "core/optimize/affine_normal.h"
#include "core/ricci/circle_packing.h"
#include "core/ricci/mirror_symmetry.h"
#include "core/ricci/vertex_scaling.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Flips = VertexScalingModel::Flips;

constexpr double kPi = std::numbers::pi;
constexpr Geometry kPlanes[] = {Geometry::kEuclidean, Geometry::kHyperbolic};

Eigen::VectorXd someNumbers(Eigen::Index count, double far, std::mt19937& random) {
  return Eigen::VectorXd::NullaryExpr(count, [&] { return far * (2 * uniform(random) - 1); });
}

MetricSurface torus() {
  const auto soup = makeSample("torus", {{"R", 2}, {"r", 0.8}, {"resolution", 8}, {"seed", 3}});
  EXPECT_OK(soup);
  return fromPositions(soup->vertices, soup->faces);
}

/// Closed surfaces, on some of which edges are loops or doubled, and bordered ones.
std::vector<MetricSurface> someSurfaces() {
  std::vector<MetricSurface> surfaces{flatTorus({0.2, 1.1}, 4, 4, 0.2, 7), gluedPolygon(8),
                                      squareTiledL(), plate(3, 3, {{1, 1}})};
  for (MetricSurface& surface : surfaces) {
    // Circles of radii below 1/2.
    const double longest = *std::max_element(surface.lengths.begin(), surface.lengths.end());
    surface = scale(std::move(surface), 0.4 / longest);
  }
  return surfaces;
}

VertexScalingModel scaling(const MetricSurface& metric, Geometry geometry, Flips flips) {
  std::vector<double> half_chords = metric.lengths;
  for (double& x : half_chords) x /= 2;
  return {geometry, IntrinsicTriangulation(metric.surface, half_chords),
          Unknowns::all(metric.surface.vertexCount()), flips};
}

/// Every kind of model on a surface.
std::vector<std::unique_ptr<CurvatureModel>> everyModel(const MetricSurface& metric,
                                                        Geometry geometry) {
  std::vector<std::unique_ptr<CurvatureModel>> models;
  for (const Flips flips : {Flips::kOff, Flips::kOn}) {
    models.push_back(std::make_unique<VertexScalingModel>(scaling(metric, geometry, flips)));
  }
  for (const Scheme scheme : {Scheme::kThurston, Scheme::kTangential, Scheme::kInversiveDistance}) {
    auto circles = CirclePackingModel::make(metric.surface, geometry, scheme, metric.lengths);
    EXPECT_OK(circles);
    models.push_back(std::make_unique<CirclePackingModel>(*std::move(circles)));
  }
  return models;
}

/// A place for the model's unknowns where it can be.
Eigen::VectorXd placeOf(const CurvatureModel& model) {
  const auto* circles = dynamic_cast<const CirclePackingModel*>(&model);
  return circles == nullptr ? Eigen::VectorXd::Zero(model.size()) : circles->initial();
}

/// Random numbers on the pattern of a matrix.
SparseMatrix randomOn(SparseMatrix pattern, std::mt19937& random) {
  for (double& value : pattern.coeffs()) value = 2 * uniform(random) - 1;
  return pattern;
}

/// The sum of the products of all entries of two symmetric matrices.
double innerProduct(const SparseMatrix& a, const SparseMatrix& b) {
  const Eigen::MatrixXd wholes[2] = {Eigen::MatrixXd(a).selfadjointView<Eigen::Lower>(),
                                     Eigen::MatrixXd(b).selfadjointView<Eigen::Lower>()};
  return wholes[0].cwiseProduct(wholes[1]).sum();
}

/// The contraction by differences of Hessians of fourth order; P of the given pattern.
Eigen::VectorXd contractionByDifferences(Objective& objective, const Eigen::VectorXd& x,
                                         const SparseMatrix& weights) {
  Context context;
  const double h = 1e-3;
  Eigen::VectorXd result(x.size());
  for (Eigen::Index c = 0; c < x.size(); ++c) {
    const auto at = [&](double step) {
      Eigen::VectorXd moved = x;
      moved[c] += step;
      EXPECT_OK(objective.moveTo(context, moved));
      return innerProduct(weights, objective.hessian());
    };
    result[c] = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
  }
  return result;
}

// The error of the differences is h^4 / 30 = 3e-14 times fifth derivatives of the Hessian's
// entries, up to 1e5 in the thinnest of these faces, in sums of some ten entries; rounding is
// 1e-14 / h. A border between cells within 2 h of the place would give jumps: the places are fixed.
TEST(RicciObjective, ContractsTheDerivativesOfItsHessian) {
  Context context;
  std::mt19937 random(1);
  for (const MetricSurface& metric : someSurfaces()) {
    for (const Geometry geometry : kPlanes) {
      for (const auto& model : everyModel(metric, geometry)) {
        const Eigen::VectorXd start = placeOf(*model) + someNumbers(model->size(), 0.1, random);
        RicciObjective objective(*model, Eigen::VectorXd::Zero(model->size()), start);
        ASSERT_TRUE(objective.hasThirdDerivatives());
        ASSERT_OK(objective.moveTo(context, start));
        const SparseMatrix weights = randomOn(objective.hessian(), random);
        const Eigen::VectorXd exact = objective.thirdContraction(weights);
        const Eigen::VectorXd numeric = contractionByDifferences(objective, start, weights);
        EXPECT_LT((exact - numeric).cwiseAbs().maxCoeff(), 1e-7 * (1 + exact.norm()));
      }
    }
  }
}

TEST(RicciObjective, ContractsOverOrbitsOfMirrorImages) {
  Context context;
  std::mt19937 random(2);
  const MetricSurface half = plate(3, 3, {{1, 1}});
  const auto cover = doubleCover(half.surface);
  ASSERT_OK(cover);
  std::vector<double> half_chords = lengthsOnDouble(*cover, half.lengths);
  for (double& x : half_chords) x /= 2;
  for (const Geometry geometry : kPlanes) {
    VertexScalingModel model(geometry, IntrinsicTriangulation(cover->connectivity, half_chords),
                             mirrorUnknowns(*cover), Flips::kOff);
    const Eigen::VectorXd start = someNumbers(model.size(), 0.1, random);
    RicciObjective objective(model, Eigen::VectorXd::Zero(model.size()), start);
    ASSERT_OK(objective.moveTo(context, start));
    const SparseMatrix weights = randomOn(objective.hessian(), random);
    const Eigen::VectorXd exact = objective.thirdContraction(weights);
    const Eigen::VectorXd numeric = contractionByDifferences(objective, start, weights);
    EXPECT_LT((exact - numeric).cwiseAbs().maxCoeff(), 1e-8 * (1 + exact.norm()));
  }
}

TEST(RicciObjective, WithFixedUnknownsIsTheRestrictionToTheOthers) {
  Context context;
  std::mt19937 random(3);
  const MetricSurface metric = torus();
  for (const Geometry geometry : kPlanes) {
    VertexScalingModel model = scaling(metric, geometry, Flips::kOff);
    const Eigen::VectorXd start = someNumbers(model.size(), 0.1, random);
    std::vector<bool> fixed(static_cast<std::size_t>(model.size()));
    for (std::size_t n = 0; n < fixed.size(); ++n) fixed[n] = n % 5 == 1;
    const Eigen::VectorXd target = someNumbers(model.size(), 0.1, random);
    RicciObjective objective(model, target, start, fixed);
    EXPECT_FALSE(objective.constantsInKernel());
    const Eigen::VectorXd x = objective.start();
    ASSERT_EQ(x.size(), objective.dimension());
    EXPECT_EQ(objective.unknowns(x), start);
    ASSERT_OK(objective.moveTo(context, x));
    EXPECT_EQ(objective.gradient(), objective.variables(model.curvature() - target));
    const Eigen::MatrixXd whole = Eigen::MatrixXd(model.hessian());
    const Eigen::MatrixXd part = Eigen::MatrixXd(objective.hessian());
    Eigen::Index column = 0;
    for (Eigen::Index n = 0; n < model.size(); ++n) {
      if (fixed[static_cast<std::size_t>(n)]) continue;
      EXPECT_EQ(part.col(column), objective.variables(whole.col(n)));
      ++column;
    }
    const SparseMatrix weights = randomOn(objective.hessian(), random);
    const Eigen::VectorXd exact = objective.thirdContraction(weights);
    const Eigen::VectorXd numeric = contractionByDifferences(objective, x, weights);
    EXPECT_LT((exact - numeric).cwiseAbs().maxCoeff(), 1e-8 * (1 + exact.norm()));
  }
}

/// A model that keeps its energy to itself.
class WithoutEnergy : public CurvatureModel {
 public:
  explicit WithoutEnergy(CurvatureModel& model) : model_(model) {}
  Geometry geometry() const override { return model_.geometry(); }
  Eigen::Index size() const override { return model_.size(); }
  Status moveTo(Context& context, const Eigen::VectorXd& u) override {
    ++moves;
    return model_.moveTo(context, u);
  }
  void accept() override { model_.accept(); }
  const Eigen::VectorXd& curvature() const override { return model_.curvature(); }
  const SparseMatrix& hessian() override { return model_.hessian(); }
  int patternVersion() const override { return model_.patternVersion(); }

  int moves = 0;

 private:
  CurvatureModel& model_;
};

// The formula, from face to face and across flips, and the integral of the curvatures know nothing
// of one another. Within a cell the quadrature is good to 1e-9 of the change, after a few moves.
// The longer way, in pieces of a hundredth, crosses some hundred borders: at each the second
// derivative of the slope jumps by up to 1e5, and 64 nodes a piece leave a twelfth of it times
// (0.01 / 64)^3.
TEST(RicciObjective, HasTheIntegralOfItsGradientAsValue) {
  std::mt19937 random(4);
  for (const Geometry geometry : kPlanes) {
    for (const double far : {0.05, 1.5}) {
      const MetricSurface metric =
          geometry == Geometry::kEuclidean ? torus() : subdivide(octahedronCover(), 3);
      const Flips flips = far > 1 ? Flips::kOn : Flips::kOff;
      VertexScalingModel model = scaling(metric, geometry, flips);
      VertexScalingModel other = scaling(metric, geometry, flips);
      WithoutEnergy silent(other);
      const Eigen::VectorXd target = someNumbers(model.size(), 0.1, random);
      const Eigen::VectorXd from = someNumbers(model.size(), far, random);
      const Eigen::VectorXd to = someNumbers(model.size(), far, random);
      RicciObjective formula(model, target, from), integral(silent, target, from);
      Context context;
      ASSERT_OK(formula.moveTo(context, from));
      ASSERT_OK(integral.moveTo(context, from));
      const double start = formula.value();
      const std::size_t history = model.triangulation().history().size();
      EXPECT_EQ(integral.value(), 0);
      ASSERT_OK(formula.moveTo(context, to));
      const int pieces = far > 1 ? 100 : 1;
      for (int k = 1; k <= pieces; ++k) {
        ASSERT_OK(integral.moveTo(context, from + (1.0 * k / pieces) * (to - from)));
      }
      const double change = formula.value() - start;
      if (far > 1) {
        EXPECT_NE(model.triangulation().history().size(), history);
      }
      EXPECT_NEAR(integral.value(), change, far > 1 ? 1e-7 : 1e-9 * (1 + std::abs(change)));
      if (far < 1) {
        EXPECT_LE(silent.moves, 20);
      }
    }
  }
}

// Across a border between two cells the value goes on, with its first two derivatives: along a
// short segment through it the trapezoid rule of the slopes is good to the third power.
TEST(RicciObjective, IsSmoothWhereEdgesFlip) {
  std::mt19937 random(5);
  for (const Geometry geometry : kPlanes) {
    const MetricSurface metric =
        geometry == Geometry::kEuclidean ? torus() : subdivide(octahedronCover(), 3);
    VertexScalingModel model = scaling(metric, geometry, Flips::kOn);
    const Eigen::VectorXd direction = someNumbers(model.size(), 1, random);
    RicciObjective objective(model, Eigen::VectorXd::Zero(model.size()),
                             Eigen::VectorXd::Zero(model.size()));
    Context context;
    const double h = 5e-4;
    double last_value = 0, last_slope = 0;
    std::size_t last_edges = 0;
    int crossed = 0;
    for (int k = 0; k < 2000; ++k) {
      ASSERT_OK(objective.moveTo(context, k * h * direction));
      const double value = objective.value(), slope = objective.gradient().dot(direction);
      const std::size_t edges = model.triangulation().history().size();
      // The error is a twelfth of h^3 times the second derivative of the slope, below 1e3.
      if (k > 0) {
        EXPECT_NEAR(value - last_value, h * (slope + last_slope) / 2, h * h * h * 1e2);
        if (edges != last_edges) ++crossed;
      }
      last_value = value;
      last_slope = slope;
      last_edges = edges;
    }
    EXPECT_GT(crossed, 3);
  }
}

// The differential is closed: a circle's energy does not depend on the way.
TEST(RicciObjective, OfCirclesHasOneValueOnEveryWay) {
  std::mt19937 random(6);
  for (const MetricSurface& metric : someSurfaces()) {
    for (const Geometry geometry : kPlanes) {
      for (const Scheme scheme : {Scheme::kThurston, Scheme::kTangential}) {
        auto model = CirclePackingModel::make(metric.surface, geometry, scheme, metric.lengths);
        ASSERT_OK(model);
        const Eigen::VectorXd start = model->initial();
        RicciObjective one(*model, Eigen::VectorXd::Ones(model->size()), start);
        Context context;
        ASSERT_OK(one.moveTo(context, start));
        const Eigen::VectorXd aside = start + someNumbers(start.size(), 0.3, random);
        const Eigen::VectorXd there = start + someNumbers(start.size(), 0.3, random);
        ASSERT_OK(one.moveTo(context, there));
        const double straight = one.value();
        ASSERT_OK(one.moveTo(context, aside));
        ASSERT_OK(one.moveTo(context, start));
        EXPECT_NEAR(one.value(), 0, 1e-8);
        ASSERT_OK(one.moveTo(context, there));
        EXPECT_NEAR(one.value(), straight, 1e-8);
      }
    }
  }
}

TEST(RicciObjective, StaysWhereItWasAfterAStepTooFar) {
  Context context;
  auto model = CirclePackingModel::make(kleinQuartic().surface, Geometry::kHyperbolic,
                                        Scheme::kTangential, kleinQuartic().lengths);
  ASSERT_OK(model);
  RicciObjective objective(*model, Eigen::VectorXd::Zero(model->size()), model->initial());
  ASSERT_OK(objective.moveTo(context, objective.start()));
  const Eigen::VectorXd before = objective.gradient();
  EXPECT_THAT(objective.moveTo(context, Eigen::VectorXd::Ones(model->size())),
              FailsWith(Reason::kNoConvergence));
  ASSERT_OK(objective.moveTo(context, objective.start()));
  EXPECT_EQ(objective.gradient(), before);
  EXPECT_NEAR(objective.value(), 0, 1e-12);
}

/// Vertex scaling of a genus 2 surface with 70 vertices, or a torus, at a place not too near its
/// minimum.
struct Problem {
  VertexScalingModel model;
  Eigen::VectorXd target, start;

  static Problem in(Geometry geometry) {
    std::mt19937 random(7);
    const MetricSurface metric =
        geometry == Geometry::kEuclidean ? torus() : subdivide(octahedronCover(), 3);
    VertexScalingModel model = scaling(metric, geometry, Flips::kOff);
    Eigen::VectorXd start = someNumbers(model.size(), 0.05, random);
    Eigen::VectorXd target = Eigen::VectorXd::Zero(model.size());
    return {std::move(model), std::move(target), std::move(start)};
  }
};

TEST(RicciAffineNormal, BySelectedInversionIsThatOfTheTangentSpace) {
  for (const Geometry geometry : kPlanes) {
    Problem problem = Problem::in(geometry);
    RicciObjective objective(problem.model, problem.target, problem.start);
    Context context;
    const auto selected = affineNormal(context, objective, problem.start);
    ASSERT_OK(selected);
    // g.P = 0: whatever tau, the decrease is q.
    EXPECT_NEAR(objective.gradient().dot(selected->direction) / selected->decrease, 1, 1e-12);
    AffineNormalOptions options;
    options.form = AffineForm::kTangent;
    const auto tangent = affineNormal(context, objective, problem.start, options);
    ASSERT_OK(tangent);
    // The same line; of another length. Both inverses are good to epsilon times the condition
    // number, below 1e4.
    const Eigen::VectorXd twin = tangent->direction * (selected->decrease / tangent->decrease);
    EXPECT_LT((selected->direction - twin).norm(), 1e-11 * twin.norm());
  }
}

// CHECKS I14: second differences of the gradient along the eigen-columns of P, exact up to h^2 =
// 1e-6 times fourth derivatives, and rounding of 1e-13 / h^2.
TEST(RicciAffineNormal, HasTheContractionThatGradientsGive) {
  for (const Geometry geometry : kPlanes) {
    Problem problem = Problem::in(geometry);
    RicciObjective objective(problem.model, problem.target, problem.start);
    Context context;
    const auto exact = affineNormal(context, objective, problem.start);
    AffineNormalOptions options;
    options.third = ThirdSource::kEigenColumns;
    const auto columns = affineNormal(context, objective, problem.start, options);
    ASSERT_OK(exact);
    ASSERT_OK(columns);
    EXPECT_LT((exact->tau - columns->tau).norm(), 1e-5 * exact->tau.norm());
    EXPECT_LT((exact->direction - columns->direction).norm(), 1e-6 * exact->direction.norm());
  }
}

TEST(RicciAffineNormal, IsWhereGaussianSamplesScatterAround) {
  constexpr int kSeeds = 100;
  for (const Geometry geometry : kPlanes) {
    Problem problem = Problem::in(geometry);
    RicciObjective objective(problem.model, problem.target, problem.start);
    Context context;
    const auto exact = affineNormal(context, objective, problem.start);
    ASSERT_OK(exact);
    AffineNormalOptions options;
    options.third = ThirdSource::kGaussian;
    options.samples = 8;
    std::mt19937 random(8);
    const Eigen::VectorXd probe = someNumbers(problem.start.size(), 1, random);
    double sum = 0, squares = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      options.seed = static_cast<std::uint64_t>(seed);
      const auto sampled = affineNormal(context, objective, problem.start, options);
      ASSERT_OK(sampled);
      EXPECT_NEAR(objective.gradient().dot(sampled->direction) / sampled->decrease, 1, 1e-11);
      const double off = probe.dot(sampled->tau - exact->tau);
      sum += off;
      squares += off * off;
    }
    const double sigma = std::sqrt(squares / kSeeds / (kSeeds - 1));
    EXPECT_LT(std::abs(sum / kSeeds), 3 * sigma);
    // The noise itself is that of 8 samples, not of a wrong scale.
    EXPECT_LT(std::sqrt(squares / kSeeds),
              10 * std::abs(probe.dot(exact->tau)) + exact->tau.norm());
  }
}

/// The affine normal of a function of n unknowns that constants leave alone, restricted to the
/// columns of a basis of a slice across them: MATH 11.3 with n - 1 unknowns, in dense matrices.
Eigen::VectorXd normalOnSlice(Objective& objective, const Eigen::MatrixXd& basis) {
  const SparseMatrix hessian = objective.hessian();
  const Eigen::MatrixXd whole = Eigen::MatrixXd(hessian).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd inverse = (basis.transpose() * whole * basis).inverse();
  const Eigen::VectorXd gradient = basis.transpose() * objective.gradient();
  const Eigen::VectorXd newton = inverse * gradient;
  const double q = gradient.dot(newton);
  const Eigen::MatrixXd P = inverse - newton * newton.transpose() / q;
  const Eigen::MatrixXd carried = basis * P * basis.transpose();
  SparseMatrix weights = hessian;
  for (Eigen::Index column = 0; column < weights.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(weights, column); it; ++it) {
      it.valueRef() = carried(it.row(), column);
    }
  }
  const Eigen::VectorXd tau = basis.transpose() * objective.thirdContraction(weights);
  const auto unknowns = static_cast<double>(basis.cols());
  Eigen::VectorXd direction = basis * (newton + q / (unknowns + 1) * (P * tau));
  direction.array() -= direction.mean();
  return direction;
}

// CHECKS I13.
TEST(RicciAffineNormal, InTheEuclideanPlaneIsTheSameOnEverySlice) {
  Problem problem = Problem::in(Geometry::kEuclidean);
  RicciObjective objective(problem.model, problem.target, problem.start);
  Context context;
  const auto pinned = affineNormal(context, objective, problem.start);
  ASSERT_OK(pinned);
  const Eigen::Index n = problem.start.size();
  const double size = pinned->direction.norm();
  // Condition numbers of some 1e3.
  for (const Eigen::Index pin : {Eigen::Index{0}, n / 2, n - 1}) {
    Eigen::MatrixXd basis(n, n - 1);
    basis << Eigen::MatrixXd::Identity(n, n).leftCols(pin),
        Eigen::MatrixXd::Identity(n, n).rightCols(n - 1 - pin);
    EXPECT_LT((normalOnSlice(objective, basis) - pinned->direction).norm(), 1e-11 * size);
  }
  // Sum 0, by an orthonormal basis.
  Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(n, 1);
  const Eigen::MatrixXd rotation = Eigen::HouseholderQR<Eigen::MatrixXd>(ones).householderQ();
  EXPECT_LT((normalOnSlice(objective, rotation.rightCols(n - 1)) - pinned->direction).norm(),
            1e-11 * size);
  EXPECT_NEAR(pinned->direction.sum(), 0, 1e-12 * size);
}

}  // namespace
}  // namespace moduli
