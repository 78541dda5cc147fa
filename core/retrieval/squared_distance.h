#pragma once

#include <cstddef>
#include <limits>

namespace moduli {

/// Squared Euclidean distance of two float32 rows, summed in double precision: relative error below
/// (size + 2) 2^-53. Always the same order of summation, so that every index gives the same bits.
/// Gives up with a partial sum as soon as that exceeds `limit`.
inline double squaredDistance(const float* a, const float* b, std::size_t size,
                              double limit = std::numeric_limits<double>::infinity()) {
  double sum = 0;
  std::size_t i = 0;
  for (; i + 4 <= size; i += 4) {
    const double d0 = static_cast<double>(a[i]) - b[i];
    const double d1 = static_cast<double>(a[i + 1]) - b[i + 1];
    const double d2 = static_cast<double>(a[i + 2]) - b[i + 2];
    const double d3 = static_cast<double>(a[i + 3]) - b[i + 3];
    sum += (d0 * d0 + d1 * d1) + (d2 * d2 + d3 * d3);
    if (sum > limit) return sum;
  }
  for (; i < size; ++i) {
    const double d = static_cast<double>(a[i]) - b[i];
    sum += d * d;
  }
  return sum;
}

}  // namespace moduli
