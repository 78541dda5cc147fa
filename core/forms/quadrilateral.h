#pragma once

#include <array>
#include <vector>

#include "core/base/context.h"
#include "core/forms/bordered_period.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// Modulus of a conformal quadrilateral, a disk with four marked boundary vertices a, b, c, d in
/// the order of its boundary (face on the left): the width |ab| over the height |bc| of the
/// rectangle that it maps to, corners to corners. It is the extremal distance of the sides bc and
/// da. Turned by one corner it becomes its reciprocal. The value is the geometric mean of two
/// bounds, both Dirichlet energies: exact to rounding on rectangles and wherever a symmetry of the
/// mesh exchanges the pairs of sides. surface: connected of genus 0 with one boundary loop
/// (kUnsupportedTopology otherwise); corners: distinct boundary vertices in that order
/// (kInvalidOption otherwise, naming the corner). Fails as SpdSolver does. Two factorizations.
/// Source: MATH 5.2.
Result<BoundedNumber> quadrilateralModulus(Context& context, const Connectivity& surface,
                                           const std::vector<double>& lengths,
                                           const std::array<Index, 4>& corners);

}  // namespace moduli
