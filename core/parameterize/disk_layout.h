#pragma once

#include <vector>

#include "core/hyperbolic/developing.h"

namespace moduli {

/// A hyperbolic surface cut open in the disk: a polygon whose copies fill the plane (of a surface
/// with a boundary, the part between the copies of that).
struct DiskLayout {
  /// The images of corners, each as often as the cuts divide it.
  std::vector<Complex> points;
  std::vector<Index> corner;  ///< Per halfedge h: the point of tail(h) in its face.
  /// The deck transformations that carry the polygon to its copies beyond the cuts; the inverse of
  /// each is among them.
  std::vector<Su11> neighbours;
  /// The largest distance of what two faces make of an end of an edge that is not cut, in lengths
  /// of the edge.
  double closure = 0;
  double radius = 0;  ///< The largest distance of a point from 0.
};

/// Sews the placed faces of a layout together along all edges but those that a cut graph needs.
/// surface: closed, or with a boundary. O(F + cut edges * neighbours).
DiskLayout sewUp(const HyperbolicTriangles& triangles, const Development& development);

}  // namespace moduli
