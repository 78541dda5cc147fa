#pragma once

#include <array>
#include <cstdint>

/// Triangles of the three geometries of constant curvature, given by side lengths.
///
/// The half chord of a length l is l / 2 (Euclidean), sinh(l / 2) (hyperbolic, curvature -1) or
/// sin(l / 2) (spherical, curvature +1). Discrete conformal changes multiply half chords, and the
/// Delaunay and Ptolemy formulas are the same in half chords for all three (MATH 6.4, 6.7).
namespace moduli {

enum class Geometry : std::uint8_t { kEuclidean, kHyperbolic, kSpherical };

/// The curvature of the geometry's plane: 0, -1, 1.
constexpr int planeCurvature(Geometry geometry) {
  return geometry == Geometry::kEuclidean ? 0 : geometry == Geometry::kHyperbolic ? -1 : 1;
}

double halfChord(Geometry geometry, double length);

/// The inverse of halfChord; spherical half chords are at most 1.
double lengthOfHalfChord(Geometry geometry, double half_chord);

/// Three sides, or three angles: entry c of the angles is opposite side c.
using TriangleValues = std::array<double, 3>;

/// The angles of a triangle of given side lengths, by the half-angle formula
/// tan(a/2)^2 = F(s-y) F(s-z) / (F(s) F(s-x)), which keeps its relative precision in needles. Where
/// a side is at least as long as the other two together, its angle is pi and the others are 0: the
/// extension under which the Ricci energies stay convex. sides: finite, >= 0; spherical perimeters
/// below 2 pi (all angles are pi from there on).
/// Source: MATH 6.1; Bobenko, Pinkall and Springborn 2015, section 5.1.
TriangleValues triangleAngles(Geometry geometry, const TriangleValues& sides);

/// Whether a side is at least as long as the other two together.
bool isBrokenTriangle(const TriangleValues& sides);

/// Row c holds the derivatives of angle c by the three sides.
using TriangleMatrix = std::array<TriangleValues, 3>;

/// The derivatives of triangleAngles by the sides; 0 in a broken triangle. sides: hyperbolic ones
/// below 700 (sinh must be a double), spherical perimeters below 2 pi. angles: of triangleAngles.
/// Source: MATH 6.1, with F(b) F(c) sin a = 2 sqrt(F(s) F(s-a) F(s-b) F(s-c)).
TriangleMatrix angleDerivatives(Geometry geometry, const TriangleValues& sides,
                                const TriangleValues& angles);

/// Area of a triangle with these sides: Kahan's formula, or the excess or defect of the angle sum
/// in its stable form (l'Huilier's tan(A/4)^2 = T(s/2) T((s-a)/2) T((s-b)/2) T((s-c)/2) with T the
/// tangent or the hyperbolic one). 0 for a broken triangle. Units of the sides, squared.
double triangleArea(Geometry geometry, const TriangleValues& sides);

/// The other diagonal of a quadrilateral folded from two triangles along a diagonal of length
/// `diagonal`: a, b are the sides of one triangle and d, c those of the other, a and d meeting at
/// one end of the diagonal, b and c at the other. All are lengths, hyperbolic ones below 700; the
/// quadrilateral may be concave. Source: the cosine laws in half chords,
/// x(f)^2 = x(a - d)^2 + F(a) F(d) sin(angle / 2)^2, sums of positive terms.
double isometricDiagonal(Geometry geometry, double diagonal, double a, double b, double c,
                         double d);

}  // namespace moduli
