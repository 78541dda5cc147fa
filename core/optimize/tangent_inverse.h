#pragma once

#include <Eigen/Core>

#include "core/base/status.h"
#include "core/linalg/spd_solver.h"

/// P, the inverse of a Hessian on the tangent space g^perp, by dense algebra: for small numbers of
/// unknowns, singular and indefinite Hessians, and as twins of the sparse form.
namespace moduli {

/// P and what it takes to solve with it.
struct TangentInverse {
  Eigen::MatrixXd P;  ///< n x n, symmetric, P g = 0.
  /// log |det [[H, g / |g|], [(g / |g|)^T, 0]]| = log |det U^T H U|.
  double log_determinant = 0;
  /// Whether U^T H U is positive definite: the level set is strictly convex there.
  bool positive = false;
};

/// By the inverse of the bordered matrix [[H, g], [g^T, 0]]. hessian: n x n symmetric; gradient:
/// not 0. Fails with kNotPositiveDefinite where U^T H U is singular to 1e-14 of the Hessian: the
/// level set is flat. O(n^3). Source: MATH 11.3.
Result<TangentInverse> tangentInverseBordered(const Eigen::MatrixXd& hessian,
                                              const Eigen::VectorXd& gradient);

/// By an orthonormal basis U of g^perp, P = U (U^T H U)^{-1} U^T. The same conditions, errors and
/// cost. Source: MATH 11.2.
Result<TangentInverse> tangentInverseByBasis(const Eigen::MatrixXd& hessian,
                                             const Eigen::VectorXd& gradient);

/// n x (n - 1): an orthonormal basis of the vectors orthogonal to `gradient`, by a Householder
/// reflection.
Eigen::MatrixXd tangentBasis(const Eigen::VectorXd& gradient);

/// The whole symmetric matrix of a lower triangle.
Eigen::MatrixXd denseOf(const SparseMatrix& lower);

/// The entries of a symmetric matrix on a pattern (lower triangle).
SparseMatrix onPattern(const Eigen::MatrixXd& matrix, const SparseMatrix& pattern);

}  // namespace moduli
