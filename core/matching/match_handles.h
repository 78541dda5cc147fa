#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/harmonic_match.h"
#include "core/matching/match_surfaces.h"
#include "core/matching/spectral_guess.h"

/// Matching of closed surfaces with handles. Internal to this room.
namespace moduli {

struct HandleCorrespondence {
  std::vector<SurfacePoint> images;   ///< Per vertex of a its point of b; no face folded.
  std::vector<SurfacePoint> inverse;  ///< Per vertex of b the point of a that goes there.
  std::vector<SurfacePoint> landmarks, soft_landmarks;  ///< Where those of the options go.
  HarmonicMatch match;
};

/// A map near a guess: matchHarmonically in b's metric (cover), from sharpenTargets where the guess
/// contradicts itself (not above 10,000 vertices), settled (settling.h) if the two are near
/// isometries, of a thinned surface where there is one and from there to the whole (mapWhole);
/// then meetOnCover, and back. Fails as linkTargets, matchHarmonically, settle, mapWhole,
/// checkDistinct, meetOnCover and invertCoverMap do.
Result<HandleCorrespondence> matchHandles(Context& context, const MatchPair& pair,
                                          const CoverSurface& cover, const SpectralGuess& guess,
                                          const MatchOptions& options = {});

}  // namespace moduli
