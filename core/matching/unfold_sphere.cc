#include "core/matching/unfold_sphere.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/matching/ring_mesh.h"
#include "core/matching/thinning.h"
#include "core/spherical/exact_sign.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

/// Steps towards the middle of the kernel.
constexpr int kSteps = 64;
/// Halvings of the way from where the vertex was to the middle, and from a neighbour.
constexpr int kHalvings = 40;

bool isInKernel(const std::vector<Index>& ring, const Points3& points, const Vector3d& p) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector3d &a = points[ring[i]], &b = points[ring[(i + 1) % ring.size()]];
    if (spherical::orientationSign(p, a, b) <= 0) return false;
  }
  return true;
}

/// A point with room on all sides, by steps away from the side that is worst; not in the kernel
/// where that is thin.
Vector3d middleOf(const std::vector<Index>& ring, const Points3& points, Vector3d p) {
  std::vector<Vector3d> sides;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    sides.push_back(points[ring[i]].cross(points[ring[(i + 1) % ring.size()]]).stableNormalized());
  }
  double width = 0;
  for (const Index v : ring) width = std::max(width, (points[v] - p).norm());
  for (int step = 1; step <= kSteps; ++step) {
    const Vector3d* worst = &sides.front();
    for (const Vector3d& side : sides) {
      if (side.dot(p) < worst->dot(p)) worst = &side;
    }
    p = (p + width / (step + 1) * *worst).normalized();
  }
  return p;
}

/// A place in the kernel of a ring: `old` if it is there, else between it and the middle, else
/// beside `neighbour`, which is on the kernel's edge.
std::optional<Vector3d> placeIn(const std::vector<Index>& ring, const Points3& points,
                                const Vector3d& old, Index neighbour) {
  if (isInKernel(ring, points, old)) return old;
  Vector3d mean = Vector3d::Zero();
  for (const Index v : ring) mean += points[v];
  mean.normalize();
  const Vector3d middle = middleOf(ring, points, mean);
  // Half of the way that is needed, and as much again.
  for (const double share : {0.25, 0.5, 0.75, 1.0}) {
    const Vector3d p = (old + share * (middle - old)).normalized();
    if (isInKernel(ring, points, p)) return p;
  }
  for (const Vector3d& towards : {middle, mean}) {
    for (double share = 0.5; share > std::ldexp(1.0, -kHalvings); share /= 2) {
      const Vector3d p = (points[neighbour] + share * (towards - points[neighbour])).normalized();
      if (isInKernel(ring, points, p)) return p;
    }
  }
  return {};
}

/// The same on the equator, between the neighbours there: `old`, the middle, or beside `neighbour`.
std::optional<Vector3d> placeOnRim(const RingMesh& mesh, Index v, const Points3& points,
                                   Index neighbour) {
  const std::vector<Index>& ring = mesh.ring(v);
  if (isInKernel(ring, points, points[v])) return points[v];
  for (const Index other : ring) {
    if (other == neighbour || !mesh.isRim(other)) continue;
    for (double share = 0.5; share > std::ldexp(1.0, -kHalvings); share /= 2) {
      // Of height 0, as both are.
      const Vector3d p =
          (points[neighbour] + share * (points[other] - points[neighbour])).normalized();
      if (isInKernel(ring, points, p)) return p;
    }
  }
  return {};
}

}  // namespace

Result<Points3> unfoldSphere(Context& context, const TriangleMesh& mesh, Points3 points,
                             Index pole) {
  RETURN_IF_ERROR(context.check());
  ASSIGN_OR_RETURN(RingMesh rings, RingMesh::make(mesh.connectivity(), pole));
  const FaceRule rule = [&](Index a, Index b, Index c) {
    return spherical::orientationSign(points[a], points[b], points[c]) > 0;
  };
  const Status folded(Reason::kFoldedMap, "the map to the sphere folds too many faces",
                      "remesh the surface with fewer thin triangles");
  if (!thinUntil(rings, mesh.positions(), rule)) return folded;
  while (rings.vertexCount() < mesh.vertexCount()) {
    const RingMesh::Collapse last = rings.restore();
    const std::optional<Vector3d> place =
        rings.isRim(last.removed)
            ? placeOnRim(rings, last.removed, points, last.kept)
            : placeIn(rings.ring(last.removed), points, points[last.removed], last.kept);
    if (!place) return folded;
    points[last.removed] = *place;
  }
  return points;
}

}  // namespace moduli
