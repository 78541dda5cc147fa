#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/koebe.h"
#include "core/spherical/mobius.h"

/// From surfaces of genus 0 with boundary loops to plane domains: caps on, sphere, caps off.
namespace moduli {

/// The boundary loops of a surface, as halfedges, the longest one first and the others in the order
/// of computeTopology. lengths: per edge. O(F).
std::vector<std::vector<Index>> loopsLongestFirst(const Connectivity& surface,
                                                  const std::vector<double>& lengths);

/// The vertices of loops of halfedges.
std::vector<std::vector<Index>> loopVertices(const Connectivity& surface,
                                             std::vector<std::vector<Index>> loops);

/// Points of the sphere in the plane around it with `pole` at infinity, counter-clockwise where
/// they run so on the sphere seen from outside.
std::vector<std::complex<double>> unfoldSphere(const Points3& points, const Eigen::Vector3d& pole);

/// The positions of a capped surface's vertices in space: apexes stand in the middle of their
/// loops. Empty where there are none.
std::vector<Eigen::Vector3d> cappedPositions(const Connectivity& surface,
                                             const std::vector<std::vector<Index>>& loops,
                                             std::vector<Eigen::Vector3d> positions);

/// The circle domain of a connected surface of genus 0 with at least two boundary loops, by the
/// robust map of the capped sphere and Koebe's iteration; circles in the order of
/// loopsLongestFirst. Whether faces keep their orientation is not looked at. lengths: per edge,
/// proper triangles; positions: per vertex, or empty. Fails as capLoops, mapToIdealPolyhedron and
/// koebe do. Source: MATH 5.5.
Result<CircleDomain> mapToCircleDomain(Context& context, const Connectivity& surface,
                                       const std::vector<double>& lengths,
                                       const std::vector<Eigen::Vector3d>& positions,
                                       bool initial_delaunay = true);

}  // namespace moduli
