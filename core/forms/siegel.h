#pragma once

#include <Eigen/Core>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/topology/integer_matrix.h"

/// The Siegel upper half-space: complex symmetric Pi = X + i Y with Y > 0, where the conformal
/// structures of surfaces of genus g live.
///
///   ASSIGN_OR_RETURN(const SymplecticProjection projection, projectSymplectic(energy_h));
///   ASSIGN_OR_RETURN(const SiegelReduction reduced, siegelReduce(context, projection.energy));
///   ASSIGN_OR_RETURN(const PeriodPoint point, periodOfEnergy(reduced.energy));
///
/// Energies are 2 g x 2 g Gram matrices of harmonic forms in a basis (alpha_1..g, beta_1..g) of the
/// cohomology with intersection form J = [[0, I], [-I, 0]]. The exact one of a conformal structure
/// is symplectic, E J E = J, and holds its Pi:
///   E = [[Y + X Y^-1 X, -X Y^-1], [-Y^-1 X, Y^-1]],  omega_k = alpha_k + sum_j Pi_kj beta_j.
/// All functions are pure and thread-safe.
namespace moduli {

/// A point of the Siegel upper half-space.
struct PeriodPoint {
  Eigen::MatrixXcd period;  ///< g x g, exactly symmetric, Im > 0.
  /// max |X - X^T| and |Y - Y^T| over the largest entry of X and Y, before they were symmetrized.
  double symmetry_residual = 0;
};

/// Period matrix of an energy form: Y = E_bb^-1, X = -E_ab Y.
/// energy: 2 g x 2 g, symmetric positive definite, symplectic up to the error that is wanted in Pi;
/// project one that is not (projectSymplectic).
/// Fails with kInvalidOption unless it is square of even size > 0, and with kNotPositiveDefinite
/// unless it is finite and positive definite. O(g^3). Source: MATH 4.2.
Result<PeriodPoint> periodOfEnergy(const Eigen::MatrixXd& energy);

/// Energy form of a period matrix, exactly symmetric.
/// period: g x g, symmetric, Im > 0; all entries are NaN where Im is not positive definite. O(g^3).
/// Source: MATH 4.2.
Eigen::MatrixXd energyOfPeriod(const Eigen::MatrixXcd& period);

/// The symplectic energy form in the middle of what is known about the exact one.
struct SymplecticProjection {
  Eigen::MatrixXd energy;  ///< M, exactly symmetric, symplectic to rounding.
  /// delta >= 0: the exact energy E satisfies e^-delta M <= E <= e^delta M (Loewner order), up to
  /// rounding. For the period matrices it follows that
  ///   |Pi(M)_jk - Pi(E)_jk| <= sqrt(Y_jj Y_kk) (e^delta - 1),  Y = Im Pi(M).
  /// Proof: Z = Y^-1/2 (Pi(E) - X) Y^-1/2 is the image of Pi(E) under the symplectic map that
  /// carries Pi(M) to i, and takes M to the identity and E to a form with eigenvalues in
  /// [e^-delta, e^delta]. So W = (Z - i)(Z + i)^-1 has operator norm t <= tanh(delta / 2), and
  /// Z - i = 2 i W (1 - W)^-1 has one of at most 2 t / (1 - t) <= e^delta - 1. Now
  /// |u^T Y^1/2 (Z - i) Y^1/2 v| with u = e_j and v = e_k.
  double spread = 0;
};

/// Symplectic projection M = E_h # (J^T E_h^-1 J), the matrix geometric mean of the upper and the
/// lower bound of the exact energy: J^T E_h^-1 J <= E <= E_h.
/// energy_h: 2 g x 2 g, symmetric positive definite, the energies of closed forms of the classes of
/// a symplectic basis. Equivariant under Sp(2 g, R); the identity on symplectic forms, to rounding;
/// vanishing alpha-beta blocks stay exactly 0. Its spread is log of the largest eigenvalue of
/// M^-1 E_h, 0 if that is below 1.
/// Fails with kInvalidOption unless the size is even and > 0, and with kNotPositiveDefinite unless
/// the matrix is finite and positive definite; kNoConvergence where rounding spoils the mean.
/// Rounding grows by the condition number of the basis. For a skew one, project, reduce
/// (siegelReduce) and project the energies of the reduced basis, congruence(R, energy_h).
/// O(g^3). Source: MATH 4.3, 4.4.
Result<SymplecticProjection> projectSymplectic(const Eigen::MatrixXd& energy_h);

struct SiegelReduction {
  IntegerMatrix transform;  ///< R, 2 g x 2 g, exact and symplectic: R J R^T = J.
  Eigen::MatrixXd energy;   ///< R given R^T, rounded once.
};

/// Siegel reduction: a symplectic basis of the cohomology in which Y is LLL-reduced,
/// |X_jk| <= 1/2 + 1e-12 and |Pi_11| >= 1 - 1e-12.
/// For g = 1 the point of reduceToFundamentalDomain, with its rules for the border. For g > 1 it is
/// not unique: several reduced points may belong to one surface, and ties are left as they are.
/// energy: 2 g x 2 g, symmetric positive definite and symplectic. Rounding does not pile up over
/// the steps, but that of `energy` itself grows by the condition number of R, so that the result
/// for a very skew basis is worth projecting once more. Fails with kInvalidOption unless the size
/// is even and > 0 and the form symplectic, |E J E - J| <= 1e-8 (1 + max |E|^2); with
/// kNotPositiveDefinite unless it is finite and positive definite; with kOverflow where R has
/// entries above 2^63; with kNoConvergence after a thousand rounds; and as context.check(), which
/// is asked in each round. O(g^3) for each of the rounds, of which there are some g. Source:
/// MATH 4.8; Deconinck et al. 2004.
Result<SiegelReduction> siegelReduce(Context& context, const Eigen::MatrixXd& energy);

}  // namespace moduli
