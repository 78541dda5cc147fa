#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/heat_flow.h"
#include "core/spherical/map_quality.h"

/// Conformal maps of a disk-like surface to the unit disk.
///
/// Both are centred: the mean of the points, weighted by the vertex areas of the metric, is 0 (see
/// core/spherical/disk_centering.h). What is left free is a rotation of the disk; none is
/// preferred, and how the result is turned means nothing.
///
/// Both are harmonic maps of the double, and share a limit: a face with two boundary edges
/// collapses if one of its angles at the third edge is not acute, for its tip then belongs on its
/// neighbour or beyond. Such a tip is put between its neighbours instead, and counted.
namespace moduli {

struct DiskMap {
  /// Per vertex, orientation kept. Boundary vertices lie on the unit circle in their order around
  /// the surface, all others inside.
  std::vector<std::complex<double>> points;
  MapQuality quality;
  double boundary_deviation = 0;  ///< Largest ||w| - 1| of a boundary vertex.
  double centering_residual = 0;
  int iterations = 0;     ///< Relaxations of the linear map, or steps of the heat flow.
  std::size_t flips = 0;  ///< Of edges of the double, to weights that are not negative.
  Index reset_tips = 0;   ///< Tips of collapsed faces that were put between their neighbours.
  /// How far the map of the double was from its mirror image (double cover alone), on the sphere.
  double asymmetry = 0;
};

/// By linear solves alone, on the surface alone, with one factorization. A conformal map that
/// carries a point of the surface to 0 turns the boundary by the harmonic measure seen from there:
/// what flows out of a source there where the boundary is kept at 0. The boundary stands on the
/// circle accordingly, and the inside is its harmonic extension, which on the weights of the
/// intrinsic Delaunay triangulation (none negative inside) folds none of that one's faces (Tutte;
/// Radó, Kneser, Choquet). The point is first the one farthest from the boundary (for a random
/// walker), then the one that the first map has nearest to the centre. A surface without inner
/// vertices gets some convex polygon.
///
/// lengths: per edge, proper triangles. Depends on the lengths alone, up to a rotation, but for the
/// choice among points that a symmetry of the surface carries into each other, where the lowest
/// index wins. Positions converge at second order in the mean square on smooth surfaces. Fails with
/// kUnsupportedTopology (not connected, of genus 0 with one boundary loop), kFoldedMap (with the
/// number of flipped faces, or where the boundary turns back), and as flipToDelaunayIsometric,
/// SpdSolver and centerDisk do. Some 2 F. Source: MATH 2.3, 5.1; harmonic measure: Garnett and
/// Marshall 2005, chapter I.
Result<DiskMap> mapToDiskLinear(Context& context, const Connectivity& surface,
                                const std::vector<double>& lengths);

/// By the double: two copies glued along the boundary are a sphere, mapped by
/// mapToSphereHeatFlow. The boundary lies close to a circle, whose plane (by least squares) a
/// Möbius map carries through the centre; the mean of the map and its mirror image has the boundary
/// on the equator, and the hemisphere is projected from the opposite pole.
///
/// positions: per vertex, or empty; only to start from. Fails as mapToDiskLinear and
/// mapToSphereHeatFlow do. Source: Gu et al.; MATH 2.8.
Result<DiskMap> mapToDiskDoubleCover(Context& context, const Connectivity& surface,
                                     const std::vector<double>& lengths,
                                     const std::vector<Eigen::Vector3d>& positions,
                                     const HeatFlowOptions& options = {});

}  // namespace moduli
