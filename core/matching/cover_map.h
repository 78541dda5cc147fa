#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/matching/cover_surface.h"

/// Maps from a triangulated surface to a cover, up to homotopy and vertex by vertex.
namespace moduli {

/// Where the vertices of a surface A go on a CoverSurface B, and how its edges wind.
///
/// A triangle i, j, k of A runs counter-clockwise where the determinant of places[i],
/// transitions[ij] places[j], transitions[ik] places[k] is positive.
struct CoverMap {
  std::vector<SurfacePoint> images;     ///< Per vertex of A, in B.
  std::vector<Eigen::Vector3d> places;  ///< The same in the coordinates of the images' faces.
  /// Per halfedge of A: from the coordinates of the face of its head's image to those of its
  /// tail's. Inverse for twins; their product around a face of A is 1.
  std::vector<Motion> transitions;
};

/// The corners of a face of A in the coordinates of the face of the first one's image. O(1).
std::array<Eigen::Vector3d, 3> cornersOf(const Connectivity& surface, const CoverMap& map,
                                         Index face);

/// What vertices see of their neighbours, from frames that are their faces' coordinates shifted to
/// the vertex. O(E).
VertexLinks linksOf(const Connectivity& surface, const CoverSurface& cover, const CoverMap& map);

/// The map after all vertices have moved straight on in their frames: HarmonicMap::moves. O(V
/// steps).
CoverMap moved(const Connectivity& surface, const CoverSurface& cover, const CoverMap& map,
               const std::vector<Motion>& moves);

/// Whether a face is turned over or flat, by the sign of the determinant of the vectors as they are
/// rounded, from the image of the first corner.
bool isFolded(const Connectivity& surface, const CoverMap& map, Index face);

/// How many are. O(F).
Index countFolded(const Connectivity& surface, const CoverMap& map);

}  // namespace moduli
