#pragma once

#include <array>

#include "core/intrinsic/geometry.h"

/// The second derivatives of a triangle's angles by the unknowns at its corners, of which the third
/// derivatives of the Ricci energies are made.
namespace moduli {

/// Entry [i][j][m] is the derivative of angle i by the unknowns of corners j and m. Angles being
/// derivatives of an energy, it is the same for all orders of i, j, m.
using TriangleTensor = std::array<TriangleMatrix, 3>;

/// Per corner m the sum over i, j of weights[i][j] tensor[i][j][m]. weights: symmetric.
TriangleValues contract(const TriangleTensor& tensor, const TriangleMatrix& weights);

/// Under vertex scaling. half_tangents: of the angles of a proper face; half_chords: scaled; entry
/// c belongs to the side opposite corner c. Infinite or NaN where an angle is 0.
/// Source: MATH 6.4, differentiated once more.
TriangleTensor scaledFaceThirds(Geometry geometry, const TriangleValues& half_tangents,
                                const TriangleValues& half_chords);

/// A circle packing's face. Per corner the radius' F and C (MATH 6.1: identity and 1, sinh and
/// cosh, sin and cos), the others per side opposite the corner.
struct CircleFace {
  TriangleValues sine, cosine;
  TriangleValues distance;  ///< I.
  TriangleValues side, angle;
};

/// Under circle packing; 0 in a broken face. By the chain rule, twice: some digits are lost in
/// needles. Source: MATH 6.1, 6.3.
TriangleTensor circleFaceThirds(Geometry geometry, const CircleFace& face);

}  // namespace moduli
