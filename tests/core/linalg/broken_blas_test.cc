// This program brings its own dgemm, dsyrk and dtrsm, which the dynamic linker prefers to those of
// OpenBLAS: CHOLMOD computes with them, and they can be told to compute wrongly.

#include <dlfcn.h>

#include <cmath>

#include "core/linalg/factor_backend.h"
#include "core/linalg/spd_solver.h"
#include "tests/core/linalg/matrices.h"
#include "tests/core/testing.h"

namespace {

struct {
  double error = 0;  ///< Relative error of one entry of every result.
  long calls = 0;
} blas;

template <typename Function>
Function sound(Function, const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// Spoils the last entry on the diagonal of an m x n result.
void spoil(double* c, int m, int n, int stride) {
  ++blas.calls;
  const int last = std::min(m, n) - 1;
  if (blas.error != 0 && last >= 0) c[last + static_cast<long>(last) * stride] *= 1 + blas.error;
}

}  // namespace

extern "C" {

void dgemm_(const char* ta, const char* tb, const int* m, const int* n, const int* k,
            const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
            const double* beta, double* c, const int* ldc) {
  static const auto real = sound(&dgemm_, "dgemm_");
  real(ta, tb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc);
  spoil(c, *m, *n, *ldc);
}

void dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha,
            const double* a, const int* lda, const double* beta, double* c, const int* ldc) {
  static const auto real = sound(&dsyrk_, "dsyrk_");
  real(uplo, trans, n, k, alpha, a, lda, beta, c, ldc);
  spoil(c, *n, *n, *ldc);
}

void dtrsm_(const char* side, const char* uplo, const char* trans, const char* diagonal,
            const int* m, const int* n, const double* alpha, const double* a, const int* lda,
            double* b, const int* ldb) {
  static const auto real = sound(&dtrsm_, "dtrsm_");
  real(side, uplo, trans, diagonal, m, n, alpha, a, lda, b, ldb);
  spoil(b, *m, *n, *ldb);
}

}  // extern "C"

namespace moduli {
namespace {

struct Outcome {
  Status status;
  double error = 0;
};

Outcome solveWith(double blas_error) {
  const SparseMatrix matrix = gridLaplacian({60, 60, 1}, 1e-3);
  const Eigen::MatrixXd expected = randomMatrix(matrix.rows(), 3, 1);
  Context context;
  blas.error = blas_error;
  auto solver = SpdSolver::make(context, matrix, makeBackend(BackendKind::kCholmod));
  if (!solver.ok()) return {solver.status()};
  const auto x =
      solver->solve(context, Eigen::MatrixXd(matrix.selfadjointView<Eigen::Lower>() * expected));
  if (!x.ok()) return {x.status()};
  return {{}, (*x - expected).cwiseAbs().maxCoeff()};
}

TEST(BrokenBlas, IsReallyCalledAndSoundWithoutAFault) {
  blas.calls = 0;
  const Outcome outcome = solveWith(0);
  EXPECT_OK(outcome.status);
  EXPECT_GT(blas.calls, 0) << "CHOLMOD does not call the BLAS of this program";
  EXPECT_LT(outcome.error, 1e-10);
}

TEST(BrokenBlas, GrossErrorsGiveAnErrorNotNumbers) {
  for (const double error : {-2.0, -1.0, -0.5, 0.3, 1.0, 1e6}) {
    EXPECT_FALSE(solveWith(error).status.ok()) << error;
  }
}

TEST(BrokenBlas, WrongAnswersAreRepairedOrRefused) {
  int refused = 0;
  for (double error = 1e-15; error < 2; error *= 10) {
    const Outcome outcome = solveWith(error);
    if (outcome.status.ok()) {
      // Accepted residuals are below 1e-12 and the condition number is below 1e4.
      EXPECT_LT(outcome.error, 1e-8) << error;
    } else if (outcome.status.reason() == Reason::kResidualTooLarge) {
      ++refused;
    } else {
      // The fault may also break the factorization itself.
      EXPECT_THAT(outcome.status, FailsWith(Reason::kNotPositiveDefinite)) << error;
    }
  }
  EXPECT_GT(refused, 0);
}

// Of a sound factor: the inverse is judged on its own.
TEST(BrokenBlas, WrongInversesAreRefused) {
  const SparseMatrix matrix = gridLaplacian({60, 60, 1}, 1e-3);
  Context context;
  blas.error = 0;
  auto solver = SpdSolver::make(context, matrix, makeBackend(BackendKind::kCholmod));
  ASSERT_OK(solver);
  const auto sound = solver->inverseOnPattern(context, matrix);
  ASSERT_OK(sound);
  for (double error = 1e-6; error < 2; error *= 10) {
    blas.error = error;
    blas.calls = 0;
    EXPECT_THAT(solver->inverseOnPattern(context, matrix), FailsWith(Reason::kResidualTooLarge));
    EXPECT_GT(blas.calls, 0);
  }
  blas.error = 0;
}

}  // namespace
}  // namespace moduli
