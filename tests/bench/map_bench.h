#pragma once

#include <memory>

#include "tests/bench/case.h"

namespace moduli {

/// The maps that a surface has, each with its cost, the mean dilatation K, folded faces, islands,
/// faces added and steps: sphere/METHOD, disk/METHOD and circles without handles; plane/flat,
/// plane/cones (chosen ones), plane/torus, plane/polycube, plane/atlas and plane/quads.
void registerMaps(const std::shared_ptr<Case>& mesh);

}  // namespace moduli
