#pragma once

namespace moduli {

/// Milnor's Lobachevsky function, minus the integral of log |2 sin t| from 0 to x: odd, of period
/// pi, at most 0.50747... x: radians, any finite number. The absolute error is below 1e-15, and
/// near the zeros 0 and pi / 2 the relative one, too; beyond |x| = 1e6 the reduction modulo pi adds
/// some 1e-32 |x| and the rounding of x itself is larger. O(1).
/// Source: Milnor 1982, "Hyperbolic geometry: the first 150 years", appendix; MATH 6.5.
double lobachevsky(double x);

}  // namespace moduli
