#pragma once

#include <complex>
#include <vector>

#include "core/intrinsic/flat_charts.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// The faces of a flat surface side by side in the plane.
struct PlanarLayout {
  /// The images of corners, each as often as the seams cut it.
  std::vector<std::complex<double>> points;
  std::vector<Index> corner;  ///< Per halfedge h: the point of tail(h) in its face.
  /// The largest distance of what two faces make of an end of an edge that is no seam, in units of
  /// the edge's length (of the mean length, where it is shorter than a millionth of that).
  double closure = 0;
};

/// Unfolds charts face by face across the longest edges first, but across no seam (seams.h): every
/// piece that seams leave has to be a disk, and begins at 0. seam: per edge; boundary edges are
/// seams. O(F log F) for every piece.
PlanarLayout layOut(const Connectivity& surface, const FlatCharts& charts,
                    const std::vector<bool>& seam);

/// Faces that are in place, cut along seams (boundary edges count as such): corners around a vertex
/// are one point as far as no seam comes between them. seam: per edge; placed: per halfedge where
/// its tail is. O(F).
PlanarLayout sewCorners(const Connectivity& surface, const std::vector<bool>& seam,
                        const std::vector<std::complex<double>>& placed);

/// Per face the number of the piece that faces make which are joined by twins; pieces are numbered
/// by their lowest face. twin: per halfedge, kNone where faces are not joined. O(F).
std::vector<Index> piecesOf(const std::vector<Index>& twin);

/// Whether the faces on both sides of halfedge h share the points of its two ends. corner: as in
/// PlanarLayout.
bool isSewn(const Connectivity& surface, const std::vector<Index>& corner, Index h);

}  // namespace moduli
