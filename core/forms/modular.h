#pragma once

#include <array>
#include <complex>

#include "core/base/status.h"

/// The modular group SL(2, Z) acting on the upper half plane, where the shapes of tori live.
namespace moduli {

using Complex = std::complex<double>;

/// An element [[a, b], [c, d]] of SL(2, Z): tau -> (a tau + b) / (c tau + d).
struct ModularMatrix {
  long long a = 1, b = 0, c = 0, d = 1;
};

struct ReducedTau {
  Complex tau;
  ModularMatrix transform;  ///< What carries the given tau to the reduced one.
};

/// Brings tau into |Re tau| <= 1/2, |tau| >= 1. On the border, up to rounding, Re >= 0 where
/// |tau| = 1 and Re = +1/2 where |Re| = 1/2; a point within 1e-12 (hyperbolic) counts as on the
/// border. Fails with kInvalidOption unless tau is finite and Im tau > 0, and with kOverflow where
/// the transform has entries above 2^63. O(log) steps. Source: MATH 3.6.
Result<ReducedTau> reduceToFundamentalDomain(Complex tau);

/// Klein's j at any tau in the upper half plane: j(i) = 1728, j(e^{2 pi i/3}) = 0. Infinite where
/// it overflows (reduced Im tau > 112); NaN where tau cannot be reduced. Source: MATH 8.5.
Complex jInvariant(Complex tau);

/// Teichmüller distance of two tori, marking forgotten: half the hyperbolic distance (curvature -1)
/// in the upper half plane, least over SL(2, Z). Orientation counts. NaN where a tau cannot be
/// reduced. O(log) steps. Source: MATH 7.9, 12.12.
double teichmullerDistance(Complex tau1, Complex tau2);

/// Continuous coordinates of the moduli space of tori for nearest-neighbour search: the point of
/// j / 1728 on the unit sphere, and log of the reduced Im tau, which j's point cannot resolve near
/// the cusp. Continuous across every border of the fundamental domain. NaN where tau cannot be
/// reduced. Source: MATH 8.5.
std::array<double, 4> modularFeatures(Complex tau);

}  // namespace moduli
