#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/mesh/connectivity.h"
#include "core/spherical/mobius.h"

/// Where a vertex of a map to the sphere may be, and where it is best, given its neighbours.
/// Internal to this room.
namespace moduli {

/// Smallest ratio of lengths on the sphere to those on the surface (scaled to the sphere's area)
/// that is worth having: of the sixteen digits of a place on the sphere half tell where so small a
/// part is, and the other half what is in it.
inline constexpr double kLeastScale = 1e-8;

/// A vertex, what its faces are on the surface, and where its neighbours are on the sphere.
struct PlacedRing {
  Index vertex = kNone;
  const std::vector<Index>& ring;  ///< Its neighbours, counter-clockwise; as RingMesh has them.
  const std::vector<Eigen::Vector3d>& positions;  ///< Per vertex, on the surface.
  const Points3& points;                          ///< Per vertex, on the sphere.
  double area = 1;                                ///< Of the whole surface.
  double least_scale = kLeastScale;               ///< What shrinks more is kept from shrinking.
  /// Whether all faces count as equilateral, with an area of 1 each, whatever they are.
  bool alike = false;
};

/// Whether no face of the vertex is folded when it is at p, decided without an error: whether p is
/// in the kernel of the ring.
bool isInKernel(const PlacedRing& ring, const Eigen::Vector3d& p);

/// A point well inside of the kernel: the centroid of the kernel in the gnomonic chart around
/// `near`, a point at its edge or in it. Nothing where doubles find no room. O(degree^2).
std::optional<Eigen::Vector3d> kernelCentre(const PlacedRing& ring, const Eigen::Vector3d& near);

/// From a point of the kernel to where the faces around the vertex are least distorted:
/// sum over faces of A (|J|^2 / (2 det J) + s^2 / det J), with the areas A and the
/// Jacobians J of the map in the chart. The first term is 1 where the map is conformal; the second
/// keeps what is shrunk by more than s, the least scale, from being shrunk further. Both are
/// infinite at the edge of the kernel and convex in it, so that Newton's method finds the least.
/// The result is in the kernel, too. O(degree).
Eigen::Vector3d leastDistorted(const PlacedRing& ring, const Eigen::Vector3d& start);

}  // namespace moduli
