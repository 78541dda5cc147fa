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

/// Signed solid angle of a spherical triangle, positive when a, b, c run counter-clockwise seen
/// from outside. Relative accuracy also for tiny triangles.
double signedSolidAngle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c);

/// Measures a map. points: per vertex on the unit sphere. O(F). Source: MATH 2.9, 9.1.
SphereQuality measureSphereMap(const Connectivity& surface, const std::vector<double>& lengths,
                               const Points3& points);

}  // namespace moduli
