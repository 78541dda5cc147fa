#pragma once

#include <Eigen/Core>

#include "core/base/status.h"

namespace moduli {

struct DenseEigenPairs {
  Eigen::VectorXd values;   ///< Ascending.
  Eigen::MatrixXd vectors;  ///< Orthonormal columns, one for each value.
};

/// All eigenpairs of a dense symmetric matrix, n x n; its lower triangle is read. By divide and
/// conquer (Cuppen 1981) of the LAPACK that comes with CHOLMOD's BLAS, or without it by Eigen's QR
/// iteration, two to three times as slow. Fails with kNoConvergence (entries that are not finite,
/// mostly). O(n^3).
Result<DenseEigenPairs> denseEigenpairs(Eigen::MatrixXd matrix);

}  // namespace moduli
