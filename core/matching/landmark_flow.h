#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/cover_map.h"
#include "core/matching/landmark_goals.h"

namespace moduli {

struct LandmarkFlow {
  CoverMap map;     ///< No face folded, however far the landmarks came.
  bool met = true;  ///< To 1e-7 of the edges there.
  /// The landmark, or the two, around the face that folded first where they were not met.
  std::vector<std::size_t> around;
  int steps = 0;
};

/// Lets a map follow a smooth motion of the cover that carries the landmarks to their targets, each
/// by the shortest way: in small steps all vertices near landmarks move by combinations of kernels
/// around these, chosen so that the landmarks, also those within faces, move as they should. Such a
/// motion is one to one; only where triangles are too large for it do faces fold. It stops before
/// any does or, partly, lets the landmark nearest to the fold stay where it is, and takes the
/// others on.
///
/// A kernel reaches six times as far as its landmark travels, or as others would take it along, and
/// at least over three of its edges, but nowhere around a handle. map: without folded faces. Fails
/// with kCancelled and kDeadlineExceeded. Stage "landmarks". O(steps (F + vertices reached (log V +
/// landmarks) + landmarks^3)). Source: the kernels of Wendland 1995; Joshi and Miller 2000
/// (matching landmarks by flows); MATH 9.4.
Result<LandmarkFlow> flowToLandmarks(Context& context, const Connectivity& surface,
                                     const CoverSurface& cover, const CoverMap& map,
                                     const std::vector<CoverLandmark>& landmarks,
                                     bool partly = false);

/// The same for maps of surfaces with boundary to half of b's double, the boundary on the geodesics
/// that b's is: on the double of A every landmark has its mirror image, and so has the motion,
/// which then keeps the boundary there. Landmarks on the boundary have targets on it.
Result<LandmarkFlow> flowToLandmarks(Context& context, const Connectivity& surface,
                                     const TriangleMesh& b, const CoverSurface& cover,
                                     const CoverMap& map,
                                     const std::vector<CoverLandmark>& landmarks,
                                     bool partly = false);

}  // namespace moduli
