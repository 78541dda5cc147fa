#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"

namespace moduli {

/// Farthest point sampling that knows nothing of the order of the points: the first is the one
/// farthest from the origin, each further one is farthest from those before it. Of points that are
/// equally far up to rounding, which symmetric surfaces have, the one farther from the origin is
/// taken, then the one with the larger sum of distances to those before, then to the whole cloud;
/// what is equal then too is taken for an image under a symmetry, and either gives the same
/// distances.
///
/// points: d x n, the origin a point that the surface determines. weights: n, >= 0. At most count
/// columns are chosen, fewer where only copies are left. Any first part is spread evenly too.
/// Fails with kCancelled, kDeadlineExceeded. O(d n count); clouds with many ties cost more.
Result<std::vector<Eigen::Index>> farthestSample(Context& context, const Eigen::MatrixXd& points,
                                                 const std::vector<double>& weights,
                                                 Eigen::Index count);

/// Per chosen column the weight of the points nearest to it. A point that is equally near to
/// several up to rounding is shared among them. Fails as farthestSample. O(d n chosen).
Result<std::vector<double>> nearestWeights(Context& context, const Eigen::MatrixXd& points,
                                           const std::vector<double>& weights,
                                           const std::vector<Eigen::Index>& chosen);

}  // namespace moduli
