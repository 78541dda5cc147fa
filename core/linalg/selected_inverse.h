#pragma once

#include <cstddef>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/linalg/spd_solver.h"

/// Entries of the inverse of a sparse matrix where its Cholesky factor has entries, without the
/// others. SpdSolver::inverseOnPattern is the door; only it and the back ends include this.
namespace moduli {

/// A symmetric matrix at the places of a Cholesky factor, whose columns are taken in blocks that
/// share their rows: the factor L of A = L L^T, or what replaces it.
struct BlockFactor {
  std::vector<int> order;  ///< Column k belongs to unknown order[k].
  /// One more than there are blocks: where the columns, `rows` and `values` of each begin.
  std::vector<int> first_column;
  std::vector<std::size_t> first_row, first_value;
  /// Of each block ascending, its own columns first. Rows below those of a block are columns of the
  /// later blocks, and the first of these has them all.
  std::vector<int> rows;
  /// Each block column-major, all rows by all columns; of its diagonal square a factor uses the
  /// lower triangle.
  std::vector<double> values;

  std::size_t blocks() const { return first_column.empty() ? 0 : first_column.size() - 1; }
};

/// Puts the entries of (L L^T)^{-1} in place of those of L; diagonal squares are whole then.
///
/// From the last block to the first, with Y = L_below L_diagonal^{-1} and Z the inverse on the rows
/// below, all of whose entries are known already: Z_below = -Z Y, Z_diagonal = (L_diagonal
/// L_diagonal^T)^{-1} - Y^T Z_below. Dense products do the work, some two to three times as many
/// operations as a factorization has. Fails with kMeshTooLarge (memory), kCancelled,
/// kDeadlineExceeded. Memory: the square of the largest number of rows.
/// Source: Takahashi, Fagan and Chin 1973; Erisman and Tinney 1975; MATH 11.5.
Status invertBlocks(Context& context, BlockFactor& factor);

/// The entries that `pattern` (n x n, lower triangle; its values do not matter) asks for. Fails
/// with kInvalidOption naming an entry for which there is no place. O(entries log rows).
Result<SparseMatrix> entriesOnPattern(const BlockFactor& inverse, const SparseMatrix& pattern);

}  // namespace moduli
