#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/hyperbolic/handle_moves.h"
#include "core/hyperbolic/wide_su11.h"

/// Canonical generators of a surface's group that move a point as little as can be found.
namespace moduli {

/// Handles with prod [a_k, b_k] = `relation` for a surface given by letters and the boundary word
/// of a polygon (each of 1 .. 2 g once with either sign, all corners at one point). Handles are
/// split off one after the other as in canonicalBasisOfPolygon, of all linked pairs of letters each
/// time that with the smallest displacements. Fails with kInvalidOption where the word is none of
/// such a polygon. O(g^4).
Result<std::vector<GroupHandle>> splitIntoHandles(const std::vector<WideSu11>& letters,
                                                  const Word& relation);

/// Handles in coordinates of their own: those of an element X are base^-1 X base.
struct ShortHandles {
  std::vector<GroupHandle> handles;
  WideSu11 base;
};

/// How much roundings of the generators' entries grow in prod [a_k, b_k]: the root of the sum of
/// (|P| |X| |P X|)^2 over its letters X and the products P of those before, where |g| = cosh(d(0, g
/// 0) / 2).
double roundingGrowth(const std::vector<GroupHandle>& handles);

/// Makes the sum of the displacements of 0 smaller: those of the generators and, times
/// `corner_weight`, those of the corners of their polygon, the products of the first letters of
/// prod [a_k, b_k]. Moves that keep this word's value: twists along a_k, along b_k and along the
/// loops that link neighbouring handles (these generate the mapping class group: Lickorish 1964),
/// along the loops around one or several handles, and exchanges of neighbours; the best one each
/// time, until none helps. Between them all is conjugated so that 0 comes to where the sum is
/// smallest. O(g^2) a move, at most some hundred a handle; a local minimum. Fails as the context
/// does.
Result<ShortHandles> shortenHandles(Context& context, std::vector<GroupHandle> handles,
                                    double corner_weight);

/// Both, from several rotations of the relation and with several weights: of the handles found
/// those of the smallest roundingGrowth. Fails with kNoConvergence where all starts are too long
/// for 113 bits.
Result<ShortHandles> findShortHandles(Context& context, const std::vector<WideSu11>& letters,
                                      const Word& relation);

}  // namespace moduli
