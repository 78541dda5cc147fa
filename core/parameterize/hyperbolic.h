#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/parameterization.h"

namespace moduli {

struct HyperbolicOptions {
  bool initial_delaunay =
      true;            ///< As in PrescribeOptions; the other way is tried where this folds.
  bool refine = true;  ///< Cut faces that no map of the given ones keeps from folding.
};

/// Finds the metric of curvature -1 in the discrete conformal class of a surface, for which its
/// boundary is geodesic, and lays the surface, cut open, into the Poincaré disk. Closed surfaces
/// also get the generators of their group, in the same coordinates; all get their shortest closed
/// geodesics and those on their boundary. lengths: per edge, positive up to rounding (mollified if
/// need be).
///
/// The image is nearly the Dirichlet domain of a face in the middle of the surface, whose centre is
/// at 0; a different start and order of faces cut it otherwise. Corners of an uncut edge have one
/// image. Where the group or the geodesics cannot be had (thin collars, genus beyond some 20), the
/// rest stands, with a warning GEODESICS_OMITTED.
///
/// Fails with kUnsupportedTopology on a surface that is not connected or whose Euler characteristic
/// is not negative (the message says what it is, the hint which target serves), kFoldedMap naming
/// how many faces fold (with `refine` where thin needles still do after some rounds of cutting),
/// kResidualTooLarge, and as uniformize does. About 8 F and
/// the search for geodesics. Source: MATH 6, 7.
Result<Parameterization> parameterizeHyperbolic(Context& context, const Connectivity& surface,
                                                const std::vector<double>& lengths,
                                                const HyperbolicOptions& options);

}  // namespace moduli
