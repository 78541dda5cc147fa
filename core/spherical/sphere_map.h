#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/map_quality.h"
#include "core/spherical/mobius.h"

namespace moduli {

struct SphereMap {
  Points3 points;  ///< Per vertex, on the unit sphere, outward orientation kept.
  MapQuality quality;
  double centering_residual = 0;
  int newton_iterations = 0;
};

/// Conformal map of a closed connected genus-0 surface to the sphere by linear solves alone. First
/// a harmonic map to the plane from a dipole at a central face, its mean Beltrami coefficient
/// removed, lifted with north-south balance. Its error sits at the pole and is of first order in
/// the edge length elsewhere, so the map is then relaxed to harmonic in two overlapping charts of
/// the sphere in turn. (The linear Beltrami system of a chart is this: the Dirichlet energy of the
/// surface's own metric.) Last it is Möbius-centred with the vertex areas of the metric.
///
/// lengths: per edge, proper triangles. The map is canonical up to a rotation: it depends on the
/// lengths alone, but for the choice among faces that a symmetry of the surface carries into each
/// other, where the lowest index wins. Positions converge at second order in the mean square on
/// smooth surfaces. Fails with kUnsupportedTopology, kFoldedMap (with the number of flipped faces;
/// the hint names the remedy), and as SpdSolver does. Three factorizations, about 3 F. Source:
/// Angenent and Haker 2000; Choi, Lam, Lui 2015; MATH 2.3, 2.7.
Result<SphereMap> mapToSphereLinear(Context& context, const Connectivity& surface,
                                    const std::vector<double>& lengths);

/// The same with the faces it folds, of which `quality` has the number: a start for what unfolds
/// them.
Result<SphereMap> mapToSphereFolding(Context& context, const Connectivity& surface,
                                     const std::vector<double>& lengths);

}  // namespace moduli
