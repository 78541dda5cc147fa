#include "core/matching/match_bordered.h"

#include <utility>

#include "core/matching/boundary_links.h"
#include "core/matching/cover_inverse.h"
#include "core/matching/target_links.h"
#include "core/mesh/double_cover.h"

namespace moduli {
namespace {

std::vector<double> doubledLengths(const DoubleCover& doubled, const TriangleMesh& mesh) {
  const std::vector<double> lengths = mesh.edgeLengths();
  std::vector<double> result;
  for (const Index e : doubled.edge) result.push_back(lengths[e]);
  return result;
}

}  // namespace

Result<BorderedCorrespondence> matchBordered(Context& context, const TriangleMesh& a,
                                             const TriangleMesh& b,
                                             const std::vector<SurfacePoint>& points,
                                             const HarmonicMatchOptions& options) {
  ASSIGN_OR_RETURN(const BoundaryMap boundary, fitBoundary(a, b, points));
  ASSIGN_OR_RETURN(const DoubleCover doubled, doubleCover(b.connectivity()));
  ASSIGN_OR_RETURN(const CoverSurface cover,
                   straightCover(context, doubled.connectivity, doubledLengths(doubled, b)));
  ASSIGN_OR_RETURN(
      const TargetLinks start,
      linkBordered(context, a.connectivity(), b.connectivity(), cover, boundary, points));
  ASSIGN_OR_RETURN(
      const HarmonicMatch match,
      matchHarmonically(context, a.connectivity(), a.edgeLengths(), cover, start, options));
  BorderedCorrespondence result;
  for (Index v = 0; v < a.vertexCount(); ++v) {
    const SurfacePoint point = foldedBack(match.map.images[v], b.faceCount());
    result.images.push_back(
        a.connectivity().isBoundaryVertex(v) ? ontoBoundary(b.connectivity(), point) : point);
  }
  ASSIGN_OR_RETURN(result.inverse,
                   invertCoverMap(context, a.connectivity(), cover, match.map, b.vertexCount()));
  for (Index v = 0; v < b.vertexCount(); ++v) {
    if (!b.connectivity().isBoundaryVertex(v)) continue;
    result.inverse[v] = ontoBoundary(a.connectivity(), result.inverse[v]);
  }
  return result;
}

}  // namespace moduli
