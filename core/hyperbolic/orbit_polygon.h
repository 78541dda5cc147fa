#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/hyperbolic/axis.h"
#include "core/hyperbolic/su11.h"
#include "core/hyperbolic/wide_su11.h"
#include "core/topology/homotopy_basis.h"

/// The points of the disk nearest to one point of an orbit: a fundamental polygon of a Fuchsian
/// group that is given by any generators, found with the area as a certificate.
///
///   ASSIGN_OR_RETURN(const OrbitPolygon polygon, orbitPolygon(context, generators, genus));
///   polygon.radius;  // how far the polygon reaches
namespace moduli {

/// An element of a group with a word that it is the product of, up to sign: letter k + 1 is
/// generator k, -(k + 1) its inverse, read from the left.
struct GroupElement {
  Su11 map;
  Word word;
};

/// The Dirichlet polygon of a group about the point base(0). Everything but `base` is in
/// coordinates where that point is 0: g there is base^-1 g base.
struct OrbitPolygon {
  int genus = 0;
  Su11 base;
  /// The elements g with a side on the bisector of 0 and g(0), closed under inverses.
  std::vector<GroupElement> pairings;
  std::vector<WideSu11> wide;    ///< Their maps in 113 bits, as far as the generators were known.
  std::vector<Complex> corners;  ///< Counter-clockwise, inside the disk.
  std::vector<int> sides;        ///< Per corner: the pairing of the side from it to the next.
  double radius = 0;             ///< The largest distance of a corner from 0.
  double separation = 0;         ///< The least distance of two points of the orbit.
  double area_error = 0;         ///< |area - 4 pi (genus - 1)| as computed.
};

/// The polygon of the group that `generators` generate: discrete, without elements of finite order,
/// with a closed quotient of genus `genus` >= 2. The base point is moved to where the polygon
/// reaches less far.
///
/// Completeness: any elements of the group cut out a polygon that contains the true one, of area
/// 4 pi (genus - 1); products of its pairings are tried until the areas agree to 1e-6 relative.
/// Fails with kInvalidOption where an element turns or shifts to a point, or where no product cuts
/// off more and the areas differ (wrong genus, or no closed surface's group); with
/// kResidualTooLarge where it would reach further than 10.5 across the collar of a short geodesic
/// (one of length l reaches log(4 / l) on either side, three of 0.02 in a row are as much), and
/// where rounding makes the polygon too small: generators that move 0 by d carry
/// some 1e-16 e^{d/2}, multiplied again by the size of what they are multiplied with. Some 50 times
/// O(n^2 + n m) for n pairings, at most 12 genus - 6 sides of the polygon, and m corners.
/// Source: Voight 2009, Computing fundamental domains for Fuchsian groups; MATH 7.5.
Result<OrbitPolygon> orbitPolygon(Context& context, const std::vector<Su11>& generators, int genus);
/// The same of generators that are known to 113 bits: as the products are computed in these,
/// nothing is lost to rounding for surfaces of high genus, whose polygons reach far.
Result<OrbitPolygon> orbitPolygon(Context& context, const std::vector<WideSu11>& generators,
                                  int genus);

/// An element in the polygon's coordinates, in those of the generators.
Su11 inGivenCoordinates(const OrbitPolygon& polygon, const Su11& element);

/// The product of a word's generators.
Su11 elementOfWord(const std::vector<Su11>& generators, const Word& word);

/// Whether an axis (in the polygon's coordinates) passes the polygon at a sinh of distance of at
/// most `slack`.
bool meetsPolygon(const OrbitPolygon& polygon, const Axis& axis, double slack);

}  // namespace moduli
