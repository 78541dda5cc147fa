#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/matching/cover_map.h"
#include "core/mesh/triangle_mesh.h"

namespace moduli {

/// A point of A and where on the cover it is to go.
struct CoverLandmark {
  SurfacePoint point, target;
  std::string name = {};  ///< For messages.
};

/// Per landmark where it is to go, as the frame that linksOf has at the first corner of its face
/// sees it: by the shortest way. map: without folded faces. O(landmarks V log V).
std::vector<Eigen::Vector3d> nearestGoals(const Connectivity& surface, const CoverSurface& cover,
                                          const CoverMap& map,
                                          const std::vector<CoverLandmark>& landmarks);

/// The same for maps to half of b's double: landmarks on the boundary go along it, all of one loop
/// so that they keep their order, where their targets do, and the sum of their ways is least; the
/// others by the shortest ways through b. Landmarks of the boundary have targets there. O(landmarks
/// V log V + boundary).
std::vector<Eigen::Vector3d> nearestGoals(const Connectivity& surface, const TriangleMesh& b,
                                          const CoverSurface& cover, const CoverMap& map,
                                          const std::vector<CoverLandmark>& landmarks);

}  // namespace moduli
