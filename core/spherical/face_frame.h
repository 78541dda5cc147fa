#pragma once

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace moduli {

/// A triangle laid out in the plane: corner 0 at 0, corner 1 at (base, 0), corner 2 at (x, y).
struct FaceFrame {
  double base = 0, x = 0, y = 0;

  double area() const { return 0.5 * base * y; }

  /// 1 for an equilateral triangle, 0 for one without area.
  double quality() const {
    const double sides2 = base * base + (x - base) * (x - base) + x * x + 2 * y * y;
    return 4 * std::numbers::sqrt3 * area() / sides2;
  }
};

/// sides: |01|, |12|, |20| of a proper triangle. area: its area, by a stable formula.
inline FaceFrame frameFromSides(double side01, double side12, double side20, double area) {
  const double x = 0.5 * ((side20 - side12) * (side20 + side12) / side01 + side01);
  return {side01, x, 2 * area / side01};
}

/// Quasi-conformal K >= 1 of the affine map between two triangles laid out with the same
/// orientation: the ratio of its singular values. Infinite where the target has no area. Source:
/// MATH 9.1.
inline double dilatation(const FaceFrame& from, const FaceFrame& to) {
  const double ux = to.base / from.base;
  const double uy = (to.x - from.x * ux) / from.y;
  const double vy = to.y / from.y;
  const double mu =
      std::abs(std::complex<double>(ux - vy, uy)) / std::abs(std::complex<double>(ux + vy, -uy));
  return mu < 1 ? (1 + mu) / (1 - mu) : std::numeric_limits<double>::infinity();
}

}  // namespace moduli
