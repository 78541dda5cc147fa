#include "core/matching/match_handles.h"

#include <utility>

#include "core/matching/cover_inverse.h"
#include "core/matching/landmark_meeting.h"
#include "core/matching/settling.h"
#include "core/matching/sharpened_targets.h"
#include "core/matching/whole_map.h"

namespace moduli {
namespace {

/// Towards points known by their places: as fitHomeomorphism's over that length.
constexpr double kShapePull = 4 / (kShapeSmoothing * kShapeSmoothing);

/// Of sharpened targets, as kSoftSmoothing.
constexpr double kSharpSmoothing = 0.02;
/// Of more vertices the neighbourhoods would take too much memory.
constexpr Index kMostSharpened = 2 * kThinnedVertices;

using Landmarks = std::vector<MatchLandmark>;

class HandleMatching {
 public:
  HandleMatching(Context& context, const MatchPair& pair, const CoverSurface& cover,
                 const MatchOptions& options)
      : context_(context), pair_(pair), a_(pair.a), b_(pair.b), cover_(cover), options_(options) {}

  Result<HarmonicMatch> run(const SpectralGuess& guess) {
    ASSIGN_OR_RETURN(HarmonicMatch match, fit(guess));
    if (pair_.thin_a) {
      ASSIGN_OR_RETURN(match.map, mapWhole(context_, *pair_.thin_a, a_, b_, cover_, match.map));
    }
    return meetOnCover(context_, {a_, b_, cover_, options_.landmarks, options_.soft_landmarks},
                       std::move(match));
  }

  std::vector<SurfacePoint> imagesOf(const Landmarks& landmarks, const CoverMap& map) const {
    std::vector<SurfacePoint> images;
    for (const MatchLandmark& landmark : landmarks) {
      images.push_back(imageOf(surface(), cover_, map, landmark.a));
    }
    return images;
  }

 private:
  /// Of the coarse surface. Sharpened only where targets are at odds with each other, for most
  /// surfaces have no limbs as thin as that.
  Result<HarmonicMatch> fit(const SpectralGuess& guess) {
    const TriangleMesh& from = pair_.coarseA();
    const std::vector<double> lengths = from.edgeLengths();
    const Result<TargetLinks> links =
        linkTargets(context_, from.connectivity(), cover_, guess.points);
    if (links.ok() || links.status().reason() != Reason::kNoConvergence ||
        from.vertexCount() > kMostSharpened) {
      RETURN_IF_ERROR(links.status());
      ASSIGN_OR_RETURN(HarmonicMatch match,
                       matchHarmonically(context_, from.connectivity(), lengths, cover_, *links));
      return settled(guess, guess.points, std::move(match));
    }
    ASSIGN_OR_RETURN(const SharpTargets sharp, sharpenTargets(context_, from, b_, guess.points));
    ASSIGN_OR_RETURN(
        const TargetLinks sharp_links,
        linkTargets(context_, from.connectivity(), cover_, sharp.vertices, sharp.ways));
    ASSIGN_OR_RETURN(HarmonicMatch match,
                     matchHarmonically(context_, from.connectivity(), lengths, cover_, sharp_links,
                                       {kSharpSmoothing}));
    return settled(guess, sharp.vertices, std::move(match));
  }

  Result<HarmonicMatch> settled(const SpectralGuess& guess, const std::vector<SurfacePoint>& points,
                                HarmonicMatch match) {
    if (guess.method == MatchMethod::kNearIsometry) {
      SettlingOptions settling;
      if (guess.by_shape) settling.pull = kShapePull;
      RETURN_IF_ERROR(settle(context_, pair_.coarseA(), b_, cover_, points, match.map, settling));
    }
    return match;
  }

  const Connectivity& surface() const { return a_.connectivity(); }

  Context& context_;
  const MatchPair& pair_;
  const TriangleMesh& a_;
  const TriangleMesh& b_;
  const CoverSurface& cover_;
  const MatchOptions& options_;
};

}  // namespace

Result<HandleCorrespondence> matchHandles(Context& context, const MatchPair& pair,
                                          const CoverSurface& cover, const SpectralGuess& guess,
                                          const MatchOptions& options) {
  const TriangleMesh &a = pair.a, &b = pair.b;
  Landmarks all = options.landmarks;
  all.insert(all.end(), options.soft_landmarks.begin(), options.soft_landmarks.end());
  RETURN_IF_ERROR(checkDistinct(a, b, all));
  HandleMatching matching(context, pair, cover, options);
  HandleCorrespondence result;
  ASSIGN_OR_RETURN(result.match, matching.run(guess));
  ASSIGN_OR_RETURN(result.inverse,
                   invertCoverMap(context, a.connectivity(), cover, result.match.map));
  result.images = result.match.map.images;
  result.landmarks = matching.imagesOf(options.landmarks, result.match.map);
  result.soft_landmarks = matching.imagesOf(options.soft_landmarks, result.match.map);
  return result;
}

}  // namespace moduli
