#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/parameterization.h"

/// Tori in the plane.
namespace moduli {

struct TorusOptions {
  bool initial_delaunay =
      true;            ///< As in PrescribeOptions; the other way is tried where this folds.
  bool refine = true;  ///< Cut faces that fold.
};

/// Finds the flat metric in the discrete conformal class of a closed surface of genus 1 and lays
/// its faces into the plane, cut along two short closed walks that meet at one vertex: a
/// fundamental domain of the lattice `torus.generators`, of whole faces, close to the
/// parallelogram that they span. Opposite sides are translates to the last bits; no face is turned
/// over, and none lies on another or on a translate of it. lengths: per edge, positive up to
/// rounding (mollified if need be).
///
/// The certificate's holonomy_residual is the largest distance of a face's side from what the
/// lattice makes of it. Fails with kUnsupportedTopology (other surfaces), kFoldedMap (with `refine`
/// where limbs are thinner than doubles tell apart), kResidualTooLarge, and as uniformize does.
/// About 8 F. Stages "delaunay", "analyse", "factorize", "solve", "metric", "refine", "layout".
/// Source: MATH 3, 6.
Result<Parameterization> parameterizeTorus(Context& context, const Connectivity& surface,
                                           const std::vector<double>& lengths,
                                           const TorusOptions& options);

/// The lattice vectors m a + n b, as pairs (m, n), that may carry an image into the rectangle
/// between two corners: what tiles a picture. points: of the image, one at least. Ordered by n,
/// then m. O(points + translates).
std::vector<std::array<int, 2>> tilesOf(const TorusDomain& torus,
                                        const std::vector<std::complex<double>>& points,
                                        std::complex<double> lower, std::complex<double> upper);

}  // namespace moduli
