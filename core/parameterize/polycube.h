#pragma once

#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/packing.h"
#include "core/parameterize/parameterization.h"

/// Surfaces as surfaces of cubes.
namespace moduli {

/// Where three quadrilaterals of a surface of cubes meet (convex, +1, curvature pi / 2), or five
/// (concave, -1, curvature -pi / 2).
struct PolycubeCorner {
  Index vertex = 0;
  int sign = 1;
};

struct PolycubeOptions {
  /// Empty: found by chooseCones with quanta of pi / 2, one a corner.
  std::vector<PolycubeCorner> corners;
  /// Of corners that are found: as ConeOptions.
  double spread = 1;
  /// Absent: 48, or a quarter more than Gauss and Bonnet ask for, whichever is more.
  std::optional<Index> most_corners = std::nullopt;
  bool initial_delaunay = true;  ///< As in FlatOptions, like the rest.
  bool refine = true;
  bool cut_overlaps = true;
  double margin = kIslandMargin;
  std::vector<bool> seams;
};

/// Finds the discrete conformal metric of a closed connected surface that is flat but for corners
/// of pi / 2 and -pi / 2, and lays it out, cut through the corners: what the surface of a
/// PolyCube is. The result's `cones` holds the corners and how directions turn around handles:
/// that has to be a multiple of pi / 2 for squares to close up, and is not for most choices of
/// corners on a surface of genus >= 1; where it is not, the residual is reported
/// (certificate.holonomy_residual) with a warning HANDLES_TURN, and the metric is only one with
/// cones. Moving corners moves it, but from vertex to vertex only: quads.h closes up exactly.
///
/// Fails with kUnsupportedTopology (other surfaces), kInvalidOption (a sign that is not +-1, a sum
/// of signs that breaks Gauss and Bonnet: 4 chi, which is 8 on a sphere; a vertex that does not
/// exist or has two corners), and as chooseCones and parameterizeFlat do. About 8 F.
/// Source: MATH 10; Wang, He, Li, Gu, Qin 2007.
Result<Parameterization> parameterizePolycube(Context& context, const Connectivity& surface,
                                              const std::vector<double>& lengths,
                                              const PolycubeOptions& options);

}  // namespace moduli
