#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/forms/form_basis.h"
#include "core/mesh/connectivity.h"
#include "core/topology/symplectic_cohomology.h"

/// Harmonic 1-forms: of every cohomology class the form of least energy.
namespace moduli {

struct HarmonicForms {
  FormBasis forms;             ///< One per cochain: the harmonic form of its class.
  double solver_residual = 0;  ///< The largest that the linear solver left, relative.
};

/// The harmonic forms of the classes of closed integer cochains: cochain + d f with L f = -d0^T W
/// cochain. surface: connected; with boundary the forms are those of H^1(M; R), tangential to the
/// boundary (Neumann). weights: cotanWeights. Fails as SpdSolver does. One factorization, and one
/// back-substitution a cochain, eight at a time. Stages as SpdSolver. Source: MATH 3, 4.1.
Result<HarmonicForms> harmonicForms(Context& context, const Connectivity& surface,
                                    const std::vector<double>& weights,
                                    const std::vector<Cochain>& cochains);

/// The inner products of harmonic forms with each other by their fluxes through the seam: equal to
/// energyForm's up to the solver's residual and the cancellation of large weights, in no time.
/// cochains: those of the forms. Symmetrized. Source: MATH 4.1 (<h, eta + d f> = <h, eta>).
Eigen::MatrixXd fluxEnergy(const Connectivity& surface, const std::vector<double>& weights,
                           const std::vector<Cochain>& cochains, const FormBasis& forms);

/// The functions that are harmonic but at fixed vertices, where they have given values. fixed: per
/// vertex, one at least; values: V x k, read at fixed vertices and kept there. Elsewhere on the
/// boundary their normal derivative is 0. surface: connected. Fails as SpdSolver does. One
/// factorization.
Result<RowMajorMatrix> harmonicFunctions(Context& context, const Connectivity& surface,
                                         const std::vector<double>& weights,
                                         const std::vector<bool>& fixed, RowMajorMatrix values);

/// The harmonic forms of a surface with boundary.
struct BorderedForms {
  /// Tangential to the boundary: the classes of the handles alpha, beta and of the loops gamma.
  FormBasis tangential;
  /// Normal to the boundary (Dirichlet): the classes of the handles in H^1(M, dM), and the
  /// differentials of the harmonic functions u_k, 1 on loop k = 1 .. b - 1 and 0 on the others.
  FormBasis normal;
  double solver_residual = 0;
};

/// surface: connected, with boundary; cohomology: its borderedCohomology; boundary_loops: those of
/// computeTopology. Two factorizations of one symbolic analysis. Fails as SpdSolver does. Source:
/// MATH 5.3.
Result<BorderedForms> borderedHarmonicForms(Context& context, const Connectivity& surface,
                                            const std::vector<double>& weights,
                                            const BorderedCohomology& cohomology,
                                            const std::vector<std::vector<Index>>& boundary_loops);

}  // namespace moduli
