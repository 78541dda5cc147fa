#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/overlaps.h"
#include "core/parameterize/parameterization.h"
#include "core/ricci/scheme.h"
#include "core/ricci/target_curvature.h"

/// Flat metrics with prescribed curvature, laid out in the plane.
namespace moduli {

struct FlatOptions {
  std::vector<Cone> cones;  ///< All other interior vertices are flat.
  BoundaryRule boundary = BoundaryRule::kFree;
  Scheme scheme = Scheme::kVertexScaling;
  RicciSolver solver = RicciSolver::kNewton;
  /// Isometric Delaunay flips first (vertex scaling only); the other way is tried where this folds.
  bool initial_delaunay = true;
  bool refine = true;             ///< Cut faces that fold (vertex scaling only).
  bool cut_overlaps = true;       ///< Cut the layout further where it lies on itself.
  double margin = kIslandMargin;  ///< Between islands that were cut apart, as cutOverlaps has it.
  /// Per edge: whether to cut along it in any case. Empty: none. What is missing to lay the surface
  /// out is chosen (seams.h).
  std::vector<bool> seams;
};

/// Finds the discrete conformal metric that is flat but for the given cones and lays it out, cut
/// along short seams through them (chooseSeams), scaled to the area of the surface. Around the
/// cones the plane may be covered several times: such a layout is cut into islands that lie side by
/// side (cutOverlaps). lengths: per edge, positive up to rounding (mollified if need be).
///
/// Fails with kInvalidOption (a negative margin; a cone's vertex does not exist or is named twice;
/// a curvature of 2 pi or more inside, of pi or more on the boundary; a sum that breaks Gauss and
/// Bonnet: the message says by how much), kNoConvergence where a scheme with fixed triangles has no
/// such metric (the hint names vertex scaling, which has), kFoldedMap naming how many faces fold,
/// and as the solvers do. About 8 F. Stages "delaunay", "analyse", "factorize", "solve", "metric",
/// "refine", "layout".
Result<Parameterization> parameterizeFlat(Context& context, const Connectivity& surface,
                                          const std::vector<double>& lengths,
                                          const FlatOptions& options);

}  // namespace moduli
