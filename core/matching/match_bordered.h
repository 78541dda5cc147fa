#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/harmonic_match.h"
#include "core/matching/match_surfaces.h"
#include "core/mesh/triangle_mesh.h"

/// Matching of surfaces with boundary other than disks. Internal to this room.
namespace moduli {

struct BorderedCorrespondence {
  std::vector<SurfacePoint> images;   ///< Per vertex of a its point of b; no face folded.
  std::vector<SurfacePoint> inverse;  ///< Per vertex of b the point of a that goes there.
  std::vector<SurfacePoint> landmarks, soft_landmarks;  ///< Where those of the options go.
};

/// A map near pointwise guesses, boundary onto boundary: matchHarmonically into the metric of b's
/// double, where the boundary is made of geodesics along which a's boundary slides: half of a
/// harmonic map of the doubles that commutes with their reflections.
///
/// a, b: of one topology, with boundary, no disks, without edges inside that join boundary vertices
/// (SplitSurface). points: per vertex of a. marks: its landmarks, exact and soft, tell which loops
/// correspond, and are met at last (meetOnCover). Fails as checkBorderSides, checkBorderOrder (of
/// the exact ones), checkDistinct, fitBoundary, straightCover, linkBordered, matchHarmonically,
/// meetOnCover and invertCoverMap do; with kNoConvergence, naming a landmark, where it sends a loop
/// elsewhere than the points do and these do not allow that.
Result<BorderedCorrespondence> matchBordered(Context& context, const TriangleMesh& a,
                                             const TriangleMesh& b,
                                             const std::vector<SurfacePoint>& points,
                                             const HarmonicMatchOptions& options = {},
                                             const MatchOptions& marks = {});

}  // namespace moduli
