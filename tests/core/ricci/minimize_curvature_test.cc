#include "core/ricci/minimize_curvature.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/intrinsic/mollify.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/ricci/circle_packing.h"
#include "core/ricci/uniformize.h"
#include "core/ricci/vertex_scaling.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Flips = VertexScalingModel::Flips;

constexpr RicciSolver kMinimizers[] = {RicciSolver::kAffineNormal, RicciSolver::kLbfgs};

Eigen::VectorXd someNumbers(Eigen::Index count, double far, std::mt19937& random) {
  return Eigen::VectorXd::NullaryExpr(count, [&] { return far * (2 * uniform(random) - 1); });
}

VertexScalingModel scaling(const MetricSurface& metric, Geometry geometry, Flips flips) {
  std::vector<double> half_chords = metric.lengths;
  for (double& x : half_chords) x /= 2;
  return {geometry, IntrinsicTriangulation(metric.surface, half_chords),
          Unknowns::all(metric.surface.vertexCount()), flips};
}

/// 70 vertices, genus 2, away from its symmetry by random factors.
MetricSurface someGenus2(double far) {
  MetricSurface metric = scale(subdivide(octahedronCover(), 3), 1.35);
  std::mt19937 random(11);
  for (double& length : metric.lengths) length *= std::exp(far * (2 * uniform(random) - 1));
  return metric;
}

MetricSurface torus() {
  const auto soup = makeSample("torus", {{"R", 2}, {"r", 0.8}, {"resolution", 8}, {"seed", 3}});
  EXPECT_OK(soup);
  return fromPositions(soup->vertices, soup->faces);
}

Eigen::VectorXd withoutMean(Eigen::VectorXd u) {
  u.array() -= u.mean();
  return u;
}

// CHECKS I12. Two residuals of 1e-12 or less, over the smallest eigenvalue, above 0.05.
TEST(MinimizeCurvature, AlongAffineNormalsConvergesQuadraticallyToNewtonsMinimum) {
  const MetricSurface metric = someGenus2(0.15);
  ASSERT_EQ(metric.surface.vertexCount(), 70);
  Context context;
  VertexScalingModel model = scaling(metric, Geometry::kHyperbolic, Flips::kOff);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.size());
  NewtonOptions options;
  options.tolerance = 1e-12;
  const auto newton = solveCurvature(context, model, zero, zero, options);
  const auto affine =
      findCurvature(context, model, zero, zero, options, RicciSolver::kAffineNormal);
  ASSERT_OK(newton);
  ASSERT_OK(affine);
  EXPECT_LT((newton->u - affine->u).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LE(affine->iterations(), 7);
  EXPECT_LE(std::abs(affine->iterations() - newton->iterations()), 2);
  std::string history;
  for (const double residual : affine->residuals) history += std::to_string(residual) + " ";
  // Once below 0.1 each residual is at most of the order of the square of the one before.
  for (std::size_t n = 0; n + 1 < affine->residuals.size(); ++n) {
    const double before = affine->residuals[n], after = affine->residuals[n + 1];
    if (before < 0.1) {
      EXPECT_LT(after, 2 * before * before + 1e-12) << history;
    }
  }
}

// The residuals of 1e-10 that are allowed, over the smallest eigenvalue, above 0.02.
TEST(MinimizeCurvature, FindsWhatNewtonsMethodFinds) {
  Context context;
  std::mt19937 random(2);
  for (const bool flat : {true, false}) {
    const MetricSurface metric = flat ? torus() : someGenus2(0);
    VertexScalingModel model =
        scaling(metric, flat ? Geometry::kEuclidean : Geometry::kHyperbolic, Flips::kOn);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.size());
    const Eigen::VectorXd start = someNumbers(model.size(), 1, random);
    const auto newton = solveCurvature(context, model, zero, start);
    ASSERT_OK(newton);
    for (const RicciSolver solver : kMinimizers) {
      const auto found = findCurvature(context, model, zero, start, {}, solver);
      ASSERT_OK(found);
      const Eigen::VectorXd difference = found->u - newton->u;
      EXPECT_LT((flat ? withoutMean(difference) : difference).cwiseAbs().maxCoeff(), 1e-8);
      EXPECT_LT(found->residual(), 1e-10);
    }
  }
}

TEST(MinimizeCurvature, PacksCirclesAsNewtonsMethodDoes) {
  Context context;
  std::mt19937 random(3);
  for (const Scheme scheme : {Scheme::kThurston, Scheme::kTangential, Scheme::kInversiveDistance}) {
    for (const Geometry geometry : {Geometry::kEuclidean, Geometry::kHyperbolic}) {
      const MetricSurface metric = flatTorus({0.2, 1.1}, 5, 5, 0.2, 7);
      auto model = CirclePackingModel::make(metric.surface, geometry, scheme, metric.lengths);
      ASSERT_OK(model);
      // A target that is reached: the curvatures at another place.
      const Eigen::VectorXd there = model->initial() -
                                    Eigen::VectorXd::Constant(model->size(), 0.1) +
                                    someNumbers(model->size(), 0.05, random);
      ASSERT_OK(model->moveTo(context, there));
      const Eigen::VectorXd target = model->curvature();
      for (const RicciSolver solver : kMinimizers) {
        const auto found = findCurvature(context, *model, target, model->initial(), {}, solver);
        ASSERT_OK(found);
        const Eigen::VectorXd difference = found->u - there;
        const bool flat = geometry == Geometry::kEuclidean;
        EXPECT_LT((flat ? withoutMean(difference) : difference).cwiseAbs().maxCoeff(), 1e-8);
      }
    }
  }
}

TEST(MinimizeCurvature, KeepsFixedUnknownsToTheBit) {
  Context context;
  std::mt19937 random(4);
  const MetricSurface metric = torus();
  VertexScalingModel model = scaling(metric, Geometry::kEuclidean, Flips::kOn);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.size());
  const Eigen::VectorXd start = someNumbers(model.size(), 0.2, random);
  NewtonOptions options;
  for (Eigen::Index n = 0; n < model.size(); ++n) options.fixed.push_back(n % 7 == 0);
  const auto newton = solveCurvature(context, model, zero, start, options);
  ASSERT_OK(newton);
  for (const RicciSolver solver : kMinimizers) {
    const auto found = findCurvature(context, model, zero, start, options, solver);
    ASSERT_OK(found);
    for (Eigen::Index n = 0; n < model.size(); ++n) {
      if (options.fixed[static_cast<std::size_t>(n)]) {
        EXPECT_EQ(found->u[n], start[n]);
      } else {
        EXPECT_NEAR(found->u[n], newton->u[n], 1e-8);
        EXPECT_NEAR(model.curvature()[n], 0, 1e-10);
      }
    }
  }
}

TEST(MinimizeCurvature, SaysHowFarItCame) {
  Context context;
  VertexScalingModel model = scaling(someGenus2(0.1), Geometry::kHyperbolic, Flips::kOn);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.size());
  NewtonOptions options;
  options.max_iterations = 1;
  const auto found = findCurvature(context, model, zero, zero, options, RicciSolver::kAffineNormal);
  ASSERT_THAT(found, FailsWith(Reason::kNoConvergence));
  EXPECT_THAT(found.status().message(), testing::HasSubstr("after 1 steps of affine-normal"));
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  for (const RicciSolver solver : kMinimizers) {
    EXPECT_THAT(findCurvature(context, model, zero, zero, {}, solver),
                FailsWith(Reason::kCancelled));
  }
}

class RealMesh : public testing::TestWithParam<const char*> {};

TEST_P(RealMesh, HasOneMetricByAllSolvers) {
  const auto path = sharedMesh(GetParam());
  if (!path) GTEST_SKIP() << "no mesh " << GetParam() << "; set MODULI_SHARED";
  Context context;
  const auto soup = readMeshFile(context, *path);
  ASSERT_OK(soup);
  const auto prepared = prepareMesh(context, *soup, {});
  ASSERT_OK(prepared);
  const Connectivity& surface = prepared->mesh.connectivity();
  const auto mollified = mollify(surface, prepared->mesh.edgeLengths());
  ASSERT_OK(mollified);
  const auto newton = uniformize(context, surface, mollified->lengths);
  ASSERT_OK(newton);
  for (const RicciSolver solver : kMinimizers) {
    UniformizeOptions options;
    options.solver = solver;
    const auto found = uniformize(context, surface, mollified->lengths, options);
    ASSERT_OK(found);
    EXPECT_LE(found->metric.certificate.curvature_residual, 1e-10);
    if (solver == RicciSolver::kAffineNormal) {
      EXPECT_LE(found->metric.certificate.newton_iterations, 30);
    }
    double largest = 0, mean = 0;
    const std::vector<double>&one = newton->metric.u, &other = found->metric.u;
    for (std::size_t v = 0; v < one.size(); ++v)
      mean += (other[v] - one[v]) / static_cast<double>(one.size());
    if (surface.eulerCharacteristic() < 0) mean = 0;
    for (std::size_t v = 0; v < one.size(); ++v) {
      largest = std::max(largest, std::abs(other[v] - one[v] - mean));
    }
    // A residual of 1e-10 at each vertex over the smallest eigenvalue, some 1 / vertices.
    EXPECT_LT(largest, 1e-10 * static_cast<double>(one.size()));
  }
}

INSTANTIATE_TEST_SUITE_P(Shared, RealMesh,
                         testing::Values("genus2/cfwen__eight.off", "genus1/cfwen__torus.off",
                                         "genus1/ceaedf__rocker-arm2500.off"),
                         [](const auto& mesh) {
                           std::string name = mesh.param;
                           std::replace_if(
                               name.begin(), name.end(),
                               [](char c) { return std::isalnum(c) == 0; }, '_');
                           return name;
                         });

}  // namespace
}  // namespace moduli
