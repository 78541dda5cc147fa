#include "core/spherical/rectangle_map.h"

#include <algorithm>
#include <cmath>

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// The series that ends Carlson's duplication errs by some deviation^6.
constexpr double kDeviation = 2e-3;
constexpr double kOnCircle = 1e-6;

}  // namespace

std::complex<double> carlsonRf(Complex x, Complex y, Complex z) {
  Complex mean = (x + y + z) / 3.0;
  double deviation = std::max({std::abs(mean - x), std::abs(mean - y), std::abs(mean - z)});
  while (deviation > kDeviation * std::abs(mean)) {
    const Complex rx = std::sqrt(x), ry = std::sqrt(y), rz = std::sqrt(z);
    const Complex lambda = rx * ry + ry * rz + rz * rx;
    x = (x + lambda) / 4.0;
    y = (y + lambda) / 4.0;
    z = (z + lambda) / 4.0;
    mean = (x + y + z) / 3.0;
    deviation = std::max({std::abs(mean - x), std::abs(mean - y), std::abs(mean - z)});
  }
  const Complex dx = 1.0 - x / mean, dy = 1.0 - y / mean, dz = -dx - dy;
  const Complex e2 = dx * dy - dz * dz, e3 = dx * dy * dz;
  return (1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0 - 3.0 * e2 * e3 / 44.0) / std::sqrt(mean);
}

Result<RectangleMap> RectangleMap::make(const std::array<Complex, 4>& corners) {
  const auto& [a, b, c, d] = corners;
  const auto turn = [](const Complex& from, const Complex& to) {
    const double angle = std::arg(to / from);
    return angle > 0 ? angle : angle + 2 * M_PI;
  };
  for (const Complex& corner : corners) {
    if (!(std::abs(std::abs(corner) - 1) < kOnCircle)) {
      return Status{Reason::kInvalidOption, "a corner of the rectangle is not on the circle"};
    }
  }
  if (!(turn(a, b) < turn(a, c) && turn(a, c) < turn(a, d)) || a == b || b == c || c == d) {
    return Status{Reason::kInvalidOption,
                  "the corners are not in the order of the boundary, the surface on its left"};
  }
  RectangleMap map;
  map.corners_ = corners;
  // Ptolemy: |ab| |cd| + |bc| |da| = |ac| |bd|. The ratios are 4 k / (1 + k)^2 and its complement.
  const double ab_cd = std::abs(a - b) * std::abs(c - d), bc_da = std::abs(b - c) * std::abs(d - a);
  const double s = std::sqrt(bc_da / (ab_cd + bc_da));
  map.k_ = ab_cd / (ab_cd + bc_da) / ((1 + s) * (1 + s));
  const double complement = 4 * s / ((1 + s) * (1 + s));  // 1 - k^2
  map.half_width_ = carlsonRf(0, complement, 1).real();
  map.height_ = carlsonRf(0, map.k_ * map.k_, 1).real();
  map.modulus_ = 2 * map.half_width_ / map.height_;
  if (!std::isfinite(map.modulus_) || !(map.modulus_ > 0)) {
    return Status{Reason::kInvalidOption, "two corners of the rectangle are one point"};
  }
  ASSIGN_OR_RETURN(map.to_half_plane_, mobiusThrough(std::array<Complex, 3>{a, b, c},
                                                     std::array<Complex, 3>{Complex(-1), Complex(1),
                                                                            Complex(1 / map.k_)}));
  return map;
}

/// The integral of dt / sqrt((1 - t^2) (1 - k^2 t^2)) from 0 to z in the closed upper half plane,
/// |z| <= 1 / sqrt(k).
Complex RectangleMap::inverseSine(const Complex& z) const {
  // Signed zeros tell the side of the real axis: 1 - z^2 is the limit from above.
  const Complex z2 = z * z;
  const Complex x(1 - z2.real(), -z2.imag());
  const Complex y(1 - k_ * k_ * z2.real(), -k_ * k_ * z2.imag());
  return z * carlsonRf(x, y, 1.0);
}

Complex RectangleMap::operator()(const Complex& w, bool on_circle) const {
  if (w == corners_[0]) return 0;
  if (w == corners_[1]) return modulus_;
  if (w == corners_[2]) return {modulus_, 1};
  if (w == corners_[3]) return {0, 1};
  Complex z = to_half_plane_(w);
  if (on_circle) z = {z.real(), 0.0};
  const bool far = !(std::abs(z) * std::sqrt(k_) <= 1);
  Complex u;
  if (far) {
    // sn(u + i K') = 1 / (k sn u), in the lower half plane.
    const bool infinite = !std::isfinite(z.real()) || !std::isfinite(z.imag());
    const Complex other = infinite ? Complex(0) : std::conj(1.0 / (k_ * z));
    const Complex near =
        on_circle ? Complex(other.real(), 0.0) : Complex(other.real(), std::max(0.0, other.imag()));
    u = Complex(0, height_) + std::conj(inverseSine(near));
  } else {
    u = inverseSine({z.real(), std::max(0.0, z.imag())});
  }
  Complex image = (u + half_width_) / height_;
  if (!on_circle) return image;
  const double x = std::abs(z.real());
  if (x <= 1) {
    image.imag(0);
  } else if (!(x < 1 / k_)) {
    image.imag(1);
  } else {
    image.real(z.real() > 0 ? modulus_ : 0);
  }
  return image;
}

}  // namespace moduli
