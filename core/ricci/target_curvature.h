#pragma once

#include <cstdint>
#include <vector>

#include "core/base/status.h"
#include "core/intrinsic/geometry.h"
#include "core/mesh/connectivity.h"

/// The curvatures that a discrete metric is asked for.
namespace moduli {

/// Curvature wanted at a vertex, in radians: 2 pi less the angles around it inside, pi less them on
/// the boundary.
struct Cone {
  Index vertex = 0;
  double curvature = 0;
};

/// What happens to the boundary of a surface.
enum class BoundaryRule : std::uint8_t {
  kStraight,  ///< Curvature 0 where no cone says otherwise.
  kCircle,    ///< Every loop turns evenly, by arc length.
  kFree,      ///< The conformal factor is 1 along the boundary; its curvature is what comes out.
};

/// Whether vertex scaling with flips has a metric of these curvatures on a closed connected
/// surface, or a bordered one by its double: all below 2 pi (pi on the boundary), and with a sum of
/// 2 pi chi in E2, above it in H2. Necessary and sufficient there. Circle packings and fixed
/// triangles have further conditions, one for every set of vertices (MATH 6.8), that only the
/// solver finds out. Fails with kInvalidOption naming the vertex or both sides of the sum that
/// breaks the rule. O(V). Source: MATH 6.8; Gu, Luo, Sun and Wu 2018; Gu, Guo, Luo, Sun and Wu
/// 2018.
Status checkAdmissible(Geometry geometry, const Connectivity& surface,
                       const std::vector<double>& target);

/// The target of a flat metric per vertex: the cones' curvatures, 0 at other inner vertices, and on
/// the boundary what the rule says. kCircle gives each loop the turning -2 pi but the longest,
/// which gets what Gauss and Bonnet leave, and spreads it over the vertices without a cone in
/// proportion to the boundary's length around them. kFree asks for nothing there (the entries mean
/// nothing).
///
/// A sum that misses Gauss and Bonnet by the rounding of typed figures (1e-5 radians a cone) is
/// made exact by equal shares of the cones. lengths: per edge, for kCircle alone.
/// Fails with kInvalidOption: a vertex that does not exist or has two cones, curvatures that are
/// not finite, targets that are not admissible. O(V + F).
Result<std::vector<double>> flatTarget(const Connectivity& surface, const std::vector<Cone>& cones,
                                       BoundaryRule rule, const std::vector<double>& lengths);

}  // namespace moduli
