#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"

/// Closed and harmonic 1-forms on closed surfaces of any genus.
namespace moduli {

/// The closed form cochain + d potential. Its class is the cochain's and its values are exact
/// differences: whatever the rounding of the potential, it stays closed.
struct ClosedForm {
  std::vector<double> cochain;    ///< Per edge, along its direction; closed, whole numbers.
  std::vector<double> potential;  ///< Per vertex.

  /// The value along an edge's direction.
  double onEdge(const Connectivity& surface, Index e) const {
    const Index h = surface.halfedge(e);
    return cochain[e] + (potential[surface.head(h)] - potential[surface.tail(h)]);
  }
};

/// a x + b y for whole numbers a and b.
ClosedForm combine(double a, const ClosedForm& x, double b, const ClosedForm& y);

struct HarmonicForms {
  std::vector<ClosedForm> forms;  ///< One per cochain: the harmonic form of its class.
  double solver_residual = 0;     ///< The largest that the linear solver left, relative.
};

/// The harmonic forms of the classes of closed integer cochains: cochain + d f with L f = -d0^T W
/// cochain. surface: closed and connected; weights: cotanWeights. Fails as SpdSolver does. One
/// factorization, all right-hand sides together. Stages as SpdSolver. Source: MATH 3, 4.1.
Result<HarmonicForms> harmonicForms(Context& context, const Connectivity& surface,
                                    const std::vector<double>& weights,
                                    const std::vector<std::vector<int>>& cochains);

struct EnergyForm {
  /// k x k: the inner products of the forms, each face's an integral over its flat triangle.
  Eigen::MatrixXd energy;
  /// Bound of the rounding error of entry (a, b) over sqrt(energy(a, a) energy(b, b)), the lengths
  /// and potentials being exact.
  double rounding = 0;
};

/// Inner products of closed forms under a metric (lengths per edge, proper triangles), summed as
/// squares face by face: no cancellation between the huge weights of needles. By the Dirichlet
/// principle they are upper bounds for the classes, however badly the potentials were solved for.
/// O(F k^2). Source: MATH 0 (the integral of the inner product of closed cochains).
EnergyForm energyForm(const Connectivity& surface, const std::vector<double>& lengths,
                      const std::vector<ClosedForm>& forms);

}  // namespace moduli
