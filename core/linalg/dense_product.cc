#include "core/linalg/dense_product.h"

#include <algorithm>

#ifdef MODULI_WITH_CHOLMOD
extern "C" void dgemm_(const char* transposed_a, const char* transposed_b, const int* rows,
                       const int* columns, const int* inner, const double* alpha, const double* a,
                       const int* stride_a, const double* b, const int* stride_b,
                       const double* beta, double* c, const int* stride_c);
extern "C" void sgemm_(const char* transposed_a, const char* transposed_b, const int* rows,
                       const int* columns, const int* inner, const float* alpha, const float* a,
                       const int* stride_a, const float* b, const int* stride_b, const float* beta,
                       float* c, const int* stride_c);
#endif

namespace moduli {
namespace {

#ifdef MODULI_WITH_CHOLMOD
/// BLAS wants strides of at least 1 even of empty matrices.
template <typename Matrix>
int strideOf(const Matrix& matrix) {
  return static_cast<int>(std::max<Eigen::Index>(1, matrix.outerStride()));
}
#endif

}  // namespace

Eigen::MatrixXd transposedProduct(const Columns& a, const Columns& b) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(a.cols(), b.cols());
  if (result.size() == 0 || a.rows() == 0) return result;
#ifdef MODULI_WITH_CHOLMOD
  const int rows = static_cast<int>(a.cols()), columns = static_cast<int>(b.cols());
  const int inner = static_cast<int>(a.rows()), stride_a = strideOf(a), stride_b = strideOf(b);
  const double one = 1, zero = 0;
  dgemm_("T", "N", &rows, &columns, &inner, &one, a.data(), &stride_a, b.data(), &stride_b, &zero,
         result.data(), &rows);
#else
  result.noalias() = a.transpose() * b;
#endif
  return result;
}

Eigen::MatrixXf transposedProduct(const Eigen::Ref<const Eigen::MatrixXf>& a,
                                  const Eigen::Ref<const Eigen::MatrixXf>& b) {
  if (a.rows() == 0) return Eigen::MatrixXf::Zero(a.cols(), b.cols());
  Eigen::MatrixXf result(a.cols(), b.cols());
  if (result.size() == 0) return result;
#ifdef MODULI_WITH_CHOLMOD
  const int rows = static_cast<int>(a.cols()), columns = static_cast<int>(b.cols());
  const int inner = static_cast<int>(a.rows()), stride_a = strideOf(a), stride_b = strideOf(b);
  const float one = 1, zero = 0;
  sgemm_("T", "N", &rows, &columns, &inner, &one, a.data(), &stride_a, b.data(), &stride_b, &zero,
         result.data(), &rows);
#else
  result.noalias() = a.transpose() * b;
#endif
  return result;
}

void addProduct(double scale, const Columns& a, const Columns& b, Eigen::MatrixXd& c) {
  if (c.size() == 0 || a.cols() == 0) return;
#ifdef MODULI_WITH_CHOLMOD
  const int rows = static_cast<int>(c.rows()), columns = static_cast<int>(c.cols());
  const int inner = static_cast<int>(a.cols()), stride_a = strideOf(a), stride_b = strideOf(b);
  const double one = 1;
  dgemm_("N", "N", &rows, &columns, &inner, &scale, a.data(), &stride_a, b.data(), &stride_b, &one,
         c.data(), &rows);
#else
  c.noalias() += scale * (a * b);
#endif
}

}  // namespace moduli
