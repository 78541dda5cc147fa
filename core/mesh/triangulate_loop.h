#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/triangle_soup.h"

namespace moduli {

/// A closed polygon in space that is to be filled with triangles.
struct SpaceLoop {
  std::vector<Eigen::Vector3d> points;  ///< In the order in which the new faces run around it.
  /// Per point the unit normal of the face beyond the edge to the next point; zero if it has none.
  std::vector<Eigen::Vector3d> rim_normals;
};

/// Triangles between the points (numbers into `points`) that fill the loop: the best by a cost that
/// punishes thin triangles and bends, found by dynamic programming over sub-polygons. `blocked(i,
/// j)`, i < j and not neighbours: this diagonal must not be used. Nothing where no triangulation
/// avoids the blocked ones. Fails only with kCancelled or kDeadlineExceeded. O(n^3). Source: after
/// Barequet and Sharir 1995, Liepa 2003, with a cost of our own.
Result<std::optional<std::vector<Triangle>>> triangulateLoop(
    Context& context, const SpaceLoop& loop, const std::function<bool(Index, Index)>& blocked);

}  // namespace moduli
