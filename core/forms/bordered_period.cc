#include "core/forms/bordered_period.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/forms/cotan.h"
#include "core/forms/harmonic.h"
#include "core/topology/surface_topology.h"
#include "core/topology/symplectic_cohomology.h"

namespace moduli {
namespace {

Status checkTopology(const SurfaceTopology& topology) {
  if (topology.components != 1) {
    return {Reason::kUnsupportedTopology,
            "the surface has " + std::to_string(topology.components) + " components instead of 1"};
  }
  if (topology.boundary_loops.empty()) {
    return {Reason::kUnsupportedTopology, "the surface has no boundary"};
  }
  if (topology.genus == 0 && topology.boundary_loops.size() == 1) {
    return {Reason::kUnsupportedTopology, "a disk has no moduli: all disks are conformally one"};
  }
  return {};
}

/// Energy form of the double in a symplectic basis.
///
/// Cochains x on the surface live on the double in three ways: x on the first copy and 0 on the
/// second (x', where x vanishes on the boundary), the other way round (x''), and on both (x+). The
/// second copy has the opposite orientation, so that int alpha'' ^ beta'' = -1. With the functions
/// u_k and int gamma_i ^ du_k = -delta_ik, a symplectic basis is
///   alpha', beta'', gamma+   and   beta', alpha'', -du'.
/// The reflection splits forms into even and odd halves, on the surface: x' into x/2 and x/2, x''
/// into x/2 and -x/2, x+ into x and 0. Even halves are tangential to the boundary, odd ones normal,
/// both on two copies. The even half of du' is exact.
Eigen::MatrixXd doubleEnergy(Eigen::Index genus, const Eigen::MatrixXd& tangential,
                             const Eigen::MatrixXd& normal) {
  const Eigen::Index handles = 2 * genus;
  const Eigen::Index loops = tangential.rows() - handles;
  const Eigen::Index half = handles + loops;
  // Rows of the double's basis in terms of (alpha, beta, gamma) and of (alpha, beta, du).
  Eigen::MatrixXd even = Eigen::MatrixXd::Zero(2 * half, half);
  Eigen::MatrixXd odd = even;
  for (Eigen::Index i = 0; i < genus; ++i) {
    const Eigen::Index alpha = i;
    const Eigen::Index beta = genus + i;
    even(i, alpha) = odd(i, alpha) = 0.5;
    even(half + i, beta) = odd(half + i, beta) = 0.5;
    even(genus + i, beta) = even(half + genus + i, alpha) = 0.5;
    odd(genus + i, beta) = odd(half + genus + i, alpha) = -0.5;
  }
  for (Eigen::Index k = handles; k < half; ++k) {
    even(k, k) = 1;
    odd(half + k, k) = -0.5;
  }
  return 2 * (even * tangential * even.transpose() + odd * normal * odd.transpose());
}

/// The exact modulus lies between the reciprocal energy of du and the energy of gamma.
BoundedNumber annulusModulus(double tangential, double normal, double rounding) {
  const double error = 1 + rounding;
  return {std::sqrt(tangential / normal), 1 / (normal * error), tangential * error};
}

}  // namespace

Result<BorderedPeriods> computeBorderedPeriods(Context& context, const Connectivity& surface,
                                               const std::vector<double>& given_lengths) {
  const SurfaceTopology topology = computeTopology(surface);
  RETURN_IF_ERROR(checkTopology(topology));
  const std::vector<std::vector<Index>>& loops = topology.boundary_loops;
  ASSIGN_OR_RETURN(const BorderedCohomology cohomology, [&] {
    const Context::Stage stage(context, "cohomology");
    return borderedCohomology(surface, loops);
  }());
  RETURN_IF_ERROR(context.check());
  const std::vector<double> lengths = unitLengths(given_lengths);
  ASSIGN_OR_RETURN(
      const BorderedForms forms,
      borderedHarmonicForms(context, surface, cotanWeights(surface, lengths), cohomology, loops));
  const Context::Stage stage(context, "period");
  const EnergyForm tangential = energyForm(surface, lengths, forms.tangential);
  const EnergyForm normal = energyForm(surface, lengths, forms.normal);
  const double rounding = std::max(relativeRounding(tangential), relativeRounding(normal));
  BorderedPeriods result;
  result.solver_residual = forms.solver_residual;
  ASSIGN_OR_RETURN(
      result.periods,
      certifyReducedPeriods(context, doubleEnergy(topology.genus, tangential.energy, normal.energy),
                            rounding));
  const auto others = static_cast<Eigen::Index>(loops.size()) - 1;
  result.capacity = normal.energy.bottomRightCorner(others, others);
  if (topology.genus == 0 && others == 1) {
    result.modulus = annulusModulus(tangential.energy(0, 0), normal.energy(0, 0), rounding);
  }
  return result;
}

}  // namespace moduli
