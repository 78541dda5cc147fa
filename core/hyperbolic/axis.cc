#include "core/hyperbolic/axis.h"

#include <cmath>

namespace moduli {

// The fixed points z of g satisfy Im(conj(b) z) = Im a, that is: the plane of (Im a, b) passes
// through both; its norm is |b|^2 - (Im a)^2 = sinh(l / 2)^2.
Axis axisOf(const Su11& g) {
  const double scale = std::copysign(std::sinh(translationLength(g) / 2), g.a.real());
  return {g.a.imag() / scale, g.b / scale};
}

double sideOf(const Axis& axis, Complex point) {
  const double square = std::norm(point);
  const double across = 2 * std::imag(std::conj(axis.space) * point);
  return (across - axis.time * (1 + square)) / ((1 - std::abs(point)) * (1 + std::abs(point)));
}

double product(const Axis& a, const Axis& b) {
  return std::real(a.space * std::conj(b.space)) - a.time * b.time;
}

Axis imageOf(const Su11& g, const Axis& axis) {
  // g M g^-1 of the matrix M = [[i time, space], [conj space, -i time]].
  const Complex turn(0, axis.time);
  const Complex upper = g.a * turn + g.b * std::conj(axis.space);
  const Complex right = g.a * axis.space - g.b * turn;
  return {std::imag(upper * std::conj(g.a) - right * std::conj(g.b)), right * g.a - upper * g.b};
}

double footOnDiameter(const Axis& other) {
  // sideOf at (cosh x, sinh x) is -Im(space) sinh x - time cosh x up to sign; stationary there.
  return std::atanh(-other.space.imag() / other.time);
}

}  // namespace moduli
