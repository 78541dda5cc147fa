#pragma once

#include <memory>

#include "tests/bench/case.h"

namespace moduli {

/// affine_step: what a step along the affine normal of the Ricci energy costs beside one of
/// Newton's, on the surface's own metric (hyperbolic for negative Euler characteristics, else
/// Euclidean), after the first analysis: `factorize`, `invert` (the selected inverse), `tau` (third
/// derivatives and their contraction), `solve` (two) and `value` (moving there and the energy), in
/// F; `inverses` is invert / factorize.
void registerRicci(const std::shared_ptr<Case>& mesh);

}  // namespace moduli
