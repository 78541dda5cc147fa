#pragma once

#include <complex>
#include <string>
#include <vector>

#include "core/intrinsic/flat_charts.h"
#include "core/mesh/connectivity.h"
#include "core/ricci/target_curvature.h"

/// Charts of a flat surface with cones whose changes are motions of the plane.
namespace moduli {

/// z -> turn z + shift, |turn| = 1.
struct PlaneMotion {
  std::complex<double> turn = 1, shift = 0;
  std::complex<double> operator()(std::complex<double> z) const { return turn * z + shift; }
  /// First the other.
  PlaneMotion operator*(const PlaneMotion& first) const {
    return {turn * first.turn, turn * first.shift + shift};
  }
};

/// One chart a vertex: its star, unfolded around it, the vertex at 0 and its first neighbour
/// (along outgoing(v)) on the positive real axis. Cones ("extraordinary points") have none. The
/// charts of two neighbours overlap in the two faces beside their edge, and change by one motion.
struct AffineAtlas {
  Connectivity surface;                     ///< Closed; the faces.
  std::vector<Cone> cones;                  ///< The extraordinary points.
  std::vector<bool> has_chart;              ///< Per vertex.
  std::vector<std::complex<double>> spoke;  ///< Per halfedge: its head in the chart of its tail.
  /// Per halfedge whose ends both have charts: from the chart of its tail to that of its head.
  std::vector<PlaneMotion> transition;
  /// Largest distance of a corner of two charts' common faces from where the transition puts it, in
  /// lengths of the longest edge there; and of the product of the three transitions around a face
  /// from the identity, its shift in the same unit.
  double overlap_residual = 0, cocycle_residual = 0;
};

/// surface: closed; charts: of its faces, none turned over, flat but for the cones. O(F).
AffineAtlas atlasOfCharts(const Connectivity& surface, const FlatCharts& charts,
                          const std::vector<Cone>& cones);

/// The atlas as JSON, a line for each chart and each transition:
///
///   {"format": "moduli-affine-atlas", "version": 1,
///    "vertices": 530,
///    "faces": [[0, 1, 2], ...],               vertices counter-clockwise, counted from 0
///    "extraordinary": [{"vertex": 7, "curvature": -12.566370614359172}],
///    "charts": [{"vertex": 0, "neighbours": [4, 9, ...], "points": [[0.1, 0], ...]}, ...],
///    "transitions": [{"from": 0, "to": 4, "angle": 0.3, "translation": [0.1, 0.2]}, ...],
///    "overlap_residual": 1e-15, "cocycle_residual": 2e-15}
///
/// A chart is the star of its vertex, which lies at [0, 0]: its neighbours counter-clockwise, and
/// where they lie; its faces are the triangles of the vertex and two neighbours in a row. A point z
/// of the chart `from` within a face beside the edge is e^(i angle) z + translation in the chart
/// `to`; each edge occurs once, and the way back is the inverse. Extraordinary points have no
/// chart, and edges at them no transition. Angles are radians in (-pi, pi]. Numbers are the
/// shortest decimals that read back as the same doubles. O(F).
std::string writeAtlasJson(const AffineAtlas& atlas);

/// The same with other numbers for its vertices. number: per vertex of the atlas's surface,
/// distinct; vertices: what that key says. O(F).
std::string writeAtlasJson(const AffineAtlas& atlas, const std::vector<Index>& number,
                           Index vertices);

}  // namespace moduli
