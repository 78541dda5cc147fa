#pragma once

#include <vector>

#include "core/intrinsic/geometry.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// A surface that is known from within alone: triangles, how they are glued, and the lengths of
/// their edges. Loops and double edges are allowed.
struct IntrinsicSurface {
  Connectivity connectivity;
  std::vector<double> lengths;  ///< Per edge, > 0; every face a proper triangle of `geometry`.
  Geometry geometry = Geometry::kEuclidean;
};

}  // namespace moduli
