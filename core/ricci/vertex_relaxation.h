#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/intrinsic/geometry.h"
#include "core/intrinsic/intrinsic_triangulation.h"

namespace moduli {

/// Solves for the curvature of one vertex at a time, by its own factor alone and with flips around
/// it: the nonlinear Gauss-Seidel step of the Ricci energy.
///
/// Two vertices at a small distance d, in units of their neighbours' distances, tie their factors
/// together: the energy turns within |u_i - u_j| < d, and a Newton step from outside sees nothing
/// of it. One such step for each of them leads inside, where Newton's method keeps them together.
class VertexRelaxation {
 public:
  /// scale: e^{u / 2} per vertex, kept up to date; the triangulation is Delaunay under it.
  /// Both are changed by solve() and belong to the caller.
  VertexRelaxation(Geometry geometry, IntrinsicTriangulation& triangulation,
                   std::vector<double>& scale);

  /// Changes the factor of these vertices (one orbit) until the sum of their curvatures is `target`
  /// up to `tolerance`, radians. Returns what is added to u; 0 where no change up to kMaxChange
  /// reaches it. Some 10 to 40 looks at the faces around. Fails as flipToDelaunayPtolemy does.
  Result<double> solve(Context& context, const std::vector<Index>& vertices, double target,
                       double tolerance);

 private:
  Result<double> excessAt(Context& context, const std::vector<Index>& vertices, double change,
                          double target);
  double curvature(Index v) const;
  void noteFlips(std::size_t since);
  template <typename Visit>
  void aroundVertex(Index v, const Visit& visit) const;

  Geometry geometry_;
  IntrinsicTriangulation& triangulation_;
  std::vector<double>& scale_;
  std::vector<Index> outgoing_;  ///< Per vertex a halfedge from it.
  std::vector<double> start_;    ///< Scales of the vertices at hand before the change.
};

}  // namespace moduli
