#include <Eigen/SparseCholesky>
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

 private:
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
