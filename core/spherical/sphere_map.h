#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/mobius.h"

namespace moduli {

/// How good a map to the sphere is, computed from its final points.
struct SphereQuality {
  Index flipped_faces = 0;     ///< Spherical triangles with signed solid angle <= 0.
  double covering_degree = 0;  ///< Sum of signed solid angles / 4 pi; 1 for a bijection.
  double max_dilatation = 1;   ///< Largest quasi-conformal K of the faces (metric -> chords).
  double mean_dilatation = 1;  ///< Area-weighted mean of K over the metric.
};

struct SphereMap {
  Points3 points;  ///< Per vertex, on the unit sphere, outward orientation kept.
  SphereQuality quality;
  double centering_residual = 0;
  int newton_iterations = 0;
};

/// Conformal map of a closed connected genus-0 surface to the sphere by two linear solves: harmonic
/// map to the plane from a dipole at a central face, mean Beltrami coefficient removed, lifted with
/// north-south balance, pole corrected by a linear Beltrami solve, Möbius-centred with the vertex
/// areas of the metric. lengths: per edge, proper triangles.
/// Fails with kUnsupportedTopology, kFoldedMap (flipped faces, with their number; the hint names
/// the remedy), and as SpdSolver does. About 3 F. Source: Angenent and Haker 2000; Choi, Lam, Lui
/// 2015; MATH 2.3, 2.7.
Result<SphereMap> mapToSphereLinear(Context& context, const Connectivity& surface,
                                    const std::vector<double>& lengths);

/// Measures a map. points: per vertex on the unit sphere. O(F). Source: MATH 2.9, 9.1.
SphereQuality measureSphereMap(const Connectivity& surface, const std::vector<double>& lengths,
                               const Points3& points);

}  // namespace moduli
