#pragma once

#include <Eigen/Core>
#include <complex>

#include "core/matching/torus_map.h"

namespace moduli {

/// Fourier coefficients of the logarithm of a torus' conformal factor, which is constant on faces,
/// by waves in the coordinates of its short basis. Without its mean.
class TorusField {
 public:
  static constexpr int kMost = 16;  ///< Frequencies up to this in either coordinate.

  /// O(F kMost^2).
  TorusField(const CoverSurface& cover, const TorusShape& shape);

  /// 0 where a frequency is too high.
  std::complex<double> at(int k, int l) const {
    if (std::abs(k) > kMost || std::abs(l) > kMost) return 0;
    return values_(k + kMost, l + kMost);
  }
  /// Root of the sum of the squares with frequencies up to `most`.
  double norm(int most) const;

 private:
  Eigen::Matrix<std::complex<double>, 2 * kMost + 1, 2 * kMost + 1> values_;
};

/// The shift in lattice coordinates by which b's field is most like a's under a marking.
struct TorusAlignment {
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  double correlation = -2;
};

/// The best of u -> marking u + shift. By the lowest 8 frequencies on a grid of 64 x 64 shifts, the
/// best of which is refined to 1e-9.
TorusAlignment alignFields(const TorusField& a, const TorusField& b,
                           const Eigen::Matrix2i& marking);

}  // namespace moduli
