#include "core/ricci/uniformization_energy.h"

#include <Eigen/Dense>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/optimize/minimize.h"
#include "core/ricci/uniformize.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

/// The energy of a surface with its start: its minimizers against the metrics that uniformize()
/// finds, doubles, and other units of length.
namespace moduli {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

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

TEST(UniformizationEnergy, TellsWherePackingsAreClampedOrDegenerate) {
  Context context;
  const MetricSurface metric = torus();
  const auto energy = UniformizationEnergy::make(context, metric.surface, metric.lengths,
                                                 {Scheme::kTangential, true});
  ASSERT_OK(energy);
  RicciObjective& objective = (*energy)->objective();
  ASSERT_OK(objective.moveTo(context, (*energy)->start()));
  EXPECT_TRUE((*energy)->remarks((*energy)->start()).empty());
  Eigen::VectorXd u = (*energy)->start();
  u[0] -= 8;
  ASSERT_OK(objective.moveTo(context, u));
  EXPECT_THAT((*energy)->remarks(u), ElementsAre(StartsWith("SHRINKING_CIRCLES: ")));

  // Separate circles, one of which is small, make no triangles.
  const auto separate = UniformizationEnergy::make(context, metric.surface, metric.lengths,
                                                   {Scheme::kInversiveDistance, true});
  ASSERT_OK(separate);
  u = (*separate)->start();
  u[0] += 8;
  u[1] -= 8;
  ASSERT_OK((*separate)->objective().moveTo(context, u));
  EXPECT_THAT((*separate)->remarks(u),
              ElementsAre(StartsWith("BROKEN_FACES: "), StartsWith("SHRINKING_CIRCLES: ")));

  const auto clamped = UniformizationEnergy::make(context, metric.surface, metric.lengths,
                                                  {Scheme::kThurston, true});
  ASSERT_OK(clamped);
  ASSERT_OK((*clamped)->objective().moveTo(context, (*clamped)->start()));
  EXPECT_THAT((*clamped)->remarks((*clamped)->start()), ElementsAre(StartsWith("CLAMPED: ")));
}

// On two vertices of this mesh circles shrink for ever: the gradient falls by e with each step.
TEST(UniformizationEnergy, ARealMeshWithoutAPackingIsToldApart) {
  MODULI_NEED_SHARED_MESH(file, "genus1/ceaedf__Kitten.off");
  Context context;
  const auto soup = readMeshFile(context, file);
  ASSERT_OK(soup);
  const auto prepared = prepareMesh(context, *soup, {});
  ASSERT_OK(prepared);
  const auto energy =
      UniformizationEnergy::make(context, prepared->mesh.connectivity(),
                                 prepared->mesh.edgeLengths(), {Scheme::kThurston, true});
  ASSERT_OK(energy);
  MinimizeOptions options;
  options.method = MinimizeMethod::kNewton;
  options.gradient_tolerance = 1e-12;
  const auto minimum = minimize(context, (*energy)->objective(), (*energy)->start(), options);
  ASSERT_OK(minimum);
  const std::vector<std::string> remarks = (*energy)->remarks(minimum->x);
  ASSERT_FALSE(remarks.empty());
  EXPECT_THAT(remarks.back(), StartsWith("SHRINKING_CIRCLES: "));
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
