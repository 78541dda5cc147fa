#include "core/ricci/uniformization_energy.h"

#include <Eigen/Dense>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/samples.h"
#include "core/optimize/minimize.h"
#include "core/ricci/uniformize.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

/// The energy of a surface with its start: its minimizers against the metrics that uniformize()
/// finds, doubles, and other units of length.
namespace moduli {
namespace {

/// Of minimizers: gradients of 1e-10 over least eigenvalues of some hundredths.
constexpr double kTolerance = 1e-8;

MetricSurface sample(const char* kind, const std::map<std::string, double>& parameters) {
  const auto soup = makeSample(kind, parameters);
  EXPECT_OK(soup);
  return fromPositions(soup->vertices, soup->faces);
}

MetricSurface torus() {
  return sample("torus", {{"R", 2}, {"r", 0.8}, {"resolution", 8}, {"seed", 3}});
}

MetricSurface pretzel() {
  return sample("genus", {{"genus", 2}, {"resolution", 3}});
}

Eigen::VectorXd minimizer(const MetricSurface& metric, Scheme scheme,
                          MinimizeMethod method = MinimizeMethod::kAffineNormal) {
  Context context;
  const auto energy =
      UniformizationEnergy::make(context, metric.surface, metric.lengths, {scheme, true});
  EXPECT_OK(energy);
  if (!energy.ok()) return {};
  MinimizeOptions options;
  options.method = method;
  const auto minimum = minimize(context, (*energy)->objective(), (*energy)->start(), options);
  EXPECT_OK(minimum);
  if (!minimum.ok()) return {};
  EXPECT_TRUE(minimum->converged) << stopReasonName(minimum->reason);
  const bool flat = (*energy)->objective().constantsInKernel();
  EXPECT_EQ(flat, metric.surface.eulerCharacteristic() == 0);
  return minimum->x.array() - (flat ? minimum->x.mean() : 0);
}

void expectSame(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), kTolerance);
}

TEST(UniformizationEnergy, IsLeastAtTheMetricOfConstantCurvature) {
  for (const MetricSurface& metric :
       {torus(), pretzel(), plate(3, 3, {{1, 1}}), plate(5, 3, {{1, 1}, {3, 1}})}) {
    Context context;
    const auto uniform = uniformize(context, metric.surface, metric.lengths);
    ASSERT_OK(uniform);
    const Index vertices = metric.surface.vertexCount();
    Eigen::VectorXd u = Eigen::Map<const Eigen::VectorXd>(uniform->metric.u.data(), vertices);
    if (metric.surface.eulerCharacteristic() == 0) u.array() -= u.mean();
    for (const MinimizeMethod method : {MinimizeMethod::kAffineNormal, MinimizeMethod::kNewton}) {
      expectSame(minimizer(metric, Scheme::kVertexScaling, method), u);
    }
  }
}

TEST(UniformizationEnergy, PacksCirclesOfABorderedSurfaceAsOfItsDouble) {
  for (const MetricSurface& metric : {plate(3, 3, {{1, 1}}), plate(5, 3, {{1, 1}, {3, 1}})}) {
    for (const Scheme scheme :
         {Scheme::kTangential, Scheme::kThurston, Scheme::kInversiveDistance}) {
      const Eigen::VectorXd own = minimizer(metric, scheme);
      const Eigen::VectorXd both = minimizer(doubled(metric), scheme);
      ASSERT_GE(both.size(), own.size());
      // The first copy keeps its numbers. In E2 a constant is left open.
      Eigen::VectorXd half = both.head(own.size());
      if (metric.surface.eulerCharacteristic() == 0) half.array() -= half.mean();
      expectSame(own, half);
    }
  }
}

TEST(UniformizationEnergy, KnowsNoUnitOfLength) {
  for (const MetricSurface& metric : {torus(), pretzel()}) {
    for (const Scheme scheme : {Scheme::kVertexScaling, Scheme::kInversiveDistance}) {
      expectSame(minimizer(metric, scheme), minimizer(scale(metric, 700), scheme));
    }
  }
}

TEST(UniformizationEnergy, RefusesSpheresAndDisks) {
  Context context;
  for (const MetricSurface& metric : {sample("sphere", {{"resolution", 3}}), plate(2, 2, {})}) {
    EXPECT_THAT(UniformizationEnergy::make(context, metric.surface, metric.lengths),
                FailsWith(Reason::kUnsupportedTopology));
  }
}

}  // namespace
}  // namespace moduli
