#include "core/forms/modular.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace moduli {
namespace {

/// How near to the border of the fundamental domain, in hyperbolic length, a point counts as on it:
/// a hundred times what rounding does to the period of a mesh, so that symmetric tori, which lie on
/// the border, fall on the same side under every numbering.
constexpr double kBorder = 1e-12;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// x - n y, false on overflow.
bool subtractMultiple(long long& x, long long n, long long y) {
  long long product = 0;
  return !__builtin_mul_overflow(n, y, &product) && !__builtin_sub_overflow(x, product, &x);
}

/// A point on its way into the fundamental domain, with the element that brought it there.
struct Traveller {
  Complex tau;
  ModularMatrix m;

  /// tau -> tau - n.
  bool translate(double n) {
    if (!(std::abs(n) < 0x1p62)) return false;
    tau = {tau.real() - n, tau.imag()};
    const auto steps = static_cast<long long>(n);
    return subtractMultiple(m.a, steps, m.c) && subtractMultiple(m.b, steps, m.d);
  }

  /// tau -> -1 / tau.
  bool invert() {
    tau = -1.0 / tau;
    m = {-m.c, -m.d, m.a, m.b};
    return std::isfinite(tau.real()) && std::isfinite(tau.imag()) && tau.imag() > 0;
  }

  /// Ends: each inversion raises Im tau, and at least doubles it while it is below 1/2, for then
  /// |tau|^2 <= 1/4 + (Im tau)^2 < 1/2.
  bool enterDomain() {
    while (true) {
      if (!translate(std::round(tau.real()))) return false;
      if (std::abs(tau) >= 1 - kBorder) return true;
      if (!invert()) return false;
    }
  }

  bool chooseSide() {
    if (tau.real() < -0.5 + kBorder * tau.imag() && !translate(-1)) return false;
    if (std::abs(tau) <= 1 + kBorder && tau.real() < 0 && !invert()) return false;
    tau += 0.0;  // No negative zero.
    return true;
  }
};

/// Klein's j as a quotient that neither overflows nor divides by zero.
struct KleinQuotient {
  Complex numerator;    ///< E_4^3.
  Complex denominator;  ///< The discriminant q prod (1 - q^n)^24.
};

/// tau: reduced, so that |q| <= exp(-pi sqrt 3) = 0.0044 and eight terms reach 1e-17.
KleinQuotient kleinQuotient(Complex tau) {
  const Complex q = std::exp(Complex(0, 2 * std::numbers::pi) * tau);
  Complex power = 1;
  Complex sum = 0;
  Complex product = 1;
  for (int n = 1; n <= 8; ++n) {
    power *= q;
    sum += static_cast<double>(n * n * n) * power / (1.0 - power);
    product *= 1.0 - power;
  }
  const Complex e4 = 1.0 + 240.0 * sum;
  const Complex p2 = product * product;
  const Complex p4 = p2 * p2;
  const Complex p8 = p4 * p4;
  return {e4 * e4 * e4, q * p8 * p8 * p8};
}

/// Half the hyperbolic distance in the upper half plane.
double halfDistance(Complex a, Complex b) {
  return std::asinh(std::abs(a - b) / (2 * std::sqrt(a.imag()) * std::sqrt(b.imag())));
}

}  // namespace

Result<ReducedTau> reduceToFundamentalDomain(Complex tau) {
  if (!std::isfinite(tau.real()) || !std::isfinite(tau.imag()) || !(tau.imag() > 0)) {
    return Status{Reason::kInvalidOption, "tau is not in the upper half plane"};
  }
  Traveller traveller{tau, {}};
  if (!traveller.enterDomain() || !traveller.chooseSide()) {
    return Status{Reason::kOverflow, "tau is too far from the fundamental domain for 64 bits"};
  }
  return ReducedTau{traveller.tau, traveller.m};
}

Complex jInvariant(Complex tau) {
  const auto reduced = reduceToFundamentalDomain(tau);
  if (!reduced.ok()) return {kNaN, kNaN};
  const KleinQuotient j = kleinQuotient(reduced->tau);
  const Complex value = j.numerator / j.denominator;
  if (std::isfinite(value.real()) && std::isfinite(value.imag())) return value;
  return {std::numeric_limits<double>::infinity(), 0};
}

// It is enough to look at w, -1/w, -1/(w + 1) and -1/(w - 1), each translated next to z, where z
// and w are the reduced points and w is the lower one.
//
// Proof. Let z = x1 + i y1 and w = x2 + i y2 with y1 >= y2 >= sqrt(3)/2 and let d0 be the distance
// of z from the translate of w next to it. Their real parts differ by at most 1/2, so
//   e^{d0} <= 2 cosh d0 <= 2 + (1/4 + (y1 - y2)^2) / (y1 y2) = y1/y2 + y2/y1 + 1 / (4 y1 y2).
// If g = [[a, b], [c, d]] brings w nearer than d0, then Im(g w) = y2 / |c w + d|^2 >= y1 e^{-d0},
// for heights differ by a factor of at most e^distance. Hence
//   |c w + d|^2 <= (y2/y1) e^{d0} <= 1 + (y2/y1)^2 + 1 / (4 y1^2) <= 7/3.
// |c w + d|^2 >= c^2 y2^2 >= 3 c^2 / 4 leaves c = 0 (translations) and c = 1 up to sign; then
// (x2 + d)^2 <= 7/3 - 3/4 < 1.26^2 and |x2| <= 1/2 leave d in {-1, 0, 1}. With (c, d) given, g is
// known up to a translation, and among translates of a point the one with the nearest real part is
// nearest to z. The margin to |x2 + d| < 1.5 absorbs points on the border.
double teichmullerDistance(Complex tau1, Complex tau2) {
  const auto first = reduceToFundamentalDomain(tau1);
  const auto second = reduceToFundamentalDomain(tau2);
  if (!first.ok() || !second.ok()) return kNaN;
  Complex z = first->tau;
  Complex w = second->tau;
  if (z.imag() < w.imag()) std::swap(z, w);
  const auto distanceTo = [z](Complex point) {
    const double n = std::round(z.real() - point.real());
    return halfDistance(z, {point.real() + n, point.imag()});
  };
  return std::min({distanceTo(w), distanceTo(-1.0 / w), distanceTo(-1.0 / (w + 1.0)),
                   distanceTo(-1.0 / (w - 1.0))});
}

std::array<double, 4> modularFeatures(Complex tau) {
  const auto reduced = reduceToFundamentalDomain(tau);
  if (!reduced.ok()) return {kNaN, kNaN, kNaN, kNaN};
  const KleinQuotient j = kleinQuotient(reduced->tau);
  // The sphere point of p / r without the division: w = j / 1728 may be 0 or infinite.
  const Complex p = j.numerator;
  const Complex r = 1728.0 * j.denominator;
  const double norm = std::norm(p) + std::norm(r);
  const Complex equatorial = 2.0 * p * std::conj(r) / norm;
  return {equatorial.real(), equatorial.imag(), (std::norm(p) - std::norm(r)) / norm,
          std::log(reduced->tau.imag())};
}

}  // namespace moduli
