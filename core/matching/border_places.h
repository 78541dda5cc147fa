#pragma once

#include <optional>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/spherical/surface_point.h"

/// Points of boundaries, and how far along these they are.
namespace moduli {

/// A point of a boundary: at fraction t, from 0 at its tail to less than 1, of a halfedge there.
struct BorderPoint {
  Index halfedge = kNone;
  double t = 0;

  SurfacePoint point() const { return edgePoint(halfedge, t); }
};

/// A point of a surface as one of its boundary, where it is one up to rounding. O(1).
std::optional<BorderPoint> borderPointAt(const Connectivity& surface, const SurfacePoint& point);

/// The boundary loops of a surface, numbered as computeTopology does. Refers to nothing; safe to
/// read from several threads.
class BorderPlaces {
 public:
  /// O(F).
  explicit BorderPlaces(const TriangleMesh& mesh);

  const std::vector<std::vector<Index>>& loops() const { return loops_; }
  Index loopOf(Index halfedge) const { return loop_[halfedge]; }
  /// Of a boundary halfedge within its loop.
  Index numberOf(Index halfedge) const { return number_[halfedge]; }
  double length(Index loop) const { return lengths_[loop]; }
  /// How far along its loop a halfedge's tail is.
  double start(Index halfedge) const { return starts_[halfedge]; }
  /// The share of its loop's length before a point, in [0, 1).
  double shareAt(const BorderPoint& point) const;

 private:
  std::vector<std::vector<Index>> loops_;
  std::vector<Index> loop_, number_;  ///< Per halfedge; kNone off the boundary.
  std::vector<double> starts_, edges_;
  std::vector<double> lengths_;
};

}  // namespace moduli
