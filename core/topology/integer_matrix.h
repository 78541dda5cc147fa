#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/base/status.h"

/// Whole-number matrices whose arithmetic notices overflow: changes of basis of a lattice.
namespace moduli {

using Integer = std::int64_t;
using IntegerMatrix = Eigen::Matrix<Integer, Eigen::Dynamic, Eigen::Dynamic>;

/// What every function that runs out of 64 bits fails with (kOverflow).
Status integerOverflow();

/// Adds `times` row `from` to row `to`. Fails with kOverflow, the matrix then being spoiled.
Status addRow(IntegerMatrix& matrix, Eigen::Index to, Integer times, Eigen::Index from);

/// a b. Fails with kOverflow. O(n^3).
Result<IntegerMatrix> multiply(const IntegerMatrix& a, const IntegerMatrix& b);

/// J = [[0, I], [-I, 0]], 2 g x 2 g: the intersection form of a symplectic basis.
IntegerMatrix standardSymplecticForm(Eigen::Index g);

/// Whether r J r^T = J: r carries symplectic bases to symplectic bases. False where the products
/// overflow. O(g^3).
bool isSymplectic(const IntegerMatrix& r);

}  // namespace moduli
