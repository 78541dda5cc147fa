#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/ricci/discrete_metric.h"
#include "core/ricci/vertex_scaling.h"

/// Uniformization of closed surfaces of genus 0: a vertex goes to infinity, the rest is flattened
/// onto a convex polygon.
///
/// Faces at the vertex at infinity are those of an ideal prism over the polygon's sides; with the
/// inverse stereographic projection all vertices stand on the sphere as those of an ideal
/// hyperbolic polyhedron, which exists and is unique up to Möbius maps. Source: MATH 2.5; Rivin
/// 1996; Springborn 2019, section 11.
namespace moduli {

struct PuncturedSphereOptions {
  bool initial_delaunay = true;  ///< As in PrescribeOptions.
  /// The vertex to send to infinity; kNone: the nearest to the others, and other ones if it fails.
  Index infinity = kNone;
  /// Vertices that a symmetry of the surface exchanges share an unknown, and the vertex at infinity
  /// is one that it fixes. Empty: one unknown per vertex.
  Unknowns unknowns = {};
  /// Per vertex factors to begin with, such as those found from the other starting triangulation of
  /// the same lengths; with `infinity`, and then no other start is tried. Empty: none.
  std::vector<double> start = {};
};

struct PuncturedSphereMetric {
  /// Faces at infinity are there too, with spokes of half chord 1 and angles 0, without meaning in
  /// the plane. certificate.curvature_residual is that of the free vertices.
  DiscreteMetric metric;
  Index infinity = 0;
  std::vector<bool> on_link;  ///< Per vertex: on the boundary of the polygon.
  /// The largest inner angle of the polygon, radians: at most pi, up to rounding.
  double max_link_angle = 0;
};

/// surface: closed, connected, of genus 0, with at least 4 vertices. lengths: per edge, proper
/// triangles. positions: per vertex, in the units of the lengths, for a good start (the inversion
/// of space that sends the vertex to infinity). Where there are none, or they do not help, the flat
/// metric with three cones is found first, which exists for all lengths.
///
/// The Ricci energy is minimized under the bounds u_i >= -2 log x_{i, infinity} of all arcs to
/// infinity, which hold with equality on the polygon: an active-set Newton method, where vertices
/// that reach their bound join the polygon and vertices with an angle above pi leave it.
/// Fails with kUnsupportedTopology (another genus, too few vertices), kNoConvergence, and as the
/// solvers do. One factorization per step, some 5 to 10 of them.
Result<PuncturedSphereMetric> uniformizePuncturedSphere(
    Context& context, const Connectivity& surface, const std::vector<double>& lengths,
    const std::vector<Eigen::Vector3d>& positions, const PuncturedSphereOptions& options = {});

}  // namespace moduli
