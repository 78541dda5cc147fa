#pragma once

#include <array>

#include "core/intrinsic/geometry.h"

/// The three corners of a triangle under vertex scaling: angles and their derivatives without
/// trigonometry.
namespace moduli {

/// Tangents of half the angles; entry c is of the angle opposite side c. A side that is too long
/// has an infinite one and the others are 0.
struct ScaledFace {
  TriangleValues half_tangent;
  bool proper = true;
};

/// From half chords. tan(a/2) = r / F(s - x) with r^2 = F(s-x) F(s-y) F(s-z) / F(s), F the
/// identity, sinh or sin. Source: MATH 6.1.
ScaledFace scaledFace(Geometry geometry, const TriangleValues& half_chords);

/// Whether a side is so short that rounding the factors of long ones would show in the angles at
/// it.
bool isNeedle(const TriangleValues& half_chords);

/// u = base + change, to more digits than their sum has.
struct FineFactor {
  double base = 0, change = 0;
};

/// The same in extended precision, from half chords before scaling: side c runs from corner c to
/// the next, with factors e^{u / 2} per corner. Angles at a side of a millionth of the others lose
/// six digits in doubles, of which this gives three back and more.
ScaledFace scaledNeedle(Geometry geometry, const TriangleValues& half_chords,
                        const std::array<FineFactor, 3>& factors);

/// What an edge, opposite the angle a_k in one face, adds to the Hessian of the Ricci energy: with
/// ends i, j the entries (i, i) and (j, j) get `diagonal`, the entry (i, j) gets `mixed`.
struct EdgeWeight {
  double diagonal = 0, mixed = 0;
};

/// ti, tj, tk: tangents of half the angles of a proper face; half_chord: of edge ij.
/// Source: MATH 6.4 (Bobenko, Pinkall and Springborn 2015, propositions 4.1.2 and 6.1.6).
inline EdgeWeight edgeWeight(Geometry geometry, double ti, double tj, double tk,
                             double half_chord) {
  if (geometry == Geometry::kEuclidean) {
    const double w = (1 - tk * tk) / (4 * tk);  // half a cotangent
    return {w, -w};
  }
  // cot((pi - a_i - a_j + a_k) / 2) is the tangent of (a_i + a_j - a_k) / 2.
  const double sum = ti + tj, rest = 1 - ti * tj;
  const double w = 0.5 * (sum - tk * rest) / (rest + tk * sum);
  const double square = half_chord * half_chord;
  const double sign = geometry == Geometry::kHyperbolic ? 1 : -1;
  const double cosine = 1 + sign * square;  // cosh(l/2)^2 or cos(l/2)^2
  return {w * (cosine + sign * square) / cosine, -w / cosine};
}

}  // namespace moduli
