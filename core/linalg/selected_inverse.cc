#include "core/linalg/selected_inverse.h"

#include <algorithm>
#include <limits>
#include <new>
#include <string>

#include "core/linalg/factor_backend.h"

#ifdef MODULI_WITH_CHOLMOD
extern "C" {
void dgemm_(const char* transposed_a, const char* transposed_b, const int* rows, const int* columns,
            const int* inner, const double* alpha, const double* a, const int* stride_a,
            const double* b, const int* stride_b, const double* beta, double* c,
            const int* stride_c);
void dsymm_(const char* side, const char* triangle, const int* rows, const int* columns,
            const double* alpha, const double* a, const int* stride_a, const double* b,
            const int* stride_b, const double* beta, double* c, const int* stride_c);
void dtrsm_(const char* side, const char* triangle, const char* transposed, const char* diagonal,
            const int* rows, const int* columns, const double* alpha, const double* a,
            const int* stride_a, double* b, const int* stride_b);
}
#endif

namespace moduli {
namespace {

/// Operations between two looks at the clock: some milliseconds.
constexpr double kCheckEvery = 1e7;

/// A column-major matrix within a larger one.
using Block = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

#ifdef MODULI_WITH_CHOLMOD
int rowsOf(const Block& block) {
  return static_cast<int>(block.rows());
}
int columnsOf(const Block& block) {
  return static_cast<int>(block.cols());
}
int strideOf(const Block& block) {
  return static_cast<int>(block.outerStride());
}

/// b := b l^{-1} (left: l^{-1} b, or with transposed l^{-T} b), l a lower triangle.
void divide(const char* side, const char* transposed, const Block& l, Block b) {
  const int rows = rowsOf(b), columns = columnsOf(b), stride_l = strideOf(l), stride = strideOf(b);
  const double one = 1;
  dtrsm_(side, "L", transposed, "N", &rows, &columns, &one, l.data(), &stride_l, b.data(), &stride);
}

void divideRight(const Block& l, Block b) {
  divide("R", "N", l, b);
}
void divideLeft(const Block& l, Block b) {
  divide("L", "N", l, b);
}
void divideLeftTransposed(const Block& l, Block b) {
  divide("L", "T", l, b);
}

/// c := -s b, s symmetric by its lower triangle.
void symmetricProduct(const Block& s, const Block& b, Block c) {
  const int rows = rowsOf(c), columns = columnsOf(c), stride_s = strideOf(s);
  const int stride_b = strideOf(b), stride_c = strideOf(c);
  const double minus = -1, zero = 0;
  dsymm_("L", "L", &rows, &columns, &minus, s.data(), &stride_s, b.data(), &stride_b, &zero,
         c.data(), &stride_c);
}

/// c := c - a^T b.
void subtractTransposedProduct(const Block& a, const Block& b, Block c) {
  const int rows = rowsOf(c), columns = columnsOf(c), inner = rowsOf(a), stride_a = strideOf(a);
  const int stride_b = strideOf(b), stride_c = strideOf(c);
  const double minus = -1, one = 1;
  dgemm_("T", "N", &rows, &columns, &inner, &minus, a.data(), &stride_a, b.data(), &stride_b, &one,
         c.data(), &stride_c);
}
#else
void divideRight(const Block& l, Block b) {
  l.triangularView<Eigen::Lower>().solveInPlace<Eigen::OnTheRight>(b);
}
void divideLeft(const Block& l, Block b) {
  l.triangularView<Eigen::Lower>().solveInPlace(b);
}
void divideLeftTransposed(const Block& l, Block b) {
  l.transpose().triangularView<Eigen::Upper>().solveInPlace(b);
}
void symmetricProduct(const Block& s, const Block& b, Block c) {
  c.noalias() = -(s.selfadjointView<Eigen::Lower>() * b);
}
void subtractTransposedProduct(const Block& a, const Block& b, Block c) {
  c.noalias() -= a.transpose() * b;
}
#endif

class Inversion {
 public:
  explicit Inversion(BlockFactor& factor) : factor_(factor) {}

  Status run(Context& context) {
    findParents();
    std::size_t largest_below = 0, largest_product = 0, widest = 0;
    for (std::size_t s = 0; s < factor_.blocks(); ++s) {
      const std::size_t below = rowCount(s) - width(s);
      largest_below = std::max(largest_below, below);
      largest_product = std::max(largest_product, below * width(s));
      widest = std::max(widest, width(s));
    }
    below_.resize(largest_below * largest_below);
    product_.resize(largest_product);
    square_.resize(widest * widest);
    double work = 0;
    for (std::size_t s = factor_.blocks(); s-- > 0;) {
      const auto rows = static_cast<double>(rowCount(s));
      work += rows * rows * static_cast<double>(width(s));
      if (work > kCheckEvery) {
        RETURN_IF_ERROR(context.check());
        work = 0;
      }
      invert(s);
    }
    return {};
  }

 private:
  std::size_t width(std::size_t s) const {
    return static_cast<std::size_t>(factor_.first_column[s + 1] - factor_.first_column[s]);
  }
  std::size_t rowCount(std::size_t s) const {
    return factor_.first_row[s + 1] - factor_.first_row[s];
  }
  const int* rowsAt(std::size_t s) const { return factor_.rows.data() + factor_.first_row[s]; }
  double* valuesAt(std::size_t s) { return factor_.values.data() + factor_.first_value[s]; }

  static Block blockOf(double* data, std::size_t rows, std::size_t columns, std::size_t stride) {
    return {data, static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns),
            Eigen::OuterStride<>(static_cast<Eigen::Index>(stride))};
  }

  /// The parent of a block has its first row below among its columns, and all others as rows.
  void findParents() {
    std::vector<std::size_t> block_of(factor_.order.size());
    for (std::size_t s = 0; s < factor_.blocks(); ++s) {
      std::fill_n(block_of.begin() + factor_.first_column[s], width(s), s);
    }
    parent_.resize(factor_.blocks());
    place_in_parent_.resize(factor_.rows.size());
    for (std::size_t s = 0; s < factor_.blocks(); ++s) {
      if (rowCount(s) == width(s)) continue;
      const int* row = rowsAt(s);
      parent_[s] = block_of[static_cast<std::size_t>(row[width(s)])];
      const int* of_parent = rowsAt(parent_[s]);
      int place = 0;
      for (std::size_t k = width(s); k < rowCount(s); ++k) {
        while (of_parent[place] < row[k]) ++place;
        place_in_parent_[factor_.first_row[s] + k] = place;
      }
    }
  }

  /// The lower triangle of the inverse on the rows below those of block s, from its ancestors.
  Block gatherBelow(std::size_t s) {
    const std::size_t count = rowCount(s) - width(s);
    const int* row = rowsAt(s) + width(s);
    place_.assign(&place_in_parent_[factor_.first_row[s] + width(s)],
                  &place_in_parent_[factor_.first_row[s]] + rowCount(s));
    std::size_t t = parent_[s];
    for (std::size_t i = 0; i < count;) {
      const int* const places = place_.data();
      for (; i < count && row[i] < factor_.first_column[t + 1]; ++i) {
        const double* from = valuesAt(t) + static_cast<std::size_t>(places[i]) * rowCount(t);
        double* to = below_.data() + i * count;
        for (std::size_t k = i; k < count; ++k) to[k] = from[places[k]];
      }
      if (i == count) break;
      const int* up = &place_in_parent_[factor_.first_row[t]];
      for (std::size_t k = i; k < count; ++k) place_[k] = up[place_[k]];
      t = parent_[t];
    }
    return blockOf(below_.data(), count, count, count);
  }

  void invert(std::size_t s) {
    const std::size_t columns = width(s), rows = rowCount(s), below = rows - columns;
    Block diagonal = blockOf(valuesAt(s), columns, columns, rows);
    Block result = blockOf(square_.data(), columns, columns, columns);
    result.setIdentity();
    divideLeft(diagonal, result);
    divideLeftTransposed(diagonal, result);
    if (below > 0) {
      Block y = blockOf(valuesAt(s) + columns, below, columns, rows);
      divideRight(diagonal, y);
      Block product = blockOf(product_.data(), below, columns, below);
      symmetricProduct(gatherBelow(s), y, product);
      subtractTransposedProduct(y, product, result);
      y = product;
    }
    for (Eigen::Index j = 0; j < result.cols(); ++j) {
      for (Eigen::Index i = j; i < result.rows(); ++i) {
        diagonal(i, j) = diagonal(j, i) = result(i, j);
      }
    }
  }

  BlockFactor& factor_;
  std::vector<std::size_t> parent_;   ///< Per block with rows below.
  std::vector<int> place_in_parent_;  ///< Per row below: its place among those of the parent.
  std::vector<int> place_;
  std::vector<double> below_, product_, square_;
};

}  // namespace

Status invertBlocks(Context& context, BlockFactor& factor) {
  try {
    return Inversion(factor).run(context);
  } catch (const std::bad_alloc&) {
    return outOfMemory();
  }
}

Result<SparseMatrix> entriesOnPattern(const BlockFactor& inverse, const SparseMatrix& pattern) {
  const std::size_t size = inverse.order.size();
  std::vector<int> column_of(size);
  std::vector<std::size_t> block_of(size);
  for (std::size_t k = 0; k < size; ++k) {
    column_of[static_cast<std::size_t>(inverse.order[k])] = static_cast<int>(k);
  }
  for (std::size_t s = 0; s < inverse.blocks(); ++s) {
    std::fill(block_of.begin() + inverse.first_column[s],
              block_of.begin() + inverse.first_column[s + 1], s);
  }
  SparseMatrix result = pattern;
  for (Eigen::Index j = 0; j < pattern.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator it(result, j); it; ++it) {
      const auto [column, row] = std::minmax(column_of[static_cast<std::size_t>(j)],
                                             column_of[static_cast<std::size_t>(it.row())]);
      const std::size_t s = block_of[static_cast<std::size_t>(column)];
      const auto begin = inverse.rows.begin() + static_cast<std::ptrdiff_t>(inverse.first_row[s]);
      const auto end = inverse.rows.begin() + static_cast<std::ptrdiff_t>(inverse.first_row[s + 1]);
      const auto found = std::lower_bound(begin, end, row);
      if (found == end || *found != row) {
        return Status{Reason::kInvalidOption,
                      "the factor has no place for the entry (" + std::to_string(it.row()) + ", " +
                          std::to_string(j) + ") of the inverse",
                      "ask for entries where the matrix has some"};
      }
      const auto in_block = static_cast<std::size_t>(column - inverse.first_column[s]);
      it.valueRef() =
          inverse.values[inverse.first_value[s] + in_block * static_cast<std::size_t>(end - begin) +
                         static_cast<std::size_t>(found - begin)];
    }
  }
  return result;
}

}  // namespace moduli
