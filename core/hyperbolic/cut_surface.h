#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/hyperbolic/axis.h"
#include "core/hyperbolic/orbit_polygon.h"

/// A closed hyperbolic surface cut along disjoint simple closed geodesics: the pieces, and what
/// parts of its polygon they consist of.
///
///   ASSIGN_OR_RETURN(const CutSurface cut, cutSurface(polygon, cuts));
///   cut.pieces[0].missing();  // how many more curves would make pants of it
namespace moduli {

/// A side of a part: on a side of the polygon, with a part beyond it, or on a cut.
struct PartEdge {
  Axis line;       ///< Through it, with the part on its left.
  Point from, to;  ///< Counter-clockwise.
  Axis across;     ///< Through `from`, at a right angle, with the edge on its left.
  double length = 0;
  double span = 0;  ///< tanh of the length.
  /// Beyond it lies this part of the copy `pairing` of the polygon, -1: of the polygon itself.
  int part = -1;  ///< -1 where rounding left nothing beyond a short edge.
  int pairing = -1;
  int cuff =
      -1;  ///< On a cut: the side of a curve that the part is on, 2 i left and 2 i + 1 right.
};

/// A convex part of the polygon that no cut passes.
struct PolygonPart {
  std::vector<Point> corners;  ///< Counter-clockwise; edge i leads from corner i to the next.
  std::vector<PartEdge> edges;
  int piece = -1;  ///< -1: a sliver between a cut and a side of the polygon, made by rounding.
};

struct SurfacePiece {
  int genus = 0;
  std::vector<int> cuffs;  ///< The sides of curves that bound it, ascending.

  /// How many curves cut it into pants.
  int missing() const { return 3 * genus - 3 + static_cast<int>(cuffs.size()); }
};

struct CutSurface {
  std::vector<PolygonPart> parts;
  std::vector<SurfacePiece> pieces;
};

/// Curves to cut along: simple closed geodesics, disjoint.
struct Cuts {
  std::vector<std::vector<Axis>> lifts;  ///< Per curve the axes over it that pass the polygon,
                                         ///< directed as the curve (axesAcross).
  std::vector<double> lengths;           ///< Per curve.
};

/// The topology of every piece follows from its area and its cuffs, and must fit, and the cuts be
/// as long as the curves: fails with kResidualTooLarge where rounding keeps them from that. O(n^2)
/// for n parts.
Result<CutSurface> cutSurface(const OrbitPolygon& polygon, const Cuts& cuts);

/// The hyperbolic cosine of the distance of a point from an edge.
double distanceCosine(const PartEdge& edge, const Point& point);

}  // namespace moduli
