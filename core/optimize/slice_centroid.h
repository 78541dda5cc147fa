#pragma once

#include <Eigen/Core>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/optimize/objective.h"

namespace moduli {

/// -(centroid of the slice - x) / depth: what the affine normal is the limit of, from values and
/// gradients alone. The slice is {y : f(y) <= f(x), gradient(x).(y - x) = -depth |gradient(x)|}.
///
/// x: 2 to 4 unknowns, in a strictly convex level set; depth > 0, less than the depth of the level
/// set. Returns a vector whose product with gradient / |gradient| is 1; its distance from the
/// affine normal of that length falls linearly with depth. For tests and pictures. The objective is
/// left at x.
///
/// Fails with kInvalidOption (size, depth), kNoConvergence (no point of the slice lies in the level
/// set, or its edge is not found), as moveTo does. A few ten thousand evaluations (4 unknowns).
/// Source: MATH 11.4.
Result<Eigen::VectorXd> sliceCentroid(Context& context, Objective& objective,
                                      const Eigen::VectorXd& x, double depth);

}  // namespace moduli
