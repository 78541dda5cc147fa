#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/hyperbolic/orbit_polygon.h"
#include "core/hyperbolic/su11.h"

namespace moduli {

/// A side of a polygon, from its corner to that of the next side.
struct DomainSide {
  Complex corner;
  double length = 0;
  double angle = 0;  ///< Of the polygon at the corner, radians.
  Su11 neighbour;    ///< Carries the polygon to that beyond the side.
  int partner = 0;   ///< The side that `neighbour` carries to this one, backwards.
  int cycle = 0;     ///< The number of the point of the surface that the corner is.
};

/// What judges a domain.
struct DomainCertificate {
  double area_error = 0;      ///< |area by angles - 2 pi |chi||.
  double side_residual = 0;   ///< The largest distance of a corner from the image of its partner's.
  double cycle_residual = 0;  ///< The largest | sum of angles around a point - 2 pi |.
};

/// A Dirichlet domain with its sides glued: a proof that its neighbours generate a group whose
/// quotient is the surface (Poincaré's theorem), as far as the certificate's residuals go.
struct DirichletDomain {
  Su11 base;                      ///< Everything below is in coordinates where base(0) is 0.
  std::vector<DomainSide> sides;  ///< Counter-clockwise.
  int cycles = 0;                 ///< Points of the surface among the corners.
  double radius = 0;              ///< The largest distance of a corner from 0.
  DomainCertificate certificate;
};

/// Glues the sides of a polygon that orbitPolygon found. Sides shorter than 1e-7 are points. Fails
/// with kResidualTooLarge where the sides do not fit to 1e-6, the angles around a point do not add
/// up to 2 pi to 1e-6, or the glued polygon is not a surface of the polygon's genus. O(n^2).
/// Source: MATH 7.5; Poincaré 1882; CHECKS G4, G5.
Result<DirichletDomain> glueDomain(const OrbitPolygon& polygon);

/// The Dirichlet domain of a group of genus >= 2, about a base point from which it reaches not far.
/// Fails as orbitPolygon and glueDomain do.
Result<DirichletDomain> dirichletDomain(Context& context, const std::vector<Su11>& generators,
                                        int genus);

}  // namespace moduli
