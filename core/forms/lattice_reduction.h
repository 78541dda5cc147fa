#pragma once

#include <Eigen/Core>

#include "core/base/status.h"
#include "core/topology/integer_matrix.h"

/// Short bases of lattices that are given by their Gram matrices.
///
///   ASSIGN_OR_RETURN(const ReducedLattice lattice, reduceLattice(energy));
///   ASSIGN_OR_RETURN(const GramSchmidt steps, gramSchmidt(lattice.gram));
///
/// A lattice is Z^n with the form v -> v^T G v. A change of basis is a unimodular whole-number
/// matrix whose rows are the new basis in terms of the old one: G' = U G U^T.
namespace moduli {

/// Orthogonalization of a basis: b_i = b*_i + sum over j < i of mu(i, j) b*_j.
struct GramSchmidt {
  Eigen::MatrixXd mu;       ///< n x n, unit lower triangular.
  Eigen::VectorXd squares;  ///< n squared lengths of b*_i.
};

/// Gram-Schmidt coefficients of the basis with the Gram matrix `gram`.
/// gram: n x n, n >= 1, symmetric positive definite; the lower triangle is read.
/// Fails with kNotPositiveDefinite unless it is square, finite, symmetric to 1e-10 of its largest
/// entry and positive definite beyond rounding: squares(i) > n 2^-52 gram(i, i). O(n^3).
Result<GramSchmidt> gramSchmidt(const Eigen::MatrixXd& gram);

struct ReducedLattice {
  Eigen::MatrixXd gram;     ///< transform * given * transform^T, rounded once.
  IntegerMatrix transform;  ///< Unimodular, exact.
  IntegerMatrix dual;       ///< transform^-T, exact: the change of the dual basis.
};

/// LLL-reduced basis (delta = 0.99, |mu| <= 1/2 + 1e-9) of the lattice Z^n with a Gram matrix.
/// gram: as for gramSchmidt. Rounding does not pile up: whenever the floating-point reduction ends,
/// the Gram matrix is taken anew from `gram` and the exact transform, until nothing is left to do.
/// Reduced input is returned as it is, with the identity.
/// Fails with kNotPositiveDefinite as gramSchmidt does, with kOverflow where transform or dual
/// has entries above 2^63, and with kNoConvergence where rounding never lets it end.
/// O(n^4 log cond) at worst, O(n^3) for bases that are nearly reduced; n = 256 takes a second.
/// Source: Lenstra, Lenstra, Lovasz 1982; MATH 4.8.
Result<ReducedLattice> reduceLattice(const Eigen::MatrixXd& gram);

/// r gram r^T, computed with 64-bit mantissas and rounded once; exactly symmetric.
/// r: m x n; gram: n x n, symmetric. O(m n (m + n)), less where r has zeros.
Eigen::MatrixXd congruence(const IntegerMatrix& r, const Eigen::MatrixXd& gram);

}  // namespace moduli
