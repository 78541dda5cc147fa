#pragma once

#include "core/hyperbolic/su11.h"

namespace moduli {

/// A directed geodesic by its unit normal to the left in Minkowski space, -time^2 + |space|^2 = 1:
/// linear where the disk is not, so that sides, angles and distances need no points at infinity.
/// The diameter from -1 to 1 is {0, i}.
struct Axis {
  double time = 0;
  Complex space;
};

/// A point of the plane in Minkowski space, -time^2 + |space|^2 = -1 and time > 0: far from 0 it is
/// told from others where points of the disk are not. 0 is {1, 0}.
struct Point {
  double time = 1;
  Complex space;
};

/// The axis of an element that has one, in the direction of its translation; the same for both
/// lifts. Rounding: 1e-16 e^{d/2} / sinh(l / 2) for displacement d and length l.
/// Precondition: translationLength(g) > 0.
Axis axisOf(const Su11& g);

/// sinh of the distance of a point of the disk from the axis, positive on its left.
double sideOf(const Axis& axis, Complex point);
double sideOfPoint(const Axis& axis, const Point& point);

/// The cosine of the angle between axes that cross; otherwise +-cosh of their distance, positive
/// where one lies on the left of the other and the other on its right.
double product(const Axis& a, const Axis& b);

/// Whether both are the same geodesic, directed either way, up to rounding.
bool sameAxis(const Axis& a, const Axis& b);

/// The axis carried along by an isometry.
Axis imageOf(const Su11& g, const Axis& axis);
Point imageOf(const Su11& g, const Point& point);

/// Carries the diameter from -1 to 1 to an axis, and 0 to its point nearest to 0.
Su11 frameOf(const Axis& axis);

/// How far along the diameter from -1 to 1 the image of 0 lies, signed.
double alongDiameter(const Su11& g);

/// A point of the disk, inside it, and back.
Point pointAt(Complex z);
Complex inDisk(const Point& point);

/// The hyperbolic cosine of the distance of two points.
double distanceCosine(const Point& p, const Point& q);
/// Their distance, without cancellation for near ones.
double distanceOf(const Point& p, const Point& q);

/// The vector scaled to a point. Precondition: time > |space|.
Point normalized(const Point& vector);

/// Where the common perpendicular to `other` meets the diameter from -1 to 1: the signed distance
/// from 0. Precondition: `other` does not meet the diameter, nor its ends.
double footOnDiameter(const Axis& other);

}  // namespace moduli
