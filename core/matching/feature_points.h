#pragma once

#include <vector>

#include "core/matching/spectral_surface.h"

namespace moduli {

/// How far a vertex lies from all others: the root mean square of its biharmonic distances to
/// them, over its mean. Large at the tips of limbs. modes as in SpectralSurface. O(V modes).
/// Source: Lipman, Rustamov, Funkhouser 2010.
Eigen::VectorXd biharmonicCentrality(const Eigen::VectorXd& values,
                                     const Eigen::MatrixXd& functions,
                                     const std::vector<double>& areas);

/// Vertices that stand out: where the centrality, then where the heat kernel signature at two
/// times, is largest within a quarter of the root of the area; of two nearer than 0.15 the first.
/// At most 12, in that order. O(V log V).
std::vector<Index> featurePoints(const EdgeGraph& graph, const Eigen::VectorXd& centrality,
                                 const Eigen::VectorXd& values, const Eigen::MatrixXd& functions);

}  // namespace moduli
