#include "tests/bench/yardstick.h"

#include <cholmod.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"

extern "C" void openblas_set_num_threads(int threads);
extern "C" int omp_get_max_active_levels();
extern "C" void omp_set_max_active_levels(int levels);

namespace moduli {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point& mark) {
  const auto now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - mark).count();
  mark = now;
  return seconds;
}

// L + epsilon M: positive definite, and with the pattern of L.
SparseMatrix shiftedLaplacian(const Connectivity& surface, const std::vector<double>& lengths) {
  SparseMatrix matrix = stiffnessMatrix(surface, cotanWeights(surface, lengths));
  const std::vector<double> areas = vertexAreas(surface, lengths);
  double total = 0;
  for (const double area : areas) total += area;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    matrix.coeffRef(v, v) += 1e-8 + areas[v] / total;
  }
  matrix.makeCompressed();
  return matrix;
}

cholmod_sparse viewOf(SparseMatrix& matrix) {
  cholmod_sparse view{};
  view.nrow = view.ncol = static_cast<std::size_t>(matrix.rows());
  view.nzmax = static_cast<std::size_t>(matrix.nonZeros());
  view.p = matrix.outerIndexPtr();
  view.i = matrix.innerIndexPtr();
  view.x = matrix.valuePtr();
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

Yardstick measureOnce(SparseMatrix& matrix, bool& solved) {
  cholmod_common common;
  cholmod_start(&common);
  common.supernodal = CHOLMOD_SUPERNODAL;
  common.print = 0;
  cholmod_sparse view = viewOf(matrix);
  cholmod_dense* ones = cholmod_ones(view.nrow, 1, CHOLMOD_REAL, &common);
  Yardstick time;
  auto mark = Clock::now();
  cholmod_factor* factor = cholmod_analyze(&view, &common);
  time.analyse = secondsSince(mark);
  cholmod_factorize(&view, factor, &common);
  time.factorize = secondsSince(mark);
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor, ones, &common);
  time.solve = secondsSince(mark);
  time.factor_bytes = static_cast<double>(factor->xsize * sizeof(double)) +
                      static_cast<double>(factor->ssize * sizeof(int));
  solved = x != nullptr && common.status == CHOLMOD_OK;
  cholmod_free_dense(&x, &common);
  cholmod_free_dense(&ones, &common);
  cholmod_free_factor(&factor, &common);
  cholmod_finish(&common);
  return time;
}

Result<Yardstick> measureFive(SparseMatrix& matrix) {
  std::array<Yardstick, 5> runs;
  for (Yardstick& run : runs) {
    bool solved = false;
    run = measureOnce(matrix, solved);
    if (!solved)
      return Status(Reason::kNotPositiveDefinite, "CHOLMOD could not solve the yardstick");
  }
  std::sort(runs.begin(), runs.end(),
            [](const Yardstick& a, const Yardstick& b) { return a.total() < b.total(); });
  return runs[2];
}

}  // namespace

Result<Yardstick> measureYardstick(const TriangleMesh& mesh) {
  ASSIGN_OR_RETURN(const MollifiedLengths metric, mollify(mesh.connectivity(), mesh.edgeLengths()));
  SparseMatrix matrix = shiftedLaplacian(mesh.connectivity(), metric.lengths);
  openblas_set_num_threads(1);
  ASSIGN_OR_RETURN(Yardstick yardstick, measureFive(matrix));
  const int levels = omp_get_max_active_levels();
  omp_set_max_active_levels(0);
  const Result<Yardstick> alone = measureFive(matrix);
  omp_set_max_active_levels(levels);
  RETURN_IF_ERROR(alone.status());
  yardstick.alone = alone->total();
  return yardstick;
}

}  // namespace moduli
