#include <cholmod.h>

#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <vector>

#include "core/linalg/factor_backend.h"

// OpenBLAS, which this file is linked with explicitly.
extern "C" void openblas_set_num_threads(int num_threads);

// GCC's OpenMP, which CHOLMOD is linked with.
extern "C" int omp_get_max_active_levels();
extern "C" void omp_set_max_active_levels(int levels);

namespace moduli {
namespace {

/// The blocks of OpenBLAS, and with them the last bits of a result, depend on its number of
/// threads. One thread gives the same bytes on any number of cores and under any load; the server
/// runs jobs side by side instead. CHOLMOD's own OpenMP loops copy and clear, without sums.
void useOneBlasThread() {
  static const bool done = (openblas_set_num_threads(1), true);
  static_cast<void>(done);
}

/// CHOLMOD opens OpenMP regions of four threads for every block of columns. They wait for each
/// other longer than they work: on two processors a factorization of 40,000 rows takes 1.7 times as
/// long, one of 130,000 1.4 times. As long as this lives its thread opens none.
class OneOpenMpThread {
 public:
  OneOpenMpThread() : levels_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
  ~OneOpenMpThread() { omp_set_max_active_levels(levels_); }
  OneOpenMpThread(const OneOpenMpThread&) = delete;
  OneOpenMpThread& operator=(const OneOpenMpThread&) = delete;

 private:
  int levels_;
};

/// METIS draws its random numbers from rand(), which all threads of the process share: two
/// orderings at once would disturb each other, and results would depend on the order of requests.
std::mutex& metisMutex() {
  static std::mutex mutex;
  return mutex;
}

/// An ordering that was found for another graph is kept until it costs this much more.
constexpr double kStaleOrdering = 1.25;

struct DenseDeleter {
  cholmod_common* common;
  void operator()(cholmod_dense* dense) const { cholmod_free_dense(&dense, common); }
};

/// CHOLMOD's supernodal L L^T.
class CholmodBackend : public FactorBackend {
 public:
  CholmodBackend() {
    useOneBlasThread();
    cholmod_start(&common_);
    common_.print = 0;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.quick_return_if_not_posdef = 1;
  }

  ~CholmodBackend() override {
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }

  CholmodBackend(const CholmodBackend&) = delete;
  CholmodBackend& operator=(const CholmodBackend&) = delete;

  Status analyze(const SparseMatrix& matrix) override {
    RETURN_IF_ERROR(order(matrix));
    ordered_flops_ = common_.fl;
    return {};
  }

  Status reanalyze(const SparseMatrix& matrix) override {
    if (factor_ == nullptr) return analyze(matrix);
    const auto* permutation = static_cast<const int*>(factor_->Perm);
    std::vector<int> kept(permutation, permutation + factor_->n);
    cholmod_sparse view = viewOf(matrix);
    RETURN_IF_ERROR(analyzeWith(view, CHOLMOD_GIVEN, kept.data()));
    return common_.fl <= kStaleOrdering * ordered_flops_ ? Status() : analyze(matrix);
  }

  Status factorize(const SparseMatrix& matrix) override {
    const OneOpenMpThread alone;
    cholmod_sparse view = viewOf(matrix);
    cholmod_factorize(&view, factor_, &common_);
    if (common_.status == CHOLMOD_NOT_POSDEF || factor_->minor < factor_->n) {
      const std::size_t k = factor_->minor;
      const auto* permutation = static_cast<const int*>(factor_->Perm);
      return notPositiveDefinite(permutation != nullptr ? permutation[k]
                                                        : static_cast<Eigen::Index>(k));
    }
    return failure();
  }

  Result<Eigen::MatrixXd> solve(const Eigen::MatrixXd& b) override {
    const OneOpenMpThread alone;
    cholmod_dense right{};
    right.nrow = static_cast<std::size_t>(b.rows());
    right.ncol = static_cast<std::size_t>(b.cols());
    right.nzmax = static_cast<std::size_t>(b.size());
    right.d = right.nrow;
    right.x = const_cast<double*>(b.data());  // NOLINT: the C interface only reads it
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    const std::unique_ptr<cholmod_dense, DenseDeleter> x(
        cholmod_solve(CHOLMOD_A, factor_, &right, &common_), DenseDeleter{&common_});
    RETURN_IF_ERROR(failure());
    return Eigen::MatrixXd(
        Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(x->x), b.rows(), b.cols()));
  }

  Result<BlockFactor> blocks() override {
    const auto ints = [](const void* begin) { return static_cast<const int*>(begin); };
    const std::size_t ends = factor_->nsuper + 1;
    BlockFactor result;
    try {
      result.order.assign(ints(factor_->Perm), ints(factor_->Perm) + factor_->n);
      result.first_column.assign(ints(factor_->super), ints(factor_->super) + ends);
      result.first_row.assign(ints(factor_->pi), ints(factor_->pi) + ends);
      result.first_value.assign(ints(factor_->px), ints(factor_->px) + ends);
      result.rows.assign(ints(factor_->s), ints(factor_->s) + result.first_row.back());
      const auto* values = static_cast<const double*>(factor_->x);
      result.values.assign(values, values + result.first_value.back());
    } catch (const std::bad_alloc&) {
      return outOfMemory();
    }
    return result;
  }

 private:
  Status order(const SparseMatrix& matrix) {
    cholmod_sparse view = viewOf(matrix);
    RETURN_IF_ERROR(analyzeWith(view, CHOLMOD_AMD));
    // CHOLMOD's own criterion: minimum degree is good unless the factor is costly and much fuller
    // than the matrix; then nested dissection is tried too and the better one of both is kept.
    const double flops = common_.fl;
    const double costly = 500 * common_.lnz;
    const bool full = common_.lnz >= 5.0 * static_cast<double>(matrix.nonZeros());
    if (flops < costly || !full) return {};
    {
      const std::scoped_lock lock(metisMutex());
      RETURN_IF_ERROR(analyzeWith(view, CHOLMOD_METIS));
    }
    return common_.fl <= flops ? Status() : analyzeWith(view, CHOLMOD_AMD);
  }

  static cholmod_sparse viewOf(const SparseMatrix& matrix) {
    cholmod_sparse view{};
    view.nrow = static_cast<std::size_t>(matrix.rows());
    view.ncol = static_cast<std::size_t>(matrix.cols());
    view.nzmax = static_cast<std::size_t>(matrix.nonZeros());
    view.p = const_cast<int*>(matrix.outerIndexPtr());  // NOLINT: only read, as the two below
    view.i = const_cast<int*>(matrix.innerIndexPtr());  // NOLINT
    view.x = const_cast<double*>(matrix.valuePtr());    // NOLINT
    view.stype = -1;
    view.itype = CHOLMOD_INT;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = 1;
    view.packed = 1;
    return view;
  }

  Status analyzeWith(cholmod_sparse& view, int ordering, int* given = nullptr) {
    cholmod_free_factor(&factor_, &common_);
    common_.nmethods = 1;
    common_.method[0].ordering = ordering;
    common_.postorder = 1;
    factor_ = cholmod_analyze_p(&view, given, nullptr, 0, &common_);
    return failure();
  }

  /// The failure that CHOLMOD noted in its last call, if any.
  Status failure() const {
    switch (common_.status) {
      case CHOLMOD_OK:
      case CHOLMOD_DSMALL:
        return {};
      case CHOLMOD_OUT_OF_MEMORY:
        return outOfMemory();
      case CHOLMOD_TOO_LARGE:
        return {Reason::kMeshTooLarge, "the factor has more than 2^31 entries",
                "use a coarser mesh"};
      default:
        return {Reason::kInternal, "CHOLMOD failed with code " + std::to_string(common_.status)};
    }
  }

  cholmod_common common_{};
  cholmod_factor* factor_ = nullptr;
  double ordered_flops_ = 0;  ///< Of the factorization for which the ordering was found.
};

}  // namespace

std::unique_ptr<FactorBackend> makeCholmodBackend() {
  return std::make_unique<CholmodBackend>();
}

}  // namespace moduli
