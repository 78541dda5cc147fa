#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/hyperbolic/developing.h"

namespace moduli {

/// Where a closed geodesic goes from face to face.
struct PathStep {
  Index entry = 0;      ///< Halfedge of the face that it comes into,
  double fraction = 0;  ///< and where along it, from its tail: in [0, 1].
};

/// The closed geodesic under the axis of an element of a surface's group, along its direction: once
/// around, or as often as the element is a power. Vertices that it meets, up to 1e-9, count as on
/// its left. element: in the coordinates of the disk of the layout.
///
/// All is reckoned in coordinates of the face that the geodesic is in, so that lengths of paths add
/// no rounding. Fails with kInternal where the element is none of the group, and as the context
/// does. O(steps + those from the root of the layout to the axis).
Result<std::vector<PathStep>> followGeodesic(Context& context, const HyperbolicTriangles& triangles,
                                             const Development& development, const Su11& element);

}  // namespace moduli
