#pragma once

#include <vector>

#include "core/intrinsic/geometry.h"
#include "core/intrinsic/intrinsic_triangulation.h"
#include "core/linalg/spd_solver.h"

namespace moduli {

/// Where the entries of a matrix over the edges of a triangulation stand.
///
/// Entries of edges with the same two unknowns share a place, edges within one unknown stand on the
/// diagonal, unknowns of kNone have none.
class EdgePattern {
 public:
  /// unknown: per vertex, below `count`, or kNone. O(E).
  void build(const IntrinsicTriangulation& triangulation, const std::vector<Index>& unknown,
             Index count);

  /// Fills in the Hessian of the Ricci energy of vertex scaling (scaled_face.h), 0 where unknowns
  /// have no faces. half_tangents: per halfedge the tangent of half the angle at its tail; faces
  /// with angles of 0 are left out, as broken ones and those at infinity. half_chords: per
  /// halfedge, scaled. Both of the triangulation and the unknowns last built for. O(F).
  void fillHessian(Geometry geometry, const IntrinsicTriangulation& triangulation,
                   const std::vector<Index>& unknown, const std::vector<double>& half_tangents,
                   const std::vector<double>& half_chords);

  /// The matrix: lower triangle, every diagonal entry stored. Values are the caller's.
  SparseMatrix& matrix() { return matrix_; }
  /// The place among valuePtr() of the entry of halfedge h between two different unknowns; kNone
  /// where an end has none or both ends share one.
  Index slot(Index h) const { return slot_[h]; }
  /// The place of an unknown's diagonal entry.
  Index diagonal(Index unknown) const { return matrix_.outerIndexPtr()[unknown]; }

 private:
  SparseMatrix matrix_;
  std::vector<Index> slot_;
};

}  // namespace moduli
