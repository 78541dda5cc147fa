#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/harmonic_match.h"
#include "core/mesh/triangle_mesh.h"

/// Matching of closed surfaces with handles. Internal to this room.
namespace moduli {

struct HandleCorrespondence {
  std::vector<SurfacePoint> images;   ///< Per vertex of a its point of b; no face folded.
  std::vector<SurfacePoint> inverse;  ///< Per vertex of b the point of a that goes there.
  HarmonicMatch match;
};

/// A map near pointwise guesses: matchHarmonically in b's metric, settled (settling.h) if the two
/// are near isometries, and back. points: per vertex of a. Fails as straightCover,
/// matchHarmonically, settle and invertCoverMap do.
Result<HandleCorrespondence> matchHandles(Context& context, const TriangleMesh& a,
                                          const TriangleMesh& b,
                                          const std::vector<SurfacePoint>& points,
                                          bool near_isometry,
                                          const HarmonicMatchOptions& options = {});

}  // namespace moduli
