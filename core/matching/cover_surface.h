#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/matching/equivariant_map.h"
#include "core/matching/plane_motion.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/surface_point.h"

/// A surface with handles whose faces are straight triangles of its flat or hyperbolic
/// metric, none folded: what maps to it are made in.
///
///   ASSIGN_OR_RETURN(const CoverSurface cover, straightCover(context, surface, lengths));
///   cover.place({face, {0.2, 0.3, 0.5}});  // in the coordinates of the face
namespace moduli {

/// Every face has coordinates of its own, in which its first corner is 0. Nothing is kept of the
/// universal cover but the changes between neighbours: points far out, which doubles cannot tell
/// apart, occur nowhere.
struct CoverSurface {
  Geometry geometry = Geometry::kHyperbolic;
  Connectivity surface;
  std::vector<double> lengths;  ///< Per edge, as the surface was given.
  std::vector<Eigen::Vector3d>
      corners;  ///< Per halfedge: its tail, in the coordinates of its face.
  /// Per halfedge: from the coordinates of the face beyond it to those of its face. Of a torus pure
  /// shifts. Of no use on a boundary.
  std::vector<Motion> across;
  double area = 0;  ///< In the plane's metric: 2 pi |chi| or, of a torus, 1.
  /// Faces that stood folded in the metric, for which all vertices were moved.
  Index unfolded = 0;

  CoverPlane plane() const { return CoverPlane(geometry); }

  /// A point in the coordinates of its face: the combination of the corners' vectors.
  Eigen::Vector3d place(const SurfacePoint& point) const;
  /// The inverse. place: in the face up to rounding; weights are cut off at 0.
  SurfacePoint pointAt(Index face, const Eigen::Vector3d& place) const;
  /// Weights of the corners' vectors, not normalized; negative outside.
  Eigen::Vector3d weights(Index face, const Eigen::Vector3d& place) const;
};

/// The triangles of a metric without cones; of flat ones scaled to area 1. lengths, angles: per
/// halfedge, angles at its tail; negative ones (folded faces) are taken as they are. given: as
/// CoverSurface::lengths. O(F).
CoverSurface coverOfTriangles(Geometry geometry, const Connectivity& surface,
                              const std::vector<double>& lengths, const std::vector<double>& angles,
                              const std::vector<double>& given);

/// The triangles that vertices see, as large as they see them. links: without folded faces, of
/// degree 1. given: as above. O(F).
CoverSurface coverOfLinks(Geometry geometry, const Connectivity& surface, const VertexLinks& links,
                          const std::vector<double>& given);

/// Uniformizes a closed surface of genus >= 1 and lays its own faces into the metric. Where the
/// straight faces of both kinds of uniformization fold, the vertices are moved within it by the
/// harmonic map of positive weights, under which none does.
///
/// lengths: per edge, positive up to rounding (mollified if need be). Fails with
/// kUnsupportedTopology (other surfaces), kFoldedMap (faces so thin that doubles do not tell), and
/// as uniformize and harmonicMap do. About 8 F. Stages as theirs. Source: MATH 6; Colin de
/// Verdière 1991.
Result<CoverSurface> straightCover(Context& context, const Connectivity& surface,
                                   const std::vector<double>& lengths);

/// Per halfedge: from a frame at its tail, one for each vertex, to the coordinates of its face.
/// O(F).
std::vector<Motion> vertexFrames(const CoverSurface& cover);

/// What vertices see of their neighbours in these frames. O(F).
VertexLinks ownLinks(const CoverSurface& cover, const std::vector<Motion>& frames);

/// Where a straight way through a cover ends.
struct CoverArrival {
  Index face = kNone;
  Eigen::Vector3d place;  ///< In the coordinates of that face.
  Motion motion;          ///< From the coordinates of that face to those where the way began.
};

/// Straight on from a point of a face to a point in its coordinates, both normalized; to what is
/// beyond a boundary not across it. O(faces on the way).
CoverArrival walkStraight(const CoverSurface& cover, Index face, const Eigen::Vector3d& from,
                          const Eigen::Vector3d& to);

}  // namespace moduli
