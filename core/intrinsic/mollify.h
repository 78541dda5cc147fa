#pragma once

#include <vector>

#include "core/base/status.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// Edge lengths that make every face a proper triangle.
struct MollifiedLengths {
  std::vector<double> lengths;  ///< Per edge.
  /// What was added to every edge, as a fraction of the mean edge length; 0 for a sound mesh.
  double relative_shift = 0;
};

/// Adds the least constant to all lengths that gives each face a slack l_i + l_j - l_k of at least
/// `relative_slack` times the mean length (and of eight units in the last place of its longest
/// edge); sound meshes come back untouched. Commutes with scaling and renumbering. lengths: per
/// edge, finite and >= 0. Fails with kInvalidOption for others or when all are 0. O(F).
/// Source: Sharp and Crane 2020, section 4.5 (intrinsic mollification).
Result<MollifiedLengths> mollify(const Connectivity& surface, std::vector<double> lengths,
                                 double relative_slack = 1e-10);

}  // namespace moduli
