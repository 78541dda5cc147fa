#pragma once

#include "core/hyperbolic/su11.h"

namespace moduli {

/// A directed geodesic by its unit normal in Minkowski space, -t^2 + x^2 + y^2 = 1: linear where
/// the disk is not, so that sides, angles and distances need no points at infinity.
struct Axis {
  double time = 0;
  Complex space;
};

/// The axis of an element that has one, in the direction of its translation; the same for both
/// lifts. Rounding: 1e-16 e^{d/2} / sinh(l / 2) for displacement d and length l.
/// Precondition: translationLength(g) > 0.
Axis axisOf(const Su11& g);

/// sinh of the distance of a point of the disk from the axis, positive on its left.
double sideOf(const Axis& axis, Complex point);

/// The cosine of the angle between axes that cross; otherwise +-cosh of their distance, negative
/// where they run against each other with what lies between on the same side of both.
double product(const Axis& a, const Axis& b);

/// The axis carried along by an isometry.
Axis imageOf(const Su11& g, const Axis& axis);

/// Where the common perpendicular to `other` meets the diameter from -1 to 1: the signed distance
/// from 0. Precondition: `other` does not meet the diameter, nor its ends.
double footOnDiameter(const Axis& other);

}  // namespace moduli
