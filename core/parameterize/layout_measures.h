#pragma once

#include <vector>

#include "core/base/status.h"
#include "core/parameterize/parameterization.h"

namespace moduli {

/// What a layout costs who paints on it.
struct LayoutMeasures {
  Index mapped_faces = 0;  ///< Of those that are returned, pieces of faces counted each.
  Index islands = 0;       ///< Pieces of the image that hang together by its points.
  /// Length, on the surface, of the edges whose two sides have different points, over the root of
  /// the area: no scale changes it.
  double seam_length = 0;
};

/// Measures a map of a surface. lengths: per edge of `surface`, proper triangles. left_out: per
/// face of `surface`, true for faces that are not the user's (they fill holes), or empty; an edge
/// beside one is none of the layout's seams. A map to the sphere has one island and no seams. Faces
/// that were cut count as their pieces. Fails where those make no surface (kNonManifoldEdge and so
/// on, of gluings that no list of faces describes). O(F).
Result<LayoutMeasures> measureLayout(const Connectivity& surface,
                                     const std::vector<double>& lengths,
                                     const Parameterization& map,
                                     const std::vector<bool>& left_out = {});

}  // namespace moduli
