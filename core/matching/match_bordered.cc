#include "core/matching/match_bordered.h"

#include <utility>

#include "core/matching/boundary_map.h"
#include "core/matching/cover_inverse.h"
#include "core/matching/doubled_map.h"
#include "core/matching/target_links.h"

namespace moduli {
namespace {

std::vector<double> doubledLengths(const DoubleCover& doubled, const TriangleMesh& mesh) {
  const std::vector<double> lengths = mesh.edgeLengths();
  std::vector<double> result;
  for (const Index e : doubled.edge) result.push_back(lengths[e]);
  return result;
}

/// Any one: where it stays, a shift of a double that is a torus keeps boundaries on each other.
Index boundaryVertex(const Connectivity& surface) {
  Index v = 0;
  while (!surface.isBoundaryVertex(v)) ++v;
  return v;
}

/// The images of a surface's own vertices on the other one, whose boundary gets the boundary's.
std::vector<SurfacePoint> ofFirstCopy(const Connectivity& from, const Connectivity& to,
                                      const std::vector<SurfacePoint>& images) {
  std::vector<SurfacePoint> result;
  for (Index v = 0; v < from.vertexCount(); ++v) {
    const SurfacePoint point = foldedBack(images[v], to.faceCount());
    result.push_back(from.isBoundaryVertex(v) ? ontoBoundary(to, point) : point);
  }
  return result;
}

}  // namespace

Result<BorderedCorrespondence> matchBordered(Context& context, const TriangleMesh& a,
                                             const TriangleMesh& b,
                                             const std::vector<SurfacePoint>& points,
                                             const HarmonicMatchOptions& options) {
  ASSIGN_OR_RETURN(const BoundaryMap boundary, fitBoundary(a, b, points));
  ASSIGN_OR_RETURN(const DoubleCover double_a, doubleCover(a.connectivity()));
  ASSIGN_OR_RETURN(const DoubleCover double_b, doubleCover(b.connectivity()));
  ASSIGN_OR_RETURN(const CoverSurface cover,
                   straightCover(context, double_b.connectivity, doubledLengths(double_b, b)));
  ASSIGN_OR_RETURN(
      const TargetLinks start,
      linkBordered(context, a.connectivity(), double_a, b.connectivity(), cover, boundary, points));
  HarmonicMatchOptions anchored = options;
  anchored.anchor = boundaryVertex(a.connectivity());
  ASSIGN_OR_RETURN(const HarmonicMatch match,
                   matchHarmonically(context, double_a.connectivity, doubledLengths(double_a, a),
                                     cover, start, anchored));
  ASSIGN_OR_RETURN(const std::vector<SurfacePoint> inverse,
                   invertCoverMap(context, double_a.connectivity, cover, match.map));
  return BorderedCorrespondence{ofFirstCopy(a.connectivity(), b.connectivity(), match.map.images),
                                ofFirstCopy(b.connectivity(), a.connectivity(), inverse)};
}

}  // namespace moduli
