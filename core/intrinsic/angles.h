#pragma once

#include <vector>

#include "core/mesh/connectivity.h"

/// Angles of a Euclidean discrete metric: one length per edge, proper triangles.
namespace moduli {

/// Per halfedge h the angle at tail(h) in its face, in radians, by the half-angle formula, which
/// keeps its relative precision in needles. O(F). Source: MATH 6.1.
std::vector<double> cornerAngles(const Connectivity& surface, const std::vector<double>& lengths);

/// Per vertex 2 pi (inside) or pi (on the boundary) less the angles around it. Their sum is 2 pi
/// times the Euler characteristic (Gauss and Bonnet). O(F). Source: MATH 6.2.
std::vector<double> vertexCurvatures(const Connectivity& surface,
                                     const std::vector<double>& lengths);

}  // namespace moduli
