#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/context.h"
#include "core/hyperbolic/cut_surface.h"

/// Closed geodesics within the pieces of a surface, without those of the whole surface.
namespace moduli {

/// A disk about a point of a part: geodesics are looked for that pass it.
struct SearchDisk {
  Point centre;
  double radius = 0;
  int part = 0;
};

/// Disks that cover what simple closed geodesics of the pieces that are not pants can pass, but the
/// cuffs: all but the collars of the cuffs, the points within asinh(1 / sinh(l / 2)) of a cuff of
/// length l. O(n l) for n disks and l lifts.
/// Source: Buser 1992, 4.1 (the collar theorem).
std::vector<SearchDisk> coverPieces(const CutSurface& cut, const Cuts& cuts);

struct PieceElements {
  /// Elements over closed geodesics, by the pairings that they are the products of.
  std::vector<std::vector<std::int32_t>> elements;
  std::size_t visited = 0;  ///< Parts of copies of the polygon that were looked at.
  bool complete = false;    ///< Whether `most` of them sufficed.
};

/// At least one element over every closed geodesic of length in (above, upto] that lies within a
/// piece, other than the cuffs, and passes one of the disks.
///
/// A geodesic of length l that passes within r of x has an element that moves x by at most
/// 2 asinh(cosh r sinh(l / 2)) and keeps the piece's copy about x in place. That is convex, so that
/// the way from x to its image crosses only parts of copies of the polygon that hang together
/// within the piece, and comes no further from x: these are searched, from one to the next. A part
/// is looked at in O(edges). Source: MATH 7.5.
Result<PieceElements> searchPieces(Context& context, const OrbitPolygon& polygon,
                                   const CutSurface& cut, const std::vector<SearchDisk>& disks,
                                   double above, double upto, std::size_t most);

}  // namespace moduli
