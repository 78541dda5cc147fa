#pragma once

#include <complex>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/mesh/connectivity.h"
#include "core/parameterize/packing.h"

/// Whether a layout in the plane lies on itself, and cuts that end it.
///
///   EXPECT_EQ(countOverlaps(result.points, result.corner), 0);
namespace moduli {

/// The pairs of faces whose images have inner points in common, lower face first, ascending, at
/// most `most` of them. Decided without an error on the given doubles (exact_sign.h): faces that
/// share a side or touch do not overlap, one without area overlaps nothing, and one that is turned
/// over counts as it lies. points: images of corners; corner: per halfedge h = 3 f + c the point of
/// corner c of face f. O(F log F) where few faces overlap and all are of a similar size.
std::vector<std::pair<Index, Index>> findOverlaps(const std::vector<std::complex<double>>& points,
                                                  const std::vector<Index>& corner,
                                                  std::size_t most);

/// How many these are.
std::int64_t countOverlaps(const std::vector<std::complex<double>>& points,
                           const std::vector<Index>& corner);

/// Per face the number of its island: islands are faces joined by sides whose two ends they share,
/// and are numbered by their lowest face. O(F).
std::vector<Index> islandsOf(const Connectivity& surface, const std::vector<Index>& corner);

/// Cuts a layout of faces that are not turned over so that it lies on itself nowhere: islands with
/// an overlap are grown anew, face by face from the one nearest their middle, up to faces that
/// would cover one of theirs; what is left out makes further islands. Where that was done (or where
/// two islands overlap), all islands stand side by side afterwards (packIslands, which margin and
/// grid are for). Nothing moves where there is no overlap. Returns the number of islands. O(F log
/// F).
Index cutOverlaps(const Connectivity& surface, std::vector<std::complex<double>>& points,
                  std::vector<Index>& corner, double margin = kIslandMargin, double grid = 0);

}  // namespace moduli
