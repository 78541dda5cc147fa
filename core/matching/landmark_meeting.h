#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/harmonic_match.h"
#include "core/matching/match_surfaces.h"

/// Landmarks of maps between covers. Internal to this room.
namespace moduli {

/// Over so much of the root of the area, what soft landmarks have made of a map is evened out:
/// shorter than for targets, for they are better known. The shorter, the more they weigh.
inline constexpr double kSoftSmoothing = 0.02;

/// Fails with kInvalidOption, naming both, where two landmarks are at one point or sent to one
/// place, nearer than 1e-9 of the root of the area. O(landmarks^2).
Status checkDistinct(const TriangleMesh& a, const TriangleMesh& b,
                     const std::vector<MatchLandmark>& landmarks);

/// Between which surfaces a map is, and what for. Refers to its parts.
struct CoverMeeting {
  const TriangleMesh& a;
  const TriangleMesh& b;
  const CoverSurface& cover;  ///< Of b or, where there is a boundary, of its double.
  const std::vector<MatchLandmark>& exact;
  const std::vector<MatchLandmark>& soft;
  double soft_smoothing = kSoftSmoothing;
};

/// Takes all landmarks as far to their places as no face folds (flowToLandmarks), evens out what
/// came of that over `soft_smoothing` (less where faces fold) by the energy of matchHarmonically,
/// and meets the exact ones at last; where faces are about to fold, evening out makes room to go
/// on. Without soft ones only the latter, without any nothing.
/// match: no face folded. Fails with kFoldedMap (exact ones that contradict each other, by their
/// names), and as matchHarmonically does.
Result<HarmonicMatch> meetOnCover(Context& context, const CoverMeeting& meeting,
                                  HarmonicMatch match);

}  // namespace moduli
