#pragma once

#include <vector>

#include "core/hyperbolic/su11.h"
#include "core/intrinsic/intrinsic_surface.h"

namespace moduli {

/// Generators of the group of a closed hyperbolic surface: one for each edge whose triangles no
/// step of a breadth-first layout of the triangles, from triangle `root` on, joins.
std::vector<Su11> holonomyGenerators(const IntrinsicSurface& surface, Index root = 0);

/// Side pairings of the regular 4g-gon with angles pi / (2 g) and the word a1 b1 a1^-1 b1^-1 ..:
/// every side to its partner.
std::vector<Su11> regularPolygonGroup(int genus);

/// Every element g as move g move^-1.
std::vector<Su11> conjugated(const std::vector<Su11>& generators, const Su11& move);

/// Other generators of the same group: every other one multiplied by the next or its inverse, at
/// random.
std::vector<Su11> otherGenerators(std::vector<Su11> generators, unsigned seed);

}  // namespace moduli
