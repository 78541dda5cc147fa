#include "core/topology/integer_matrix.h"

namespace moduli {

Status integerOverflow() {
  return {Reason::kOverflow, "a change of basis has entries above 2^63",
          "the surface is too long and thin for its periods to be found"};
}

Status addRow(IntegerMatrix& matrix, Eigen::Index to, Integer times, Eigen::Index from) {
  for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
    Integer product = 0;
    if (__builtin_mul_overflow(times, matrix(from, c), &product) ||
        __builtin_add_overflow(matrix(to, c), product, &matrix(to, c))) {
      return integerOverflow();
    }
  }
  return {};
}

Result<IntegerMatrix> multiply(const IntegerMatrix& a, const IntegerMatrix& b) {
  IntegerMatrix result = IntegerMatrix::Zero(a.rows(), b.cols());
  for (Eigen::Index c = 0; c < b.cols(); ++c) {
    for (Eigen::Index k = 0; k < b.rows(); ++k) {
      if (b(k, c) == 0) continue;
      for (Eigen::Index r = 0; r < a.rows(); ++r) {
        Integer product = 0;
        if (__builtin_mul_overflow(a(r, k), b(k, c), &product) ||
            __builtin_add_overflow(result(r, c), product, &result(r, c))) {
          return integerOverflow();
        }
      }
    }
  }
  return result;
}

IntegerMatrix standardSymplecticForm(Eigen::Index g) {
  IntegerMatrix form = IntegerMatrix::Zero(2 * g, 2 * g);
  for (Eigen::Index i = 0; i < g; ++i) {
    form(i, g + i) = 1;
    form(g + i, i) = -1;
  }
  return form;
}

bool isSymplectic(const IntegerMatrix& r) {
  if (r.rows() != r.cols() || r.rows() % 2 != 0) return false;
  const IntegerMatrix form = standardSymplecticForm(r.rows() / 2);
  const auto left = multiply(r, form);
  if (!left.ok()) return false;
  const auto image = multiply(*left, r.transpose());
  return image.ok() && *image == form;
}

}  // namespace moduli
