#pragma once

#include <vector>

#include "core/hyperbolic/developing.h"
#include "core/ricci/discrete_metric.h"

namespace moduli {

/// The faces that a triangulation had before its flips, each with the straight edges between its
/// corners that the hyperbolic metric has past the same vertices.
struct StraightFaces {
  Connectivity surface;         ///< Before all flips.
  std::vector<double> lengths;  ///< Per halfedge; twins have the same.
  /// Per halfedge, at its tail: all three of a face negative where the metric turns it over.
  std::vector<double> angles;

  /// Or without area, up to rounding: a face with two sides on a straight boundary.
  bool isFolded(Index face) const {
    constexpr double kFlat = 1e-11;
    const double* angle = &angles[3 * face];
    return !(angle[0] > kFlat && angle[1] > kFlat && angle[2] > kFlat);
  }
};

/// By undoFlips, whatever kind of flip was done. Where no face is folded, they triangulate the
/// surface; around an inner vertex the angles then add up to 2 pi. O(F + flips).
StraightFaces straightFaces(const DiscreteMetric& metric);

/// Per boundary loop of a surface, in the order of computeTopology. lengths: per halfedge of it, or
/// of its double.
std::vector<double> boundaryLengths(const Connectivity& surface,
                                    const std::vector<double>& lengths);

}  // namespace moduli
