#pragma once

#include <vector>

#include "core/base/status.h"
#include "core/matching/border_places.h"
#include "core/matching/match_surfaces.h"

/// What landmarks on boundaries say.
namespace moduli {

/// Fails with kInvalidOption, naming a landmark, where one is on the boundary of one surface but
/// not on that of the other. O(landmarks).
Status checkBorderSides(const Connectivity& a, const Connectivity& b,
                        const std::vector<MatchLandmark>& landmarks);

/// Fails with kFoldedMap, naming two landmarks on boundaries that no map meets both: of one loop of
/// one surface, but of two of the other; or in another order around their loops. Of the latter, as
/// few as possible are taken for wrong. landmarks: as above. O(n^2 log n) for n on one loop.
Status checkBorderOrder(const BorderPlaces& a, const BorderPlaces& b, const Connectivity& surface_a,
                        const Connectivity& surface_b, const std::vector<MatchLandmark>& landmarks);

/// Per loop of a the one of b that landmarks on it are sent to, kNone where there are none. Where
/// some contradict others, the first ones count. O(landmarks).
std::vector<Index> loopsByLandmarks(const BorderPlaces& a, const BorderPlaces& b,
                                    const Connectivity& surface_a, const Connectivity& surface_b,
                                    const std::vector<MatchLandmark>& landmarks);

}  // namespace moduli
