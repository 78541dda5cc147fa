#pragma once

#include <vector>

#include "core/mesh/connectivity.h"
#include "core/spherical/mobius.h"
#include "core/spherical/point_tree.h"
#include "core/spherical/surface_point.h"

namespace moduli {

/// Finds the spherical triangle that a point of the sphere lies in, and its weights there.
///
///   ASSIGN_OR_RETURN(const SphereLocator locator, SphereLocator::make(surface, map.points));
///   const SurfacePoint there = locator.locate(direction);
///
/// Which side of an edge a point lies on is decided without an error, so that the triangles of a
/// bijective map leave no gap and every direction is in one (on an edge or a vertex: in any of its
/// faces). Refers to the surface, which must live as long; safe to read from several threads.
class SphereLocator {
 public:
  /// points: per vertex, a map to the unit sphere without folds. Fails with kInvalidOption (number
  /// of points), kUnsupportedTopology (not closed) and kFoldedMap naming a face. O(n log n).
  static Result<SphereLocator> make(const Connectivity& surface, Points3 points);

  /// direction: not 0, any length. The weights are >= 0, of sum 1, and their combination of the
  /// corners points in the direction (to rounding over the face's width by its length): it is the
  /// inverse of spherePoint. From the nearest vertex the
  /// search walks from face to face towards the point: O(log n) and a few steps; should the walk
  /// not end, which needs thin triangles that lead in a circle, it looks at all faces.
  SurfacePoint locate(const Eigen::Vector3d& direction) const;

  /// The twin of locate() that looks at all faces and takes the first that holds the point.
  SurfacePoint locateSlowly(const Eigen::Vector3d& direction) const;

  const Connectivity& surface() const { return surface_; }
  const Points3& points() const { return points_; }

 private:
  SphereLocator(const Connectivity& surface, Points3 points)
      : surface_(surface), points_(points), tree_(std::move(points)) {}

  /// Whether the point lies to the left of the edge from corner c, or on it.
  bool isInside(Index face, int c, const Eigen::Vector3d& direction) const;
  SurfacePoint weigh(Index face, const Eigen::Vector3d& direction) const;

  const Connectivity& surface_;
  Points3 points_;
  spherical::PointTree tree_;
};

/// Values at the vertices, carried to a point of a face.
inline double valueAt(const Connectivity& surface, const std::vector<double>& values,
                      const SurfacePoint& point) {
  const Triangle& face = surface.face(point.face);
  return point.barycentric[0] * values[face[0]] + point.barycentric[1] * values[face[1]] +
         point.barycentric[2] * values[face[2]];
}

}  // namespace moduli
