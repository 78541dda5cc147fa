#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/connectivity.h"
#include "core/topology/cochain.h"

namespace moduli {

template <typename Scalar>
using RowMajor = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using RowMajorMatrix = RowMajor<double>;

/// k closed forms on one surface, each a whole-number cochain plus the differential of a function,
/// or a combination of such. Their values are exact differences: whatever the rounding of the
/// functions, they are closed. The cochains live on the few edges of a seam, most of which share
/// their k values with others.
template <typename Scalar>
struct ClosedForms {
  RowMajor<Scalar> potential;  ///< V x k.
  std::vector<Index> seam;     ///< Per edge its row of `jumps`; kNone where all cochains are 0.
  RowMajor<Scalar> jumps;      ///< Values of the cochains, along the directions of the edges.

  Eigen::Index count() const { return potential.cols(); }

  /// The value of form a along halfedge h.
  Scalar along(const Connectivity& surface, Index h, Eigen::Index a) const {
    const Scalar difference = potential(surface.head(h), a) - potential(surface.tail(h), a);
    const Index row = seam[surface.edge(h)];
    if (row == kNone) return difference;
    return static_cast<double>(surface.sign(h)) * jumps(row, a) + difference;
  }
};

/// Real forms whose cochains have whole values.
using FormBasis = ClosedForms<double>;

/// Forms without potentials: the cochains themselves. O(E + n log n) for n terms in all.
FormBasis cochainForms(const Connectivity& surface, const std::vector<Cochain>& cochains);

/// The forms sum_k transform(a, k) form_k. Fails with kOverflow where a jump leaves the whole
/// numbers that doubles hold. O(V k^2).
Result<FormBasis> changeBasis(FormBasis forms, const IntegerMatrix& transform);

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
/// The same bytes for any number of threads. O(F k^2). Source: MATH 0 (the integral of the inner
/// product of closed cochains).
EnergyForm energyForm(const Connectivity& surface, const std::vector<double>& lengths,
                      const FormBasis& forms);

}  // namespace moduli
