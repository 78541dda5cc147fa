#pragma once

#include <cfloat>
#include <cmath>

#include "core/hyperbolic/wide_su11.h"

/// SU(1, 1) in doubles with a bound of the error: tells of most products in a search that they are
/// not worth 113 bits, which take a hundred times as long.
namespace moduli {

/// An element whose entries are off by at most `error`, each.
struct BoundedSu11 {
  Su11 g;
  double error = 0;

  BoundedSu11() = default;
  explicit BoundedSu11(const WideSu11& exact) : g(rounded(exact)), error(DBL_EPSILON * size()) {}
  BoundedSu11(const Su11& entries, double bound) : g(entries), error(bound) {}

  /// At least each of |a| and |b|, up to rounding.
  double size() const { return std::sqrt(std::norm(g.a)); }
};

inline BoundedSu11 operator*(const BoundedSu11& g, const BoundedSu11& h) {
  // Two products an entry: (x + dx)(y + dy), and 4 roundings of |x y| each.
  const double x = g.size(), y = h.size();
  return {g.g * h.g, 2 * (x * h.error + y * g.error + g.error * h.error) + 8 * DBL_EPSILON * x * y};
}

inline BoundedSu11 inverse(const BoundedSu11& g) {
  return {inverse(g.g), g.error};
}

/// A lower bound of d(0, g 0).
inline double leastDisplacement(const BoundedSu11& g) {
  // 1e-12 relative for what std::asinh and the like lose.
  const double b = std::sqrt(std::norm(g.g.b)) - g.error;
  return b > 0 ? 2 * std::asinh(b) * (1 - 1e-12) : 0;
}

}  // namespace moduli
