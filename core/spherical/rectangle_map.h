#pragma once

#include <array>
#include <complex>

#include "core/base/status.h"
#include "core/spherical/mobius_map.h"

namespace moduli {

/// Carlson's symmetric elliptic integral R_F(x, y, z) = 1/2 int_0^inf dt / sqrt((t + x) (t + y)
/// (t + z)), to rounding, with principal square roots: at most one argument is 0, none is negative
/// but as a limit whose side the sign of its imaginary part tells. Source: Carlson 1995,
/// "Numerical computation of real or complex elliptic integrals".
std::complex<double> carlsonRf(std::complex<double> x, std::complex<double> y,
                               std::complex<double> z);

/// The conformal map of the unit disk to a rectangle, corners a, b, c, d of the unit circle in
/// counter-clockwise order to 0, M, M + i, i, where M is the modulus of the quadrilateral: the
/// Schwarz-Christoffel map, the inverse of Jacobi's sn after a Möbius map. Source: MATH 5.2; Nehari
/// 1952, chapter VI.
class RectangleMap {
 public:
  /// Fails with kInvalidOption where corners are no four points of the circle in that order.
  static Result<RectangleMap> make(const std::array<std::complex<double>, 4>& corners);

  /// Width over height.
  double modulus() const { return modulus_; }
  /// The image of a point of the disk; one on the circle lands exactly on a side.
  std::complex<double> operator()(const std::complex<double>& w, bool on_circle) const;

 private:
  std::complex<double> inverseSine(const std::complex<double>& z) const;

  std::array<std::complex<double>, 4> corners_;
  MobiusMap to_half_plane_;  ///< a, b, c, d to -1, 1, 1 / k, -1 / k.
  double k_ = 0;
  double half_width_ = 0, height_ = 0;  ///< The quarter periods K and K'.
  double modulus_ = 0;
};

}  // namespace moduli
