#pragma once

#include <complex>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/double_cover.h"
#include "core/spherical/robust_map.h"

namespace moduli {

/// A surface with one boundary loop as the half of an ideal polyhedron.
struct IdealDisk {
  std::vector<std::complex<double>> points;  ///< Per vertex, |w| <= 1, and 1 on the boundary.
  DoubleCover cover;
  /// Of the double: the surface is its northern half, and its boundary the equator.
  IdealPolyhedron polyhedron;
  /// Largest distance of a boundary vertex from the circle before it was put there.
  double boundary_deviation = 0;
};

/// The northern half of the sphere over the disk, from the south pole, which keeps circles and
/// orientation.
Eigen::Vector3d diskToSphere(const std::complex<double>& w);
std::complex<double> sphereToDisk(const Eigen::Vector3d& point);

/// The discrete uniformization of a connected surface of genus 0 with one boundary loop: its double
/// as an ideal polyhedron that its mirror symmetry keeps, a boundary vertex at infinity. The disk
/// is centred by the vertex areas, so that it is unique up to a rotation, and does not depend on
/// the vertex at infinity. lengths: per edge, proper triangles; positions: per vertex, or empty. As
/// many unknowns as the surface has vertices. Whether the surface's own faces keep their
/// orientation is not looked at: see measurePlaneMap. Fails as uniformizePuncturedSphere and
/// centerDisk do. Source: MATH 2.5, 2.8; Bobenko, Pinkall and Springborn 2015.
Result<IdealDisk> mapToIdealDisk(Context& context, const Connectivity& surface,
                                 const std::vector<double>& lengths,
                                 const std::vector<Eigen::Vector3d>& positions,
                                 bool initial_delaunay = true, const IdealStart& start = {});

}  // namespace moduli
