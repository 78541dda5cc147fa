#pragma once

#include <complex>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/ricci/punctured_sphere.h"
#include "core/spherical/mobius.h"
#include "core/spherical/sphere_map.h"

/// The robust map of genus-0 surfaces: a vertex at infinity, the discrete conformal flat metric
/// with flips, inverse stereographic projection.
namespace moduli {

/// Vertices of a closed surface as those of an ideal polyhedron: on the unit sphere.
struct IdealPolyhedron {
  Points3 points;                ///< Per vertex; faces outwards as the surface's.
  PuncturedSphereMetric metric;  ///< Its faces, and how they came from the surface's by flips.
  double layout_closure = 0;     ///< Largest gap of the plane layout, in lengths of its edge.
  double centering_residual = 0;
};

/// Where every finite vertex of a punctured sphere lies in the plane, counter-clockwise; 0 for the
/// vertex at infinity.
struct PuncturedLayout {
  std::vector<std::complex<double>> points;
  double closure = 0;  ///< As unfoldingGap.
};
PuncturedLayout layOutPunctured(const PuncturedSphereMetric& metric);

/// Where a search for another triangulation of the same surface may begin: a metric found already.
struct IdealStart {
  Index infinity = kNone;
  std::vector<double> u;  ///< Per vertex of what was mapped (of the double, for a disk).
};
IdealStart startOf(const PuncturedSphereMetric& metric);

/// The discrete uniformization of a closed connected surface of genus 0, Möbius-centred with the
/// vertex areas of its metric: unique up to a rotation, and independent of the vertex that goes to
/// infinity. lengths, positions, options: as uniformizePuncturedSphere's. Whether the surface's own
/// faces keep their orientation is not looked at: see measureSphereMap. Fails as
/// uniformizePuncturedSphere and centerByMobius do. Source: MATH 2.5, 2.7.
Result<IdealPolyhedron> mapToIdealPolyhedron(Context& context, const Connectivity& surface,
                                             const std::vector<double>& lengths,
                                             const std::vector<Eigen::Vector3d>& positions,
                                             const PuncturedSphereOptions& options = {});

/// The same as a map of the surface's faces: from the given starting triangulation, or from the
/// other one where that folds fewer faces. Some may be left, and `quality` counts them. Fails as
/// mapToIdealPolyhedron does from both.
Result<SphereMap> mapToSphereRobust(Context& context, const Connectivity& surface,
                                    const std::vector<double>& lengths,
                                    const std::vector<Eigen::Vector3d>& positions,
                                    bool initial_delaunay = true);

/// Per vertex a factor s such that sqrt(s_i s_j) |p_i - p_j| is proportional to the half chords of
/// the triangulation before scaling, for its edges ij: the light-like vectors s_i (p_i, 1) stand
/// for the vertices in the space in which projective coordinates are linear.
std::vector<double> lightConeScales(const IntrinsicTriangulation& triangulation,
                                    const Points3& points);

}  // namespace moduli
