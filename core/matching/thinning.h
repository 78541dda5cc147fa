#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/base/context.h"
#include "core/matching/ring_mesh.h"

/// Which vertices of a mesh go first when it is made coarse.
namespace moduli {

/// Whether a triangle of three vertices may be a face.
using FaceRule = std::function<bool(Index, Index, Index)>;

/// Removes vertices, short edges first and evenly over the surface, until `wanted` are left or none
/// can go. A vertex goes where its new faces are no needles, do not turn away from the old ones in
/// space, and obey `rule`; in rounds, and in each round no two neighbours. positions: per vertex.
/// Only vertices with `movable[v]` go. O(V log V).
Status thinEvenly(Context& context, RingMesh& mesh, const std::vector<Eigen::Vector3d>& positions,
                  const std::vector<char>& movable, const FaceRule& rule, Index wanted);

/// Removes vertices of bad faces until every face obeys `rule`: always the one that takes away most
/// bad faces and brings fewest. Says whether that came about before no vertex could go. O(V), and
/// the number of vertices at bad faces for each that goes.
bool thinUntil(RingMesh& mesh, const std::vector<Eigen::Vector3d>& positions, const FaceRule& rule);

}  // namespace moduli
