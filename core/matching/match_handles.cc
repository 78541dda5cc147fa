#include "core/matching/match_handles.h"

#include <utility>

#include "core/matching/cover_inverse.h"

namespace moduli {

Result<HandleCorrespondence> matchHandles(Context& context, const TriangleMesh& a,
                                          const TriangleMesh& b,
                                          const std::vector<SurfacePoint>& points,
                                          const HarmonicMatchOptions& options) {
  ASSIGN_OR_RETURN(const CoverSurface cover,
                   straightCover(context, b.connectivity(), b.edgeLengths()));
  ASSIGN_OR_RETURN(HarmonicMatch match, matchHarmonically(context, a.connectivity(),
                                                          a.edgeLengths(), cover, points, options));
  ASSIGN_OR_RETURN(std::vector<SurfacePoint> inverse,
                   invertCoverMap(context, a.connectivity(), cover, match.map));
  std::vector<SurfacePoint> images = match.map.images;
  return HandleCorrespondence{std::move(images), std::move(inverse), std::move(match)};
}

}  // namespace moduli
