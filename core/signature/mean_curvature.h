#pragma once

#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace moduli {

/// Mean curvature H = (k1 + k2) / 2 integrated over the cell of each vertex: a quarter of
/// length times signed dihedral angle, summed over the edges there (Steiner). In model units;
/// positive where an outward oriented surface is convex; reversing the faces changes every sign.
///
/// A zero-area face has no normal, and needs none: it takes the normal of the face across its
/// longest edge. Any other normal perpendicular to the face's line gives the same sum over its
/// three edges, as the longest is as long as the two others together. An edge folded flat onto
/// itself counts as convex. O(F). Source: MATH 8.2.
std::vector<double> integratedMeanCurvature(const TriangleMesh& mesh);

}  // namespace moduli
