#include "core/matching/match_bordered.h"

#include <utility>

#include "core/matching/border_landmarks.h"
#include "core/matching/boundary_links.h"
#include "core/matching/cover_inverse.h"
#include "core/matching/landmark_meeting.h"
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

class BorderedMatching {
 public:
  BorderedMatching(Context& context, const TriangleMesh& a, const TriangleMesh& b,
                   const MatchOptions& marks)
      : context_(context), a_(a), b_(b), marks_(marks), surface_(a.connectivity()) {}

  Result<BorderedCorrespondence> run(const std::vector<SurfacePoint>& points,
                                     const HarmonicMatchOptions& options) {
    ASSIGN_OR_RETURN(const std::vector<Index> loops, checkedLoops());
    ASSIGN_OR_RETURN(const BoundaryMap boundary, fitBoundary(a_, b_, points, loops));
    ASSIGN_OR_RETURN(const DoubleCover doubled, doubleCover(b_.connectivity()));
    ASSIGN_OR_RETURN(const CoverSurface cover,
                     straightCover(context_, doubled.connectivity, doubledLengths(doubled, b_)));
    Result<TargetLinks> start =
        linkBordered(context_, surface_, b_.connectivity(), cover, boundary, points);
    if (!start.ok()) return unlinked(start.status(), points, boundary);
    ASSIGN_OR_RETURN(HarmonicMatch match, matchHarmonically(context_, surface_, a_.edgeLengths(),
                                                            cover, *start, options));
    ASSIGN_OR_RETURN(match,
                     meetOnCover(context_, {a_, b_, cover, marks_.landmarks, marks_.soft_landmarks},
                                 std::move(match)));
    return described(cover, match.map);
  }

 private:
  /// What landmarks say of boundary loops.
  Result<std::vector<Index>> checkedLoops() const {
    std::vector<MatchLandmark> all = marks_.landmarks;
    all.insert(all.end(), marks_.soft_landmarks.begin(), marks_.soft_landmarks.end());
    if (all.empty()) return std::vector<Index>();
    const Connectivity& other = b_.connectivity();
    RETURN_IF_ERROR(checkBorderSides(surface_, other, all));
    RETURN_IF_ERROR(checkDistinct(a_, b_, all));
    const BorderPlaces own(a_), there(b_);
    RETURN_IF_ERROR(checkBorderOrder(own, there, surface_, other, marks_.landmarks));
    return loopsByLandmarks(own, there, surface_, other, all);
  }

  /// Where landmarks send a loop elsewhere than the points do, that is why.
  Status unlinked(const Status& status, const std::vector<SurfacePoint>& points,
                  const BoundaryMap& boundary) const {
    const Result<BoundaryMap> own = fitBoundary(a_, b_, points);
    if (status.reason() != Reason::kNoConvergence || !own.ok()) return status;
    const BorderPlaces places(a_);
    for (const auto* landmarks : {&marks_.landmarks, &marks_.soft_landmarks}) {
      for (const MatchLandmark& landmark : *landmarks) {
        const auto at = borderPointAt(surface_, landmark.a);
        if (!at) continue;
        const Index loop = places.loopOf(at->halfedge);
        if (boundary.loops[loop] == own->loops[loop]) continue;
        return {Reason::kNoConvergence,
                landmark.name +
                    " takes a boundary loop to another one than any correspondence of the shapes "
                    "that was found",
                "leave it out, or fill that hole"};
      }
    }
    return status;
  }

  Result<BorderedCorrespondence> described(const CoverSurface& cover, const CoverMap& map) const {
    BorderedCorrespondence result;
    for (Index v = 0; v < a_.vertexCount(); ++v) {
      const SurfacePoint point = foldedBack(map.images[v], b_.faceCount());
      result.images.push_back(surface_.isBoundaryVertex(v) ? ontoBoundary(b_.connectivity(), point)
                                                           : point);
    }
    ASSIGN_OR_RETURN(result.inverse,
                     invertCoverMap(context_, surface_, cover, map, b_.vertexCount()));
    for (Index v = 0; v < b_.vertexCount(); ++v) {
      if (!b_.connectivity().isBoundaryVertex(v)) continue;
      result.inverse[v] = ontoBoundary(surface_, result.inverse[v]);
    }
    result.landmarks = imagesOf(marks_.landmarks, cover, map);
    result.soft_landmarks = imagesOf(marks_.soft_landmarks, cover, map);
    return result;
  }

  std::vector<SurfacePoint> imagesOf(const std::vector<MatchLandmark>& landmarks,
                                     const CoverSurface& cover, const CoverMap& map) const {
    std::vector<SurfacePoint> images;
    for (const MatchLandmark& landmark : landmarks) {
      const SurfacePoint image =
          foldedBack(imageOf(surface_, cover, map, landmark.a), b_.faceCount());
      images.push_back(borderPointAt(surface_, landmark.a) ? ontoBoundary(b_.connectivity(), image)
                                                           : image);
    }
    return images;
  }

  Context& context_;
  const TriangleMesh& a_;
  const TriangleMesh& b_;
  const MatchOptions& marks_;
  const Connectivity& surface_;
};

}  // namespace

Result<BorderedCorrespondence> matchBordered(Context& context, const TriangleMesh& a,
                                             const TriangleMesh& b,
                                             const std::vector<SurfacePoint>& points,
                                             const HarmonicMatchOptions& options,
                                             const MatchOptions& marks) {
  return BorderedMatching(context, a, b, marks).run(points, options);
}

}  // namespace moduli
