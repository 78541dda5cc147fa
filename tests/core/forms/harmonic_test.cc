#include "core/forms/harmonic.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "core/forms/cotan.h"
#include "core/mesh/samples.h"
#include "core/topology/tree_cotree.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

MetricSurface genusTwo() {
  const auto soup = makeSample("genus", {{"genus", 2}, {"resolution", 4}, {"seed", 3}});
  return fromPositions(soup->vertices, soup->faces);
}

struct Basis {
  std::vector<std::vector<int>> cochains;
  HarmonicForms harmonic;
};

Result<Basis> harmonicBasis(const MetricSurface& mesh) {
  ASSIGN_OR_RETURN(const TreeCotree trees, computeTreeCotree(mesh.surface));
  Basis basis{cohomologyBasis(mesh.surface, trees), {}};
  Context context;
  ASSIGN_OR_RETURN(basis.harmonic,
                   harmonicForms(context, mesh.surface, cotanWeights(mesh.surface, mesh.lengths),
                                 basis.cochains));
  return basis;
}

TEST(HarmonicForms, AreClosedAndCoclosedInTheirClass) {
  for (const MetricSurface& mesh : {torusOfRevolution(2, 1, 30, 17), genusTwo()}) {
    const Connectivity& surface = mesh.surface;
    const auto weights = cotanWeights(surface, mesh.lengths);
    const auto basis = harmonicBasis(mesh);
    ASSERT_OK(basis);
    EXPECT_LT(basis->harmonic.solver_residual, 1e-15);
    for (const ClosedForm& form : basis->harmonic.forms) {
      for (Index h = 0; h < surface.halfedgeCount(); h += 3) {
        double around = 0;
        for (Index k = h; k < h + 3; ++k) {
          around += surface.sign(k) * form.onEdge(surface, surface.edge(k));
        }
        EXPECT_NEAR(around, 0, 1e-14);
      }
      Eigen::VectorXd divergence = Eigen::VectorXd::Zero(surface.vertexCount());
      for (Index e = 0; e < surface.edgeCount(); ++e) {
        const double flow = weights[e] * form.onEdge(surface, e);
        divergence[surface.tail(surface.halfedge(e))] -= flow;
        divergence[surface.head(surface.halfedge(e))] += flow;
      }
      EXPECT_LT(divergence.cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

TEST(EnergyForm, EqualsTheCotanSumOnOrdinaryMeshes) {
  const MetricSurface mesh = genusTwo();
  const auto weights = cotanWeights(mesh.surface, mesh.lengths);
  const auto basis = harmonicBasis(mesh);
  ASSERT_OK(basis);
  const auto& forms = basis->harmonic.forms;
  const EnergyForm form = energyForm(mesh.surface, mesh.lengths, forms);
  for (std::size_t a = 0; a < forms.size(); ++a) {
    for (std::size_t b = 0; b < forms.size(); ++b) {
      double sum = 0;
      for (Index e = 0; e < mesh.surface.edgeCount(); ++e) {
        sum += weights[e] * forms[a].onEdge(mesh.surface, e) * forms[b].onEdge(mesh.surface, e);
      }
      const auto i = static_cast<Eigen::Index>(a);
      const auto j = static_cast<Eigen::Index>(b);
      EXPECT_NEAR(form.energy(i, j), sum, 1e-12);
    }
  }
  EXPECT_GT(form.rounding, 1e-16);
  EXPECT_LT(form.rounding, 1e-12);
}

/// E_h bounds the energies of the polyhedral surface from above, and with the intersection matrix J
/// it bounds them from below: J E_h^-1 J^T <= E <= E_h (MATH 4.3). The gap closes under refinement.
TEST(EnergyForm, BoundsItselfFromBothSidesOnGenusTwo) {
  double before = std::numeric_limits<double>::infinity();
  for (const int n : {1, 2}) {
    const MetricSurface mesh = subdivide(genusTwo(), n);
    const auto basis = harmonicBasis(mesh);
    ASSERT_OK(basis);
    ASSERT_EQ(basis->cochains.size(), 4U);
    Eigen::Matrix4d J;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        J(a, b) = static_cast<double>(
            intersectionNumber(mesh.surface, basis->cochains[a], basis->cochains[b]));
      }
    }
    EXPECT_NEAR(J.determinant(), 1, 1e-12);
    const Eigen::Matrix4d E = energyForm(mesh.surface, mesh.lengths, basis->harmonic.forms).energy;
    const Eigen::Matrix4d gap = E - J * E.inverse() * J.transpose();
    const Eigen::Vector4d values =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(gap).eigenvalues();
    EXPECT_GT(values[0], -1e-12);
    EXPECT_GT(E.determinant(), 1);
    EXPECT_LT(E.determinant() - 1, 0.5 * before);
    before = E.determinant() - 1;
  }
}

TEST(EnergyForm, AnyFormOfTheClassHasMoreEnergy) {
  const MetricSurface mesh = torusOfRevolution(2, 1, 12, 9);
  const auto basis = harmonicBasis(mesh);
  ASSERT_OK(basis);
  const ClosedForm& harmonic = basis->harmonic.forms[0];
  ClosedForm other = harmonic;
  std::mt19937 random(1);
  for (double& value : other.potential) value += 0.01 * uniform(random);
  EXPECT_GT(energyForm(mesh.surface, mesh.lengths, {other}).energy(0, 0),
            energyForm(mesh.surface, mesh.lengths, {harmonic}).energy(0, 0));
}

TEST(ClosedForms, CombineLinearly) {
  const MetricSurface mesh = torusOfRevolution(2, 1, 12, 9);
  const auto basis = harmonicBasis(mesh);
  ASSERT_OK(basis);
  const auto& [x, y] = std::pair(basis->harmonic.forms[0], basis->harmonic.forms[1]);
  const ClosedForm sum = combine(3, x, -2, y);
  for (Index e = 0; e < mesh.surface.edgeCount(); ++e) {
    EXPECT_NEAR(sum.onEdge(mesh.surface, e),
                3 * x.onEdge(mesh.surface, e) - 2 * y.onEdge(mesh.surface, e), 1e-14);
  }
}

}  // namespace
}  // namespace moduli
