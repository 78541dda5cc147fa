#pragma once

#include <vector>

#include "core/intrinsic/geometry.h"
#include "core/intrinsic/intrinsic_triangulation.h"

namespace moduli {

/// Triangles of a plane of constant curvature, per halfedge.
struct SignedTriangles {
  std::vector<double> lengths;  ///< Twins have the same.
  /// At the tail, in (-pi, pi]: all three of a face negative where it is turned over.
  std::vector<double> angles;
};

/// Undoes the flips of a triangulation and carries its triangles along: the faces that it had at
/// first get the straight edges between their corners in the metric, past the same vertices,
/// whatever kind of flip was done. Faces that the metric turns over come out with negative angles.
///
/// A loop around vertices without a cone can be shrunk to a point; its length is then 0 up to
/// rounding, and its direction any, but one that angles keep, so that later edges are not turned
/// about that point. triangulation: a copy that loses its history; spherical lengths below pi.
/// O(flips).
SignedTriangles undoFlips(Geometry geometry, IntrinsicTriangulation triangulation,
                          SignedTriangles triangles);

}  // namespace moduli
