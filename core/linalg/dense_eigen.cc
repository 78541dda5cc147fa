#include "core/linalg/dense_eigen.h"

#include <Eigen/Eigenvalues>
#include <utility>
#include <vector>

#ifdef MODULI_WITH_CHOLMOD
extern "C" void dsyevd_(const char* job, const char* triangle, const int* n, double* matrix,
                        const int* stride, double* values, double* work, const int* work_size,
                        int* int_work, const int* int_work_size, int* info);
#endif

namespace moduli {

Result<DenseEigenPairs> denseEigenpairs(Eigen::MatrixXd matrix) {
  const Status failure(Reason::kNoConvergence, "the dense eigen-solver does not converge");
  if (matrix.size() == 0) return DenseEigenPairs{Eigen::VectorXd(), std::move(matrix)};
  if (!matrix.triangularView<Eigen::Lower>().toDenseMatrix().allFinite()) return failure;
#ifdef MODULI_WITH_CHOLMOD
  const int n = static_cast<int>(matrix.rows()), ask = -1;
  DenseEigenPairs pairs{Eigen::VectorXd(n), std::move(matrix)};
  int info = 0, int_size = 0;
  double size = 0;
  dsyevd_("V", "L", &n, pairs.vectors.data(), &n, pairs.values.data(), &size, &ask, &int_size, &ask,
          &info);
  if (info != 0) return failure;
  const int work_size = static_cast<int>(size);
  std::vector<double> work(work_size);
  std::vector<int> int_work(int_size);
  dsyevd_("V", "L", &n, pairs.vectors.data(), &n, pairs.values.data(), work.data(), &work_size,
          int_work.data(), &int_size, &info);
  if (info != 0) return failure;
  return pairs;
#else
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  if (solver.info() != Eigen::Success) return failure;
  return DenseEigenPairs{solver.eigenvalues(), solver.eigenvectors()};
#endif
}

}  // namespace moduli
