#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

namespace moduli {

/// The point of the triangle a b c that is nearest to p, in any dimension, as weights of the
/// corners. Triangles may be segments or points.
template <typename Vector>
std::array<double, 3> nearestInTriangle(const Vector& p, const Vector& a, const Vector& b,
                                        const Vector& c) {
  const Vector u = b - a, w = c - a, d = p - a;
  const double uu = u.dot(u), uw = u.dot(w), ww = w.dot(w), du = d.dot(u), dw = d.dot(w);
  const double det = uu * ww - uw * uw;
  if (det > 0) {
    const double s = (ww * du - uw * dw) / det, t = (uu * dw - uw * du) / det;
    if (s >= 0 && t >= 0 && s + t <= 1) return {1 - s - t, s, t};
  }
  // On a side.
  const auto along = [](double dot, double square) {
    return square > 0 ? std::clamp(dot / square, 0.0, 1.0) : 0.0;
  };
  const double s = along(du, uu), t = along(dw, ww);
  const double vv = uu - 2 * uw + ww, r = along((p - b).dot(c - b), vv);
  const std::array<std::array<double, 3>, 3> choices = {
      {{1 - s, s, 0}, {1 - t, 0, t}, {0, 1 - r, r}}};
  const auto distance = [&](const std::array<double, 3>& x) {
    return (d - x[1] * u - x[2] * w).squaredNorm();
  };
  return *std::min_element(choices.begin(), choices.end(),
                           [&](const auto& x, const auto& y) { return distance(x) < distance(y); });
}

}  // namespace moduli
