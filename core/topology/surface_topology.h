#pragma once

#include <vector>

#include "core/mesh/connectivity.h"

namespace moduli {

/// Connectivity invariants of an oriented manifold surface.
struct SurfaceTopology {
  Index components = 0;
  std::vector<Index> component;  ///< Per face, numbered by the lowest face of each component.
  /// Per boundary loop its halfedges in order, each on the boundary with its face on the left.
  std::vector<std::vector<Index>> boundary_loops;
  Index euler_characteristic = 0;
  Index genus = 0;  ///< Summed over components.
};

/// O(V + F). Source: MATH 1 (2 - 2 g - b = chi on each component).
SurfaceTopology computeTopology(const Connectivity& surface);

}  // namespace moduli
