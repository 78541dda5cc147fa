#pragma once

#include <memory>

#include "tests/bench/case.h"

namespace moduli {

/// hyperbolic/develop, group, polygon, spectrum, pants, signature and lengths of a surface of
/// negative Euler characteristic (with a boundary: of its double); nothing of others. Each is the
/// cost of that step alone, after those before it: `spectrum` is the default signature's,
/// `signature` all that a default signature adds to the metric, `lengths` all geodesics up to 1.5
/// systoles.
void registerHyperbolic(const std::shared_ptr<Case>& mesh);

}  // namespace moduli
