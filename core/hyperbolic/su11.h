#pragma once

#include <array>
#include <complex>

/// Orientation-preserving isometries of the hyperbolic plane, as Möbius maps of the unit disk.
///
///   const Su11 step = rotation(angle) * translation(length);  // first the translation, then turn
///   const std::complex<double> end = imageOf(step, 0.0);
///
/// Both signs of an Su11 are the same isometry; products keep the sign, which tells lifts to
/// SU(1, 1) apart. Rounding grows with distances: an element that carries 0 to distance d has
/// entries of size e^{d/2} / 2, and its products are right to some 1e-16 e^{d/2} absolutely.
/// Source: MATH 7.1.
namespace moduli {

using Complex = std::complex<double>;

/// The matrix [[a, b], [conj b, conj a]] with |a|^2 - |b|^2 = 1: z -> (a z + b) / (conj b z + conj
/// a).
struct Su11 {
  Complex a = 1;
  Complex b = 0;
};

inline Su11 operator*(const Su11& g, const Su11& h) {
  return {g.a * h.a + g.b * std::conj(h.b), g.a * h.b + g.b * std::conj(h.a)};
}

inline Su11 inverse(const Su11& g) {
  return {std::conj(g.a), -g.b};
}

/// The other lift of the same isometry.
inline Su11 operator-(const Su11& g) {
  return {-g.a, -g.b};
}

/// |a|^2 - |b|^2 - 1, the drift of the determinant, without cancellation beyond that of |a| - |b|.
double determinantDrift(const Su11& g);

/// The element of determinant 1 with the same b and the same direction of a: right to rounding for
/// elements of any size, where dividing by the determinant's root is not.
Su11 renormalized(const Su11& g);

/// The image of a point of the closed disk.
Complex imageOf(const Su11& g, Complex z);

/// The larger change of an entry between g and +-h, whichever sign is nearer.
double distanceUpToSign(const Su11& g, const Su11& h);

/// How far g is from one of 1 and -1, entry by entry.
double distanceToUnit(const Su11& g);

/// The real trace, 2 Re a.
inline double trace(const Su11& g) {
  return 2 * g.a.real();
}

/// d(0, g 0) = 2 asinh |b|.
double displacement(const Su11& g);

/// Whether g and h are one element of a group whose elements other than 1 move 0 by 1e-4 and more.
/// By the image of 0: of far ones entries alone do not tell. Rounding: 1e-16 e^{displacement}.
bool sameElement(const Su11& g, const Su11& h);

/// The length by which g translates along its axis, 2 acosh(|trace| / 2); 0 where g has no axis. Of
/// cosh(l / 2) = |Re a| and sinh(l / 2)^2 = |b|^2 - (Im a)^2 the one that rounds less is taken.
double translationLength(const Su11& g);

/// The points of the unit circle that an element with an axis leaves in place: first the one it
/// repels from, then the one it attracts to. Precondition: translationLength(g) > 0.
std::array<Complex, 2> axisEnds(const Su11& g);

/// The distance from 0 to the axis, signed: -asinh(Im a sign(Re a) / sinh(l / 2)), positive where 0
/// lies on the left of the axis. Precondition: translationLength(g) > 0.
double signedDistanceToAxis(const Su11& g);

/// z -> e^{i angle} z.
Su11 rotation(double angle);

/// The translation by `length` along the real axis, from -1 towards 1.
Su11 translation(double length);

/// The translation by `length` along the geodesic from one point of the unit circle to another.
Su11 translation(Complex repelling, Complex attracting, double length);

/// The translation that carries 0 to p along the straight line. p: inside the disk.
Su11 translationTo(Complex p);

/// The isometry that carries 0 to p and the positive real axis to the ray from p through q; the
/// frame of an edge from p to q. p, q: inside the disk, different.
Su11 edgeFrame(Complex p, Complex q);

/// The half turn about the midpoint of 0 and the point at distance `length` on the positive real
/// axis: swaps the two ends of an edge in its frame. Its square is -1.
Su11 edgeHalfTurn(double length);

/// The hyperbolic distance of two points inside the disk, 2 asinh(|p - q| / sqrt((1 - |p|^2)(1 -
/// |q|^2))), without cancellation for near and for far points.
double hyperbolicDistance(Complex p, Complex q);

}  // namespace moduli
