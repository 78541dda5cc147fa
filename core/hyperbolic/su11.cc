#include "core/hyperbolic/su11.h"

#include <algorithm>
#include <cmath>

namespace moduli {
namespace {

/// sinh(l / 2)^2 of an element with an axis, from the entries that are small near 1.
double squaredSine(const Su11& g) {
  const double b = std::abs(g.b);
  const double turn = std::abs(g.a.imag());
  return (b - turn) * (b + turn);
}

/// sinh(l / 2) where it is positive.
double axisSine(const Su11& g) {
  return std::sinh(translationLength(g) / 2);
}

double entryDistance(const Su11& g, const Su11& h) {
  return std::max(std::abs(g.a - h.a), std::abs(g.b - h.b));
}

}  // namespace

double determinantDrift(const Su11& g) {
  const double a = std::abs(g.a);
  const double b = std::abs(g.b);
  return (a - b) * (a + b) - 1;
}

Su11 renormalized(const Su11& g) {
  return {g.a * (std::hypot(1.0, std::abs(g.b)) / std::abs(g.a)), g.b};
}

Complex imageOf(const Su11& g, Complex z) {
  return (g.a * z + g.b) / (std::conj(g.b) * z + std::conj(g.a));
}

double distanceUpToSign(const Su11& g, const Su11& h) {
  return std::min(entryDistance(g, h), entryDistance(g, -h));
}

double distanceToUnit(const Su11& g) {
  return distanceUpToSign(g, Su11{});
}

double displacement(const Su11& g) {
  return 2 * std::asinh(std::abs(g.b));
}

bool sameElement(const Su11& g, const Su11& h) {
  return std::norm((inverse(h) * g).b) < 1e-9;
}

double translationLength(const Su11& g) {
  const double cosine = std::abs(g.a.real());
  // An error of 1e-16 |a| in each entry moves l by 2e-16 |a| / sinh(l / 2) through the cosine and
  // by 2e-16 |b|^2 / (sinh(l / 2) cosh(l / 2)) through the sine.
  if (std::norm(g.b) < std::abs(g.a) * cosine) {
    const double square = squaredSine(g);
    return square > 0 ? 2 * std::asinh(std::sqrt(square)) : 0;
  }
  return cosine > 1 ? 2 * std::acosh(cosine) : 0;
}

std::array<Complex, 2> axisEnds(const Su11& g) {
  // conj(b) z^2 - 2 i Im(a) z - b = 0; the multiplier at z is (Re a +- s)^-2.
  const double s = std::copysign(axisSine(g), g.a.real());
  const Complex attracting = Complex(s, g.a.imag()) / std::conj(g.b);
  const Complex repelling = Complex(-s, g.a.imag()) / std::conj(g.b);
  return {repelling / std::abs(repelling), attracting / std::abs(attracting)};
}

double signedDistanceToAxis(const Su11& g) {
  return -std::asinh(std::copysign(1.0, g.a.real()) * g.a.imag() / axisSine(g));
}

Su11 rotation(double angle) {
  return {std::polar(1.0, angle / 2), 0};
}

Su11 translation(double length) {
  return {std::cosh(length / 2), std::sinh(length / 2)};
}

Su11 translation(Complex repelling, Complex attracting, double length) {
  const double s = std::sinh(length / 2);
  const Complex chord = attracting - repelling;
  // The sum of two points of the circle is a real multiple of i times their difference.
  const double turn = ((attracting + repelling) / chord).imag();
  return renormalized({{std::cosh(length / 2), s * turn}, std::conj(2 * s / chord)});
}

Su11 translationTo(Complex p) {
  const double radius = std::abs(p);
  const double scale = 1 / std::sqrt((1 - radius) * (1 + radius));
  return {scale, scale * p};
}

Su11 edgeFrame(Complex p, Complex q) {
  const Su11 there = translationTo(p);
  return there * rotation(std::arg(imageOf(inverse(there), q)));
}

Su11 edgeHalfTurn(double length) {
  // T diag(i, -i) T^-1 with the translation T by l / 2.
  return {{0, std::cosh(length / 2)}, {0, -std::sinh(length / 2)}};
}

double hyperbolicDistance(Complex p, Complex q) {
  const auto height = [](Complex z) { return (1 - std::abs(z)) * (1 + std::abs(z)); };
  return 2 * std::asinh(std::abs(p - q) / (std::sqrt(height(p)) * std::sqrt(height(q))));
}

}  // namespace moduli
