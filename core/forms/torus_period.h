#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/forms/modular.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// The conformal structure of a closed genus-1 surface.
struct TorusPeriod {
  Complex tau;  ///< Reduced to the fundamental domain of SL(2, Z).
  /// Certified: |tau - exact| <= tau_error up to the modular group, where exact belongs to the
  /// given discrete metric itself (not to a smooth surface that it may approximate). Rounding is
  /// included, so it is never 0.
  double tau_error = 0;
  Eigen::Matrix2d energy;      ///< Symplectic energy form in the marking of tau: see PeriodMatrix.
  double spread = 0;           ///< Certified, relative: see PeriodMatrix.
  double determinant_gap = 0;  ///< det E_h - 1 >= 0 of the harmonic forms, 0 on flat tori.
  /// Area-form check of the holomorphic form: | |zeta|^2 / 2 - Im tau | / Im tau.
  double riemann_residual = 0;
  /// The holomorphic form as a complex number per edge, along the edge's direction. Its periods
  /// are 1 and `tau`.
  std::vector<Complex> holomorphic;
  double closure_residual =
      0;  ///< Largest |sum of the form around a face| / mean |form on an edge|.
};

/// Period of a closed connected genus-1 surface from its metric (lengths per edge, proper
/// triangles). tau by the symplectic projection of the harmonic energy; error from 1 <= det E_h:
/// d_H(tau, exact) <= log(det E_h) / 2. Exact to rounding on flat tori, O(h^2) on smooth ones.
/// Fails with kUnsupportedTopology (other genus, boundary, several components), as SpdSolver does,
/// and as computePeriods where the torus is too thin for double precision. One factorization and
/// two right-hand sides. Stages as computePeriods. Source: MATH 3.
Result<TorusPeriod> computeTorusPeriod(Context& context, const Connectivity& surface,
                                       const std::vector<double>& lengths);

/// Layout of the holomorphic form: per corner (halfedge's tail) a complex coordinate; adjacent
/// faces agree up to the lattice 1, tau. Used for the plane-wave transform and for pictures. O(F).
std::vector<Complex> layOutTorus(const Connectivity& surface, const TorusPeriod& period);

}  // namespace moduli
