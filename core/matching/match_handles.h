#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/harmonic_match.h"
#include "core/matching/match_surfaces.h"
#include "core/mesh/triangle_mesh.h"

/// Matching of closed surfaces with handles. Internal to this room.
namespace moduli {

struct HandleCorrespondence {
  std::vector<SurfacePoint> images;   ///< Per vertex of a its point of b; no face folded.
  std::vector<SurfacePoint> inverse;  ///< Per vertex of b the point of a that goes there.
  std::vector<SurfacePoint> landmarks, soft_landmarks;  ///< Where those of the options go.
  HarmonicMatch match;
};

/// A map near pointwise guesses: matchHarmonically in b's metric, settled (settling.h) if the two
/// are near isometries, then flowToLandmarks, and back.
/// Soft landmarks are met likewise, as far as that goes, and what comes of it is evened out again
/// before landmarks are met. points: per vertex of a. Fails as straightCover, matchHarmonically,
/// settle and invertCoverMap do, with kInvalidOption (two landmarks of one point) and kFoldedMap
/// (landmarks that contradict each other, by their names).
Result<HandleCorrespondence> matchHandles(Context& context, const TriangleMesh& a,
                                          const TriangleMesh& b,
                                          const std::vector<SurfacePoint>& points,
                                          bool near_isometry, const MatchOptions& options = {});

}  // namespace moduli
