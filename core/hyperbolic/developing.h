#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/hyperbolic/su11.h"
#include "core/intrinsic/intrinsic_surface.h"
#include "core/ricci/discrete_metric.h"

/// Laying out a hyperbolic surface face by face in its universal cover, the disk.
///
///   ASSIGN_OR_RETURN(const HyperbolicTriangles triangles, hyperbolicTriangles(metric));
///   ASSIGN_OR_RETURN(const Development development, develop(context, triangles));
///   imageOf(development.placed[f] * cornerFrame(triangles, 3 * f + c), 0.0);  // corner c of face
///   f
///
/// Every face has coordinates of its own, in which its first corner is 0 and its first side runs
/// along the positive real axis. What is kept are changes between the coordinates of neighbours,
/// which are of the size of the faces, and where the layout puts each face's coordinates; points
/// far out in the disk, which doubles cannot tell apart, occur nowhere. Source: MATH 7.1, 7.2.
namespace moduli {

/// A surface made of hyperbolic triangles, its vertices without cones; closed, but for develop()
/// and holonomy().
struct HyperbolicTriangles {
  Connectivity surface;
  std::vector<double> lengths;  ///< Per halfedge.
  std::vector<double> angles;   ///< Per halfedge, at its tail.
};

/// What a hyperbolic metric consists of in the end. Fails with kUnsupportedTopology where it is not
/// of genus 2 or more and closed, with kInvalidMetric where its geometry is another. O(F).
Result<HyperbolicTriangles> hyperbolicTriangles(const DiscreteMetric& metric);
/// The same of a surface that is given hyperbolic; kInvalidMetric also where the angles at a vertex
/// do not add up to 2 pi to 1e-9.
Result<HyperbolicTriangles> hyperbolicTriangles(const IntrinsicSurface& surface);

/// In the coordinates of the face of h: from 0 and the real axis to tail(h) and the direction of h.
Su11 cornerFrame(const HyperbolicTriangles& triangles, Index h);

/// What judges a layout.
struct DevelopmentCertificate {
  double determinant_drift = 0;  ///< max | |a|^2 - |b|^2 - 1 | over changes of coordinates.
  /// How far the frame of a face's last corner, reached along its third side, is from that reached
  /// along the first two: whether sides and angles belong together. The largest of all faces.
  double face_residual = 0;
  /// How far the product of the changes around a vertex is from +-1, the largest of all vertices.
  double vertex_residual = 0;
  double radius = 0;  ///< The largest distance of a placed face's centre from that of the root.
};

struct Development {
  /// Per halfedge h: from the coordinates of the face beyond h to those of the face of h. Exact
  /// inverses for twins; the identity on the boundary.
  std::vector<Su11> crossing;
  std::vector<Su11> placed;  ///< Per face: from its coordinates to the disk.
  std::vector<Index> entry;  ///< Per face the halfedge of it through which the layout came.
  Index root = 0;            ///< Its centre is 0, and its entry is kNone.
  DevelopmentCertificate certificate;
};

struct DevelopOptions {
  Index root = kNone;   ///< kNone: a face from which the others are not far.
  int candidates = 24;  ///< That are tried then.
};

/// Lays out the surface from the root in the order of the distances of the faces' centres in the
/// disk: nearly the Dirichlet domain of the root, so that nothing is put further away than it must
/// be. The root is that of findCentralFace. Fails with kResidualTooLarge where a residual is 1e-6
/// or more, and as the context does. O(F log F).
Result<Development> develop(Context& context, const HyperbolicTriangles& triangles,
                            const DevelopOptions& options = {});

/// What a closed walk along edges does to the plane: the product of the changes of coordinates on
/// its left side, in those of the face of its first halfedge. Its translation length is that of the
/// closed geodesic into which the walk can be moved. loop: halfedges, each from the head of the
/// one before, the first from that of the last. O(n d) for vertices of degree d.
Su11 holonomy(const Connectivity& surface, const Development& development,
              const std::vector<Index>& loop);

}  // namespace moduli
