#pragma once

#include <vector>

#include "core/mesh/connectivity.h"
#include "core/spherical/landmark_map.h"
#include "core/spherical/surface_point.h"

/// Landmarks from curves, such as sulci: points at equal shares of their length.
namespace moduli {

/// Points of a curve at shares i / (count - 1) of its length from its first vertex to its last, or
/// i / count along a closed curve, whose last vertex is joined to its first.
/// lengths: per edge. path: vertices, each joined to the next by an edge (of several the shortest).
/// count: at least 2 (closed: 1). Fails with kInvalidOption, naming the vertex, where the path
/// leaves the surface, stands still or has no edge to follow. O(path times degree + count).
Result<std::vector<SurfacePoint>> resampleCurve(const Connectivity& surface,
                                                const std::vector<double>& lengths,
                                                const std::vector<Index>& path, int count,
                                                bool closed = false);

/// A curve on surface A and the one that it corresponds to on surface B, in the same direction
/// (closed: from the same vertex on).
struct CurvePair {
  std::vector<Index> path_a, path_b;
  int count = 2;
  bool closed = false;
};

/// A surface as curves see it. Refers to its parts.
struct MeasuredSurface {
  const Connectivity& surface;
  const std::vector<double>& lengths;  ///< Per edge.
};

/// Landmarks of surface A whose targets are where a map to the sphere has the points of surface B
/// at the same share of length, curve after curve. points_b: per vertex of B. Where curves end at a
/// common vertex on both surfaces the landmark comes once. Fails as resampleCurve does, saying
/// which curve of which surface.
Result<std::vector<Landmark>> curveLandmarks(const MeasuredSurface& a, const MeasuredSurface& b,
                                             const Points3& points_b,
                                             const std::vector<CurvePair>& curves);

}  // namespace moduli
