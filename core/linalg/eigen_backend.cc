#include <Eigen/SparseCholesky>
#include <cmath>
#include <cstddef>
#include <new>

#include "core/linalg/factor_backend.h"

namespace moduli {
namespace {

/// Eigen's simplicial L D L^T with approximate minimum degree ordering.
class EigenBackend : public FactorBackend {
 public:
  Status analyze(const SparseMatrix& matrix) override {
    return withinMemory([&] { factor_.analyzePattern(matrix); });
  }

  Status factorize(const SparseMatrix& matrix) override {
    RETURN_IF_ERROR(withinMemory([&] { factor_.factorize(matrix); }));
    // Eigen stops at a zero pivot alone and leaves what follows it unset; walking in elimination
    // order meets the first bad pivot before anything unset.
    const auto& pivots = factor_.vectorD();
    for (Eigen::Index k = 0; k < pivots.size(); ++k) {
      if (!(pivots[k] > 0)) return notPositiveDefinite(factor_.permutationPinv().indices()[k]);
    }
    return {};
  }

  Result<Eigen::MatrixXd> solve(const Eigen::MatrixXd& b) override {
    Eigen::MatrixXd x;
    RETURN_IF_ERROR(withinMemory([&] { x = factor_.solve(b); }));
    return x;
  }

  Result<BlockFactor> blocks() override {
    BlockFactor result;
    RETURN_IF_ERROR(withinMemory([&] { result = copyBlocks(); }));
    return result;
  }

 private:
  /// Consecutive columns are one block where each has the rows of the one before but one.
  BlockFactor copyBlocks() const {
    const auto& lower = factor_.matrixL().nestedExpression();  // Without its diagonal of ones.
    const int size = static_cast<int>(lower.cols());
    const auto count = [&](int j) {
      return lower.outerIndexPtr()[j + 1] - lower.outerIndexPtr()[j];
    };
    const auto firstBelow = [&](int j) { return lower.innerIndexPtr()[lower.outerIndexPtr()[j]]; };
    BlockFactor result;
    result.order.resize(static_cast<std::size_t>(size));
    for (int k = 0; k < size; ++k) {
      result.order[static_cast<std::size_t>(k)] = factor_.permutationPinv().indices()[k];
    }
    result.first_row.push_back(0);
    result.first_value.push_back(0);
    result.first_column.push_back(0);
    for (int first = 0; first < size;) {
      int end = first + 1;
      while (end < size && count(end - 1) == count(end) + 1 && firstBelow(end - 1) == end) ++end;
      appendBlock(lower, first, end, result);
      first = end;
    }
    return result;
  }

  template <typename Lower>
  void appendBlock(const Lower& lower, int first, int end, BlockFactor& result) const {
    result.rows.push_back(first);
    const int* inner = lower.innerIndexPtr();
    result.rows.insert(result.rows.end(), inner + lower.outerIndexPtr()[first],
                       inner + lower.outerIndexPtr()[first + 1]);
    for (int j = first; j < end; ++j) {
      const double root = std::sqrt(factor_.vectorD()[j]);
      result.values.insert(result.values.end(), static_cast<std::size_t>(j - first), 0.0);
      result.values.push_back(root);
      for (int at = lower.outerIndexPtr()[j]; at < lower.outerIndexPtr()[j + 1]; ++at) {
        result.values.push_back(lower.valuePtr()[at] * root);
      }
    }
    result.first_column.push_back(end);
    result.first_row.push_back(result.rows.size());
    result.first_value.push_back(result.values.size());
  }

  template <typename Work>
  static Status withinMemory(const Work& work) {
    try {
      work();
    } catch (const std::bad_alloc&) {
      return outOfMemory();
    }
    return {};
  }

  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower> factor_;
};

}  // namespace

std::unique_ptr<FactorBackend> makeEigenBackend() {
  return std::make_unique<EigenBackend>();
}

}  // namespace moduli
