#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/forms/form_basis.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// A period matrix with its certificate. The exact matrix that the bounds speak of is the one of
/// the discrete metric itself, not of a smooth surface that it may approximate.
struct PeriodMatrix {
  /// Pi, g x g, exactly symmetric, Im Pi > 0, Siegel-reduced (core/forms/siegel.h).
  Eigen::MatrixXcd period;
  /// |Pi_jk - exact| <= error for all j and k, the exact matrix taken in the same marking.
  double error = 0;
  /// M, 2 g x 2 g: the symplectic energy form in the marking of Pi. Its lattice (Z^2g, M) is the
  /// same for all markings.
  Eigen::MatrixXd energy;
  /// delta: e^-delta n^T M n <= exact energy of the class n <= e^delta n^T M n. Rounding included.
  double spread = 0;
  double symmetry_residual = 0;  ///< Of Pi, relative, before it was symmetrized.
  /// max over j, k of |<zeta_j, zeta_k> / 2 - Y_jk| / sqrt(Y_jj Y_kk), where <,> is the inner
  /// product of the forms and Y_jk = (i / 2) int zeta_j ^ conj zeta_k: 0 for holomorphic forms.
  double riemann_residual = 0;
};

/// What rounding may do to an energy form as a whole: the exact one lies between (1 - r) and
/// (1 + r) times `form`, in the Loewner order. Infinite where the form is not positive definite.
/// O(k^3).
double relativeRounding(const EnergyForm& form);

/// The period matrix that the energies of closed forms in a symplectic basis certify. energy: 2 g x
/// 2 g; rounding: its relativeRounding. The marking is kept. Fails as projectSymplectic.
/// O(g^3). Source: MATH 4.2 to 4.4.
Result<PeriodMatrix> certifyPeriods(const Eigen::MatrixXd& energy, double rounding);

/// The same in a Siegel-reduced marking. Fails as siegelReduce too.
Result<PeriodMatrix> certifyReducedPeriods(Context& context, const Eigen::MatrixXd& energy,
                                           double rounding);

/// The periods of a closed surface, with the forms that have them.
struct ClosedPeriods {
  PeriodMatrix periods;
  FormBasis harmonic;          ///< alpha_1 .. alpha_g, beta_1 .. beta_g, in the marking of Pi.
  Eigen::MatrixXd energy;      ///< E_h: their inner products. exact <= E_h (Loewner).
  double solver_residual = 0;  ///< The largest that the linear solver left, relative.
};

/// Period matrix of a closed connected surface of genus g >= 1 under a metric (lengths per edge,
/// proper triangles). Exact to rounding on flat tori and on surfaces with enough symmetry, O(h^2)
/// for smooth ones, and in all cases within the printed bounds, which come from E_h alone:
/// J^T E_h^-1 J <= E <= E_h.
/// Fails with kUnsupportedTopology (boundary, several components; genus 0, which has no periods),
/// as SpdSolver does, with kOverflow, and with kNotPositiveDefinite or kNoConvergence where the
/// surface is too thin for double precision. One factorization, 2 g back-substitutions, O(F g^2).
/// Stages "cohomology", "period" and those of SpdSolver. Source: MATH 4.
Result<ClosedPeriods> computePeriods(Context& context, const Connectivity& surface,
                                     const std::vector<double>& lengths);

}  // namespace moduli
