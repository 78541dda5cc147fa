#include "core/spherical/mobius_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace moduli {
namespace {

using Complex = MobiusMap::Complex;

/// Homogeneous coordinates of a point: z = first / second. Both 0 for what is no point.
struct Homogeneous {
  Complex first, second;
};

Homogeneous homogeneous(const Complex& z) {
  if (std::isinf(z.real()) || std::isinf(z.imag())) return {1, 0};
  if (std::isnan(z.real()) || std::isnan(z.imag())) return {0, 0};
  const double size = std::max(std::abs(z.real()), std::abs(z.imag()));
  return size > 1 ? Homogeneous{z / size, 1 / size} : Homogeneous{z, 1};
}

/// Of the two formulas, which are equal on the sphere, the one whose entries are large.
Homogeneous homogeneous(const Eigen::Vector3d& point) {
  if (!point.allFinite()) return {0, 0};
  const Complex across(point.x(), point.y());
  return point.z() > 0 ? Homogeneous{1 + point.z(), std::conj(across)}
                       : Homogeneous{across, 1 - point.z()};
}

Homogeneous image(const MobiusMap& map, const Homogeneous& h) {
  return {map.a * h.first + map.b * h.second, map.c * h.first + map.d * h.second};
}

Complex determinant(const Homogeneous& x, const Homogeneous& y) {
  return x.first * y.second - x.second * y.first;
}

double size(const Homogeneous& x) {
  return std::hypot(std::abs(x.first), std::abs(x.second));
}

/// Whether two points are one, to rounding.
bool equal(const Homogeneous& x, const Homogeneous& y) {
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  return !(std::abs(determinant(x, y)) > kRounding * size(x) * size(y));
}

/// The map that carries infinity, 0 and 1 to three points.
Result<MobiusMap> fromStandard(const std::array<Homogeneous, 3>& to) {
  for (int i = 0; i < 3; ++i) {
    if (equal(to[i], to[(i + 1) % 3])) {
      return Status(Reason::kInvalidOption,
                    "a Moebius map is fixed by three different points, and two of these are equal");
    }
  }
  // The columns are multiples of the images of infinity and 0 whose sum is the image of 1.
  const Complex first = determinant(to[2], to[1]), second = determinant(to[0], to[2]);
  return makeMobiusMap(first * to[0].first, second * to[1].first, first * to[0].second,
                       second * to[1].second);
}

template <typename Point>
Result<MobiusMap> through(const std::array<Point, 3>& from, const std::array<Point, 3>& to) {
  ASSIGN_OR_RETURN(const MobiusMap start, fromStandard({homogeneous(from[0]), homogeneous(from[1]),
                                                        homogeneous(from[2])}));
  ASSIGN_OR_RETURN(const MobiusMap end,
                   fromStandard({homogeneous(to[0]), homogeneous(to[1]), homogeneous(to[2])}));
  return compose(end, start.inverse());
}

MobiusMap scaled(const MobiusMap& map, const Complex& factor) {
  return {map.a * factor, map.b * factor, map.c * factor, map.d * factor};
}

}  // namespace

Complex MobiusMap::operator()(const Complex& z) const {
  const Homogeneous h = image(*this, homogeneous(z));
  if (h.second == 0.0) {
    const double infinity = std::numeric_limits<double>::infinity();
    return h.first == 0.0 ? Complex(std::nan(""), std::nan("")) : Complex(infinity, 0);
  }
  return h.first / h.second;
}

Eigen::Vector3d MobiusMap::operator()(const Eigen::Vector3d& point) const {
  Homogeneous h = image(*this, homogeneous(point));
  const double length = size(h);
  h = {h.first / length, h.second / length};
  const Complex across = 2.0 * h.first * std::conj(h.second);
  const double first = std::abs(h.first), second = std::abs(h.second);
  return Eigen::Vector3d(across.real(), across.imag(), (first - second) * (first + second))
      .normalized();
}

bool MobiusMap::keepsDisk(double tolerance) const {
  const double off = std::max(std::abs(d - std::conj(a)), std::abs(c - std::conj(b)));
  return off <= tolerance * (std::abs(a) + std::abs(b));
}

MobiusMap compose(const MobiusMap& then, const MobiusMap& first) {
  const MobiusMap product = {
      then.a * first.a + then.b * first.c, then.a * first.b + then.b * first.d,
      then.c * first.a + then.d * first.c, then.c * first.b + then.d * first.d};
  // The determinant differs from 1 by rounding of products of this size; where it is lost in that,
  // to divide by it would only add to the damage.
  const double entries =
      std::norm(product.a) + std::norm(product.b) + std::norm(product.c) + std::norm(product.d);
  const Complex det = product.a * product.d - product.b * product.c;
  return entries < 1e12 ? scaled(product, 1.0 / std::sqrt(det)) : product;
}

Result<MobiusMap> makeMobiusMap(Complex a, Complex b, Complex c, Complex d) {
  const double size = std::max({std::abs(a), std::abs(b), std::abs(c), std::abs(d)});
  if (!(size > 0) || !std::isfinite(size)) {
    return Status(Reason::kInvalidOption,
                  "the coefficients of a Moebius map must be finite and "
                  "not all 0");
  }
  const MobiusMap map = scaled({a, b, c, d}, 1 / size);
  const Complex det = map.a * map.d - map.b * map.c;
  if (!(std::abs(det) > 4 * std::numeric_limits<double>::epsilon())) {
    return Status(Reason::kInvalidOption, "a Moebius map needs a determinant other than 0");
  }
  return scaled(map, 1.0 / std::sqrt(det));
}

Result<MobiusMap> mobiusThrough(const std::array<Complex, 3>& from,
                                const std::array<Complex, 3>& to) {
  return through(from, to);
}

Result<MobiusMap> mobiusThrough(const std::array<Eigen::Vector3d, 3>& from,
                                const std::array<Eigen::Vector3d, 3>& to) {
  return through(from, to);
}

MobiusMap diskAutomorphism(const Complex& w0, double angle) {
  const double r = std::abs(w0);
  const Complex a = std::polar(1 / std::sqrt((1 - r) * (1 + r)), angle / 2);
  const Complex b = -a * w0;
  return {a, b, std::conj(b), std::conj(a)};
}

MobiusMap halfPlaneToDisk(const Complex& z0) {
  // The determinant z0 - conj z0 is 2 i Im z0.
  const Complex scale = 1.0 / std::sqrt(Complex(0, 2 * z0.imag()));
  return {scale, -scale * z0, scale, -scale * std::conj(z0)};
}

}  // namespace moduli
