#pragma once

#include <cstddef>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"

/// Cotan weights that are not negative. Internal to this room.
namespace moduli::spherical {

/// A surface with the same vertices and the same metric, perhaps with other edges.
struct WeightedSurface {
  Connectivity surface;  ///< A Δ-complex where edges were flipped.
  std::vector<double> lengths;
  std::vector<double> weights;  ///< Cotan weight of every edge.
  std::size_t flips = 0;
};

/// The surface itself where its interior weights are not negative, its intrinsic Delaunay
/// triangulation otherwise. Boundary edges never flip, and where the boundary is jagged (an obtuse
/// angle faces it) they keep their negative weights. lengths: per edge, proper triangles.
/// Fails as flipToDelaunayIsometric does.
Result<WeightedSurface> delaunayWeights(Context& context, const Connectivity& surface,
                                        const std::vector<double>& lengths);

}  // namespace moduli::spherical
