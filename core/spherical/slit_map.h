#pragma once

#include <complex>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/topology/cochain.h"

namespace moduli {

struct SlitMapOptions {
  Index outer = 0;  ///< The boundary loop that becomes the unit circle.
  Index inner = 1;  ///< The one that becomes the full circle around 0.
};

/// Where a boundary loop goes: an arc of a circle around 0, whose two sides the loop runs along.
struct SlitArc {
  double radius = 0;
  double begin = 0;   ///< Angle at which the arc starts, in (-pi, pi].
  double length = 0;  ///< Angle it spans, 2 pi for the outer and the inner loop.
};

/// How close the map of the triangles is to a conformal one.
struct SlitQuality {
  /// The largest difference of a loop's turn around 0 from what it should be: 2 pi, -2 pi or 0.
  double period_defect = 0;
  /// 1 - 2 area / (energy of log |w| + energy of arg w), the area that of the image of log w: 0 for
  /// a conformal map, and of second order in the edges' length.
  double energy_defect = 0;
  double mean_dilatation = 1;  ///< Area-weighted mean of K over the faces that keep orientation.
  Index flipped_faces = 0;     ///< Faces that do not; at the ends of slits there may be some.
  double solver_residual = 0;
};

/// A map of a surface to an annulus with slits.
struct SlitMap {
  std::vector<std::complex<double>> points;  ///< Per vertex its place in the annulus, w.
  /// Per vertex log w, its imaginary part cut: along the direction of an edge of `cut` it is to be
  /// continued by 2 pi times the edge's value, along all others by nothing.
  std::vector<std::complex<double>> logarithm;
  Cochain cut;                ///< Edges that cross a path from the inner to the outer loop.
  std::vector<SlitArc> arcs;  ///< Per boundary loop.
  SlitQuality quality;
};

/// Conformal map of a surface of genus 0 with b >= 2 boundary loops to a round annulus around 0
/// less concentric arcs. log |w| is harmonic with one value on each loop, such that its flux is 2
/// pi through the outer loop, -2 pi through the inner one and 0 through the others; arg w is the
/// harmonic form, tangential to the boundary, with these periods. It is solved for with them, not
/// integrated from a conjugate that closes up in the limit alone: loops lie on their circles and
/// turn as they should to rounding, and how far the two are from conjugate is the error, reported.
///
/// lengths: per edge, proper triangles; boundary_loops: those of computeTopology. The first vertex
/// of the outer loop becomes 1. Fails with kUnsupportedTopology (genus, closed, disk, several
/// components), kInvalidOption (loops that are none or the same) and as borderedHarmonicForms. Two
/// factorizations, 2 (b - 1) back-substitutions. Source: MATH 5.4.
Result<SlitMap> computeSlitMap(Context& context, const Connectivity& surface,
                               const std::vector<double>& lengths,
                               const std::vector<std::vector<Index>>& boundary_loops,
                               const SlitMapOptions& options = {});

}  // namespace moduli
