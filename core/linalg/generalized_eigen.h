#pragma once

#include <Eigen/Core>

#include "core/base/context.h"
#include "core/linalg/spd_solver.h"

namespace moduli {

struct EigenOptions {
  Eigen::Index count = 0;  ///< Pairs wanted; at most the size of the matrices.
  /// Positive, in units of the eigenvalues; about the distance of the wanted ones from each other
  /// is best. stiffness + shift * mass must be positive definite.
  double shift = 1;
  /// Of |A x - nu x| / nu in the norm of the mass matrix, A = (stiffness + shift mass)^-1 mass.
  double tolerance = 1e-8;
};

/// Pairs stiffness x = value mass x, where mass is diagonal.
struct EigenPairs {
  Eigen::VectorXd values;   ///< Ascending.
  Eigen::MatrixXd vectors;  ///< n x count, x_i^T mass x_j = (i == j).
  /// The largest |A x - nu x| / nu of the pairs, measured on the final vectors. A value is wrong by
  /// at most this times (value + shift), in fact by about its square; a vector by at most it
  /// times (value + shift) over the distance to the next value.
  double largest_residual = 0;
  Eigen::Index dimension = 0;  ///< Of the Krylov space that they were found in.
};

/// The smallest eigenpairs of a symmetric positive semidefinite matrix against a positive diagonal
/// one, with multiplicities of up to 16.
///
///   ASSIGN_OR_RETURN(const EigenPairs modes,
///                    smallestEigenpairs(context, stiffness, mass, {.count = 60}));
///
/// Block Lanczos with blocks of 16 on the shifted inverse A, each block made orthogonal to all
/// before it: a block costs hardly more to solve for than a few single vectors, and multiplets are
/// found whole, which a single start vector does not see. Matrices of up to 400 rows are solved
/// densely.
///
/// stiffness: n x n, lower triangle. mass: n positive numbers. The same input gives the same bytes;
/// another order of the rows gives the same values within the tolerance, and the same vectors up to
/// rotations among equal values. Fails with kInvalidOption (sizes, count, shift), kNoConvergence,
/// as SpdSolver does, with kCancelled and kDeadlineExceeded. Stages: "analyse", "factorize",
/// "solve", "eigen". One factorization, some 300 back-substitutions for 50 pairs; memory of n *
/// dimension doubles.
Result<EigenPairs> smallestEigenpairs(Context& context, const SparseMatrix& stiffness,
                                      const Eigen::VectorXd& mass, const EigenOptions& options);

}  // namespace moduli
