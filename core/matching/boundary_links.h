#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/matching/boundary_map.h"
#include "core/matching/cover_map.h"

/// What maps of surfaces with boundary have beside others. The cover is that of the double of B,
/// whose first copy is numbered as B; there the boundary is made of geodesics.
namespace moduli {

/// The boundary edge of B after another one.
struct BorderStep {
  Index halfedge = kNone;
  Motion motion;  ///< From the coordinates of its face to those of the other one's.
};

/// O(degree of the vertex between).
BorderStep nextOnBorder(const Connectivity& b, const CoverSurface& cover, Index halfedge);

/// Per halfedge of A, of use on the boundary: the transition from the coordinates of the face of
/// its head's image to those of its tail's, along the boundary of B. O(steps).
std::vector<Motion> boundaryTransitions(const Connectivity& surface, const Connectivity& b,
                                        const CoverSurface& cover, const BoundaryMap& boundary);

/// Per vertex of A the direction of the boundary, of length 1, from the frame that linksOf has at
/// it; 0 inside. map: has the boundary where `boundary` does. O(V).
std::vector<Eigen::Vector2d> boundaryDirections(const CoverSurface& cover,
                                                const BoundaryMap& boundary, const CoverMap& map);

/// The same of a map without folded faces, by its links alone: where the neighbour along the
/// boundary is that is farther away. O(F).
std::vector<Eigen::Vector2d> boundaryDirections(const Connectivity& surface,
                                                const CoverPlane& plane, const VertexLinks& links);

/// The point of the first copy that is the same or its mirror image. faces: of one copy. O(1).
SurfacePoint foldedBack(const SurfacePoint& point, Index faces);

/// The nearest point of the boundary to one of a face that is on it up to rounding. O(1).
SurfacePoint ontoBoundary(const Connectivity& surface, const SurfacePoint& point);

}  // namespace moduli
