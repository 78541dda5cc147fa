#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/triangle_soup.h"

namespace moduli {

/// Per vertex the lowest one with exactly equal coordinates, itself if there is none before it.
/// Zero equals minus zero; a vertex with a non-finite coordinate equals no other. O(V) expected,
/// O(V log V) for any input.
std::vector<Index> lowestEqualVertices(const std::vector<Eigen::Vector3d>& vertices);

}  // namespace moduli
