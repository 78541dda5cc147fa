#pragma once

#include "core/topology/integer_matrix.h"

namespace moduli {

/// A lattice basis in which an antisymmetric form is standard.
struct SymplecticBasis {
  /// n x n, determinant +-1, in rows: a_1 .. a_g, b_1 .. b_g, then the radical.
  IntegerMatrix basis;
  Eigen::Index pairs = 0;  ///< g.
};

/// Normal form of an antisymmetric integer form that is unimodular up to its radical, as that of
/// surfaces is: <a_i, b_j> = delta_ij, all other products 0. form: n x n. Fails with kInvalidOption
/// (not antisymmetric, or an invariant factor other than 1) and kOverflow. O(n^3), some more where
/// Euclid's algorithm is needed to find a product of 1. Source: the skew Smith form; MATH 1.
Result<SymplecticBasis> reduceSymplectic(const IntegerMatrix& form);

}  // namespace moduli
