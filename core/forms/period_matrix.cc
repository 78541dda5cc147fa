#include "core/forms/period_matrix.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/forms/cotan.h"
#include "core/forms/harmonic.h"
#include "core/forms/lattice_reduction.h"
#include "core/forms/siegel.h"
#include "core/topology/symplectic_cohomology.h"

namespace moduli {
namespace {

double riemannResidual(const Eigen::MatrixXcd& period, const Eigen::MatrixXd& energy) {
  const Eigen::Index g = period.rows();
  Eigen::MatrixXcd forms(g, 2 * g);  // zeta = alpha + Pi beta.
  forms << Eigen::MatrixXcd::Identity(g, g), period;
  const Eigen::MatrixXcd half = forms * energy * forms.adjoint() / 2;
  double worst = 0;
  for (Eigen::Index j = 0; j < g; ++j) {
    for (Eigen::Index k = 0; k < g; ++k) {
      worst = std::max(worst, std::abs(half(j, k) - period(j, k).imag()) /
                                  std::sqrt(period(j, j).imag() * period(k, k).imag()));
    }
  }
  return worst;
}

bool isIdentity(const IntegerMatrix& matrix) {
  return matrix == IntegerMatrix::Identity(matrix.rows(), matrix.cols());
}

/// The change to a basis that is reduced by `energy`, the energy of the given one.
Result<IntegerMatrix> reducingChange(Context& context, const Eigen::MatrixXd& energy) {
  ASSIGN_OR_RETURN(const SymplecticProjection projection, projectSymplectic(energy));
  ASSIGN_OR_RETURN(SiegelReduction reduced, siegelReduce(context, projection.energy));
  return std::move(reduced.transform);
}

/// Energies of the forms in a basis that they themselves call reduced: there, nothing cancels.
Result<EnergyForm> reducedEnergy(Context& context, const Connectivity& surface,
                                 const std::vector<double>& lengths, FormBasis& forms) {
  // The second round finds nothing to do, unless rounding spoiled the first of a very long basis.
  constexpr int kRounds = 5;
  EnergyForm form = energyForm(surface, lengths, forms);
  for (int round = 0; round < kRounds; ++round) {
    ASSIGN_OR_RETURN(const IntegerMatrix change, reducingChange(context, form.energy));
    if (isIdentity(change)) break;
    ASSIGN_OR_RETURN(forms, changeBasis(std::move(forms), change));
    form = energyForm(surface, lengths, forms);
  }
  return form;
}

}  // namespace

double relativeRounding(const EnergyForm& form) {
  // With d_a the root of entry (a, a) and C the matrix over d_a d_b: rounding changes x^T E x by at
  // most r (sum |x_a| d_a)^2 <= r k sum x_a^2 d_a^2 <= r k / (least eigenvalue of C) x^T E x.
  const Eigen::VectorXd scale = form.energy.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * form.energy * scale.asDiagonal();
  const double least =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlation, Eigen::EigenvaluesOnly)
          .eigenvalues()[0];
  if (!(least > 0)) return std::numeric_limits<double>::infinity();
  return form.rounding * static_cast<double>(form.energy.rows()) / least;
}

Result<PeriodMatrix> certifyPeriods(const Eigen::MatrixXd& energy, double rounding) {
  ASSIGN_OR_RETURN(SymplecticProjection projection, projectSymplectic(energy));
  ASSIGN_OR_RETURN(PeriodPoint point, periodOfEnergy(projection.energy));
  PeriodMatrix result;
  // An upper bound too small by 1 - r, and the lower one that follows too large by as much, move
  // the ends of the interval around M apart by that factor.
  result.spread = projection.spread + std::log1p(rounding);
  result.error = point.period.imag().diagonal().maxCoeff() * std::expm1(result.spread);
  result.riemann_residual = riemannResidual(point.period, energy);
  result.symmetry_residual = point.symmetry_residual;
  result.period = std::move(point.period);
  result.energy = std::move(projection.energy);
  if (std::isfinite(result.error) && std::isfinite(result.riemann_residual)) return result;
  return Status{Reason::kResidualTooLarge, "rounding has drowned the energy of the harmonic forms",
                "the triangles or the surface are too thin for double precision"};
}

Result<PeriodMatrix> certifyReducedPeriods(Context& context, const Eigen::MatrixXd& energy,
                                           double rounding) {
  ASSIGN_OR_RETURN(const SymplecticProjection projection, projectSymplectic(energy));
  ASSIGN_OR_RETURN(const SiegelReduction reduced, siegelReduce(context, projection.energy));
  return certifyPeriods(congruence(reduced.transform, energy), rounding);
}

Result<ClosedPeriods> computePeriods(Context& context, const Connectivity& surface,
                                     const std::vector<double>& given_lengths) {
  ASSIGN_OR_RETURN(const std::vector<Cochain> cochains, [&] {
    const Context::Stage stage(context, "cohomology");
    return symplecticCohomology(surface);
  }());
  if (cochains.empty()) {
    return Status{Reason::kUnsupportedTopology,
                  "a closed surface of genus 0 has no periods: all spheres are conformally one"};
  }
  RETURN_IF_ERROR(context.check());
  const std::vector<double> lengths = unitLengths(given_lengths);
  const std::vector<double> weights = cotanWeights(surface, lengths);
  ASSIGN_OR_RETURN(HarmonicForms harmonic, harmonicForms(context, surface, weights, cochains));

  const Context::Stage stage(context, "period");
  ClosedPeriods result;
  result.solver_residual = harmonic.solver_residual;
  // A first reduction by the fluxes, which cost nothing; where needles drown them, there is none.
  FormBasis& forms = harmonic.forms;
  const auto change = reducingChange(context, fluxEnergy(surface, weights, cochains, forms));
  if (change.ok()) {
    ASSIGN_OR_RETURN(forms, changeBasis(std::move(forms), *change));
  }
  RETURN_IF_ERROR(context.check());
  ASSIGN_OR_RETURN(const EnergyForm form, reducedEnergy(context, surface, lengths, forms));
  ASSIGN_OR_RETURN(result.periods, certifyPeriods(form.energy, relativeRounding(form)));
  result.energy = form.energy;
  result.harmonic = std::move(forms);
  return result;
}

}  // namespace moduli
