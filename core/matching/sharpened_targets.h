#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/target_links.h"
#include "core/mesh/triangle_mesh.h"
#include "core/spherical/surface_point.h"

namespace moduli {

struct SharpTargets {
  std::vector<SurfacePoint> vertices;  ///< Per vertex.
  EdgeWays ways;                       ///< Where three points of every edge go.
};

/// Targets of a near isometry, made sharper than the modes tell them: where limbs are thinner than
/// the shortest wave, targets mistake one side for the other. The vertices within a radius of each
/// vertex are moved rigidly as near to their targets as can be, and the vertex gets the nearest
/// point there of `b` that looks the same way; a few times, and again with half the radius, down to
/// a few edges. Areas are made equal.
///
/// targets: per vertex of `a`, on `b`. Fails with kCancelled and kDeadlineExceeded. O(V times the
/// vertices within 0.2 roots of the area), which are kept. Stage: "sharpen". Source: Kabsch 1976;
/// Besl and McKay 1992 (nearest points).
Result<SharpTargets> sharpenTargets(Context& context, const TriangleMesh& a, const TriangleMesh& b,
                                    const std::vector<SurfacePoint>& targets);

}  // namespace moduli
