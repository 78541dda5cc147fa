#include "core/hyperbolic/axis.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace moduli {

// The fixed points z of g satisfy Im(conj(b) z) = Im a, that is: the plane with the normal (Im a, i
// b) passes through both; its square is |b|^2 - (Im a)^2 = sinh(l / 2)^2.
Axis axisOf(const Su11& g) {
  const double scale = std::copysign(std::sinh(translationLength(g) / 2), g.a.real());
  return {g.a.imag() / scale, Complex(0, 1) * g.b / scale};
}

double sideOf(const Axis& axis, Complex point) {
  const double across = 2 * std::real(std::conj(axis.space) * point);
  const double radius = std::abs(point);
  return (across - axis.time * (1 + radius * radius)) / ((1 - radius) * (1 + radius));
}

double sideOfPoint(const Axis& axis, const Point& point) {
  return std::real(std::conj(axis.space) * point.space) - axis.time * point.time;
}

double product(const Axis& a, const Axis& b) {
  return std::real(a.space * std::conj(b.space)) - a.time * b.time;
}

bool sameAxis(const Axis& a, const Axis& b) {
  const double tolerance = 1e-7 * (1 + std::abs(a.time));
  const auto near = [&](double sign) {
    return std::abs(a.time - sign * b.time) + std::abs(a.space - sign * b.space) < tolerance;
  };
  return near(1) || near(-1);
}

Axis imageOf(const Su11& g, const Axis& axis) {
  // g M g^-1 of the matrix M = [[i time, -i space], [i conj space, -i time]], divided by i.
  const Complex left = g.a * axis.time + g.b * std::conj(axis.space);
  const Complex right = g.a * axis.space + g.b * axis.time;
  return {std::real(left * std::conj(g.a) + right * std::conj(g.b)), right * g.a + left * g.b};
}

Point imageOf(const Su11& g, const Point& point) {
  // g M g^* of the matrix M = [[time, space], [conj space, time]].
  const Complex left = g.a * point.time + g.b * std::conj(point.space);
  const Complex right = g.a * point.space + g.b * point.time;
  return {std::real(left * std::conj(g.a) + right * std::conj(g.b)), left * g.b + right * g.a};
}

Su11 frameOf(const Axis& axis) {
  // The point (1, 0) + time (time, space) of Minkowski space, of norm 1 + time^2.
  const double norm = std::hypot(1.0, axis.time);
  const Complex foot = axis.time * axis.space / (norm * (1 + norm));
  const Su11 move = translationTo(foot);
  return move * rotation(std::arg(imageOf(inverse(move), axis).space) - std::numbers::pi / 2);
}

double alongDiameter(const Su11& g) {
  const Complex image = 2.0 * g.a * g.b;
  return std::asinh(image.real() / std::hypot(1.0, image.imag()));
}

Point pointAt(Complex z) {
  const double radius = std::abs(z);
  const double height = (1 - radius) * (1 + radius);
  return {(1 + radius * radius) / height, 2.0 * z / height};
}

Complex inDisk(const Point& point) {
  return point.space / (1 + point.time);
}

double distanceCosine(const Point& p, const Point& q) {
  return p.time * q.time - std::real(p.space * std::conj(q.space));
}

double distanceOf(const Point& p, const Point& q) {
  const double time = p.time - q.time;
  const double space = std::abs(p.space - q.space);
  return 2 * std::asinh(std::sqrt(std::max(0.0, (space - time) * (space + time))) / 2);
}

Point normalized(const Point& vector) {
  const double space = std::abs(vector.space);
  const double norm = std::sqrt((vector.time - space) * (vector.time + space));
  return {vector.time / norm, vector.space / norm};
}

double footOnDiameter(const Axis& other) {
  // sideOf at (cosh x, sinh x) is Re(space) sinh x - time cosh x, stationary at the foot.
  return std::atanh(other.space.real() / other.time);
}

}  // namespace moduli
