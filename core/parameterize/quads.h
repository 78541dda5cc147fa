#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/parameterization.h"

/// Quadrilaterals from forms with whole periods.
namespace moduli {

struct QuadOptions {
  /// The image covers the unit squares of the plane about so many times altogether, or fewer: more
  /// allow periods that are nearer to those of a holomorphic form.
  double most_squares = 2000;
  /// Cut the image further where it lies on itself, into islands that are whole numbers apart.
  bool cut_overlaps = true;
};

/// Integrates a closed form a + i b with Gaussian integers as periods over a closed connected
/// surface of genus >= 1, cut open: the lines on which a coordinate is whole go on across every
/// cut, and cut the surface into quadrilaterals but for those around zeros. a and b are the
/// harmonic forms of whole classes u and v, v nearly the conjugate of u: of the pairs that
/// LLL-reduced bases of all (u, v) offer, weighted by how much v misses, the one whose energy
/// exceeds its area least. The result's `quads` tells by how much (a holomorphic form's does not),
/// and where the zeros of a are.
///
/// Holomorphic forms of genus >= 2 have 2 g - 2 zeros, around which the image covers the plane
/// twice; faces that hold one are turned over (certificate.quality.flipped_faces), and the image
/// would lie on itself. lengths: per edge, positive up to rounding. Fails with kUnsupportedTopology
/// (other surfaces), kInvalidOption (no form within most_squares with a misfit below one half), and
/// as computePeriods does. Stages as computePeriods, "layout". Source: MATH 10; Kaelberer, Nieser,
/// Polthier 2007 (rounding of periods).
Result<Parameterization> parameterizeQuads(Context& context, const Connectivity& surface,
                                           const std::vector<double>& lengths,
                                           const QuadOptions& options);

}  // namespace moduli
