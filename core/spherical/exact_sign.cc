#include "core/spherical/exact_sign.h"

#include <array>
#include <cmath>
#include <limits>

namespace moduli::spherical {
namespace {

constexpr double kRounding = std::numeric_limits<double>::epsilon() / 2;

/// An exact sum of doubles, kept as terms that do not overlap, smallest first: its sign is that of
/// the last term that is not 0. Source: Shewchuk 1997, "Adaptive precision floating-point
/// arithmetic", section 2.
class ExactSum {
 public:
  void add(double term) {
    for (int i = 0; i < count_; ++i) {
      const double sum = term + terms_[i];
      const double kept = sum - term;
      terms_[i] = (term - (sum - kept)) + (terms_[i] - kept);
      term = sum;
    }
    terms_[count_++] = term;
  }

  /// Adds x y.
  void addProduct(double x, double y) {
    const double product = x * y;
    add(std::fma(x, y, -product));
    add(product);
  }

  /// Adds x y z.
  void addProduct(double x, double y, double z) {
    const double product = x * y;
    addProduct(std::fma(x, y, -product), z);
    addProduct(product, z);
  }

  int sign() const {
    for (int i = count_ - 1; i >= 0; --i) {
      if (terms_[i] != 0) return terms_[i] > 0 ? 1 : -1;
    }
    return 0;
  }

 private:
  std::array<double, 24> terms_{};  ///< Six products of three factors, four terms each.
  int count_ = 0;
};

int signOf(double x) {
  return x > 0 ? 1 : -1;
}

}  // namespace

int orientationSign(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  double determinant = 0, size = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    determinant += a[i] * (b[j] * c[k] - b[k] * c[j]);
    size += std::abs(a[i]) * (std::abs(b[j] * c[k]) + std::abs(b[k] * c[j]));
  }
  if (!std::isfinite(size)) return 0;
  // Each product passes at most six roundings on its way to the determinant, and `size` as many.
  if (std::abs(determinant) > 16 * kRounding * size) return signOf(determinant);
  ExactSum sum;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    sum.addProduct(a[i], b[j], c[k]);
    sum.addProduct(-a[i], b[k], c[j]);
  }
  return sum.sign();
}

int orientationSign(const std::complex<double>& a, const std::complex<double>& b,
                    const std::complex<double>& c) {
  const double left = (b.real() - a.real()) * (c.imag() - a.imag());
  const double right = (b.imag() - a.imag()) * (c.real() - a.real());
  const double size = std::abs(left) + std::abs(right);
  if (!std::isfinite(size)) return 0;
  // Two differences, a product and the last difference: four roundings.
  if (std::abs(left - right) > 8 * kRounding * size) return signOf(left - right);
  ExactSum sum;
  const std::array<std::complex<double>, 3> point = {a, b, c};
  for (int i = 0; i < 3; ++i) {
    const std::complex<double>& from = point[i];
    const std::complex<double>& to = point[(i + 1) % 3];
    sum.addProduct(from.real(), to.imag());
    sum.addProduct(-from.imag(), to.real());
  }
  return sum.sign();
}

}  // namespace moduli::spherical
