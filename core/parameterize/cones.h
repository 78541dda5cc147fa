#pragma once

#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/parameterization.h"
#include "core/ricci/target_curvature.h"

/// Cones that take the stretching out of a flat metric.
///
///   ASSIGN_OR_RETURN(const ChosenCones chosen, chooseCones(context, surface, lengths, options));
///   FlatOptions flat;
///   flat.cones = chosen.cones;
namespace moduli {

struct ConeOptions {
  /// Enough where the logarithms of the scale differ by no more than this: lengths are stretched by
  /// factors that are at most e^spread apart.
  double spread = 1;
  Index most = 64;  ///< Cones, whatever the spread.
  /// Curvatures are whole multiples of this, radians, 2 pi a whole multiple of it: pi / 2 for
  /// quadrilaterals. Absent: any curvature.
  std::optional<double> quantum = std::nullopt;
  std::optional<int> most_quanta =
      std::nullopt;  ///< Of one cone, either way; 1 for corners of cubes.
};

struct ChosenCones {
  std::vector<Cone> cones;  ///< Ascending by vertex; the sum is 2 pi chi where nothing bounds.
  /// Of the logarithms of the scale, to first order: under the flattest metric without cones (of
  /// constant curvature where there is no flat one), and with the cones.
  double spread_before = 0, spread = 0;
};

/// Cones for a flat metric of little area distortion on a connected surface. Greedily, where the
/// logarithm of the scale is farthest out: where it is 0 at all cones, each has the curvature that
/// a random walk from everywhere ends with there (harmonic measure), and every further cone takes
/// away the largest and the smallest value. All of it by the linear equation L u = K' - K on the
/// Delaunay triangulation of the metric. Quanta are rounded by largest remainders; of the sets of
/// cones found on the way, the one whose rounding spreads least is taken.
///
/// A boundary is taken to be free (u = 0 there, BoundaryRule::kFree) and cones lie inside.
/// lengths: per edge, positive up to rounding. Fails with kInvalidOption (spread not positive, a
/// quantum that does not divide 2 pi; fewer cones or quanta than Gauss and Bonnet ask for, in one
/// sentence), kUnsupportedTopology (several components), and as SpdSolver does. One factorization,
/// and one back-substitution a cone. Source: Ben-Chen, Gotsman, Bunin 2008; MATH 6.4.
Result<ChosenCones> chooseCones(Context& context, const Connectivity& surface,
                                const std::vector<double>& lengths, const ConeOptions& options);

/// Tells in a flat map how its cones were chosen, with a warning CONE_SPREAD where they do not take
/// out as much as was asked for.
void tellChoice(const ChosenCones& chosen, const ConeOptions& wanted, Parameterization& map);

}  // namespace moduli
