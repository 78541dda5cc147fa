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
  std::vector<Cochain> cochains;
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
    const FormBasis& forms = basis->harmonic.forms;
    for (Eigen::Index a = 0; a < forms.count(); ++a) {
      for (Index h = 0; h < surface.halfedgeCount(); h += 3) {
        double around = 0;
        for (Index k = h; k < h + 3; ++k) around += forms.along(surface, k, a);
        EXPECT_NEAR(around, 0, 1e-14);
      }
      Eigen::VectorXd divergence = Eigen::VectorXd::Zero(surface.vertexCount());
      for (Index e = 0; e < surface.edgeCount(); ++e) {
        const Index h = surface.halfedge(e);
        const double flow = weights[e] * forms.along(surface, h, a);
        divergence[surface.tail(h)] -= flow;
        divergence[surface.head(h)] += flow;
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
  for (Eigen::Index a = 0; a < forms.count(); ++a) {
    for (Eigen::Index b = 0; b < forms.count(); ++b) {
      double sum = 0;
      for (Index e = 0; e < mesh.surface.edgeCount(); ++e) {
        const Index h = mesh.surface.halfedge(e);
        sum += weights[e] * forms.along(mesh.surface, h, a) * forms.along(mesh.surface, h, b);
      }
      EXPECT_NEAR(form.energy(a, b), sum, 1e-12);
    }
  }
  const Eigen::MatrixXd flux = fluxEnergy(mesh.surface, weights, basis->cochains, forms);
  EXPECT_LT((form.energy - flux).cwiseAbs().maxCoeff(), 1e-12);
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
    const Eigen::Matrix4d J =
        intersectionMatrix(mesh.surface, basis->cochains, basis->cochains).cast<double>();
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
  FormBasis other = basis->harmonic.forms;
  std::mt19937 random(1);
  for (double& value : other.potential.reshaped()) value += 0.01 * uniform(random);
  const Eigen::MatrixXd least =
      energyForm(mesh.surface, mesh.lengths, basis->harmonic.forms).energy;
  const Eigen::MatrixXd more = energyForm(mesh.surface, mesh.lengths, other).energy;
  EXPECT_GT(more(0, 0), least(0, 0));
  EXPECT_GT(more(1, 1), least(1, 1));
}

TEST(FormBasis, ChangesLinearly) {
  const MetricSurface mesh = torusOfRevolution(2, 1, 12, 9);
  const auto basis = harmonicBasis(mesh);
  ASSERT_OK(basis);
  const FormBasis& forms = basis->harmonic.forms;
  IntegerMatrix change(3, 2);
  change << 3, -2, 0, 1, -7, 5;
  const auto changed = changeBasis(forms, change);
  ASSERT_OK(changed);
  ASSERT_EQ(changed->count(), 3);
  for (Index h = 0; h < mesh.surface.halfedgeCount(); ++h) {
    for (Eigen::Index a = 0; a < 3; ++a) {
      const double sum = static_cast<double>(change(a, 0)) * forms.along(mesh.surface, h, 0) +
                         static_cast<double>(change(a, 1)) * forms.along(mesh.surface, h, 1);
      EXPECT_NEAR(changed->along(mesh.surface, h, a), sum, 1e-13);
    }
  }
  change(0, 0) = Integer{1} << 60;
  EXPECT_THAT(changeBasis(forms, change), FailsWith(Reason::kOverflow));
}

/// Many forms, more faces than one block holds, on any number of threads: the same as one by one.
TEST(EnergyForm, OfManyFormsEqualsThatOfPairs) {
  const MetricSurface mesh = subdivide(genusTwo(), 3);
  const auto basis = harmonicBasis(mesh);
  ASSERT_OK(basis);
  const FormBasis& forms = basis->harmonic.forms;
  const Eigen::MatrixXd all = energyForm(mesh.surface, mesh.lengths, forms).energy;
  for (Eigen::Index a = 0; a < forms.count(); ++a) {
    for (Eigen::Index b = 0; b < forms.count(); ++b) {
      IntegerMatrix pick = IntegerMatrix::Zero(2, forms.count());
      pick(0, a) = 1;
      pick(1, b) = 1;
      const auto pair = changeBasis(forms, pick);
      ASSERT_OK(pair);
      const EnergyForm form = energyForm(mesh.surface, mesh.lengths, *pair);
      EXPECT_NEAR(form.energy(0, 1), all(a, b), 1e-12);
    }
  }
}

}  // namespace
}  // namespace moduli
