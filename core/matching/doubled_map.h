#pragma once

#include <vector>

#include "core/matching/boundary_map.h"
#include "core/matching/cover_map.h"
#include "core/mesh/double_cover.h"

/// Maps of surfaces with boundary as maps of their doubles that commute with both reflections.
///
/// The cover is that of B's double; its first copy is numbered as B.
namespace moduli {

/// Per halfedge of A, of use on the boundary: the transition from the coordinates of the face of
/// its head's image to those of its tail's, along the boundary of B. O(steps).
std::vector<Motion> boundaryTransitions(const Connectivity& surface, const Connectivity& b,
                                        const CoverSurface& cover, const BoundaryMap& boundary);

/// half: images, places and transitions of A alone, boundary vertices being where `boundary` has
/// them. Gives the map of A's double whose mirror does in the mirror of B what A does in B. O(V+F).
CoverMap doubledMap(const Connectivity& surface, const DoubleCover& surface_double,
                    const CoverSurface& cover, const BoundaryMap& boundary, const CoverMap& half);

/// The point of the first copy that is the same or its mirror image. faces: of one copy. O(1).
SurfacePoint foldedBack(const SurfacePoint& point, Index faces);

/// The nearest point of the boundary to one of a face that is on it up to rounding. O(1).
SurfacePoint ontoBoundary(const Connectivity& surface, const SurfacePoint& point);

}  // namespace moduli
