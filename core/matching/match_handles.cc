#include "core/matching/match_handles.h"

#include <cmath>
#include <string>
#include <utility>

#include "core/matching/cover_inverse.h"
#include "core/matching/landmark_flow.h"
#include "core/matching/settling.h"
#include "core/matching/sharpened_targets.h"
#include "core/matching/whole_map.h"

namespace moduli {
namespace {

/// Of the root of the area: nearer points are one.
constexpr double kOnePoint = 1e-9;

/// How often a map is evened out on the way to landmarks.
constexpr int kRounds = 4;

/// Of what soft landmarks have made of a map: shorter than that of targets, for they are better
/// known.
constexpr double kSoftSmoothing = 0.02;
/// Towards points known by their places: as fitHomeomorphism's over that length.
constexpr double kShapePull = 4 / (kShapeSmoothing * kShapeSmoothing);

/// Of sharpened targets, as kSoftSmoothing.
constexpr double kSharpSmoothing = 0.02;
/// Of more vertices the neighbourhoods would take too much memory.
constexpr Index kMostSharpened = 2 * kThinnedVertices;

using Landmarks = std::vector<MatchLandmark>;

/// Two landmarks of one point, or with one target, have no map.
Status checkDistinct(const TriangleMesh& a, const TriangleMesh& b, const Landmarks& landmarks) {
  const auto apart = [](const TriangleMesh& mesh, const SurfacePoint& p, const SurfacePoint& q) {
    return (spacePoint(mesh.connectivity(), mesh.positions(), p) -
            spacePoint(mesh.connectivity(), mesh.positions(), q))
               .norm() > kOnePoint * std::sqrt(mesh.area());
  };
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const std::string names = landmarks[j].name + " and " + landmarks[i].name;
      if (!apart(a, landmarks[i].a, landmarks[j].a)) {
        return {Reason::kInvalidOption, names + " coincide on the surface"};
      }
      if (!apart(b, landmarks[i].b, landmarks[j].b)) {
        return {Reason::kInvalidOption, names + " are sent to the same place"};
      }
    }
  }
  return {};
}

Status notMet(const std::vector<CoverLandmark>& landmarks, const std::vector<std::size_t>& around) {
  if (around.size() == 2) {
    return {Reason::kFoldedMap,
            landmarks[around[0]].name + " and " + landmarks[around[1]].name +
                " contradict each other: faces around them fold before both are met",
            "leave one of them out, give it as a soft landmark, or refine the mesh between them"};
  }
  const std::string name = around.empty() ? "a landmark" : landmarks[around[0]].name;
  return {Reason::kFoldedMap, name + " cannot be met: faces around it fold",
          "leave it out, give it as a soft landmark, or refine the mesh around it"};
}

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
    if (!options_.soft_landmarks.empty()) {
      std::vector<CoverLandmark> all = onCover(options_.landmarks);
      for (CoverLandmark& landmark : onCover(options_.soft_landmarks)) {
        all.push_back(std::move(landmark));
      }
      ASSIGN_OR_RETURN(LandmarkFlow flow,
                       flowToLandmarks(context_, surface(), cover_, match.map, all));
      ASSIGN_OR_RETURN(match, evenOut(context_, surface(), a_.edgeLengths(), cover_,
                                      std::move(flow.map), {kSoftSmoothing}));
    }
    if (options_.landmarks.empty()) return match;
    return meet(std::move(match));
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

  /// Where faces are about to fold, evening out makes room to go on.
  Result<HarmonicMatch> meet(HarmonicMatch match) {
    const std::vector<CoverLandmark> exact = onCover(options_.landmarks);
    for (int round = 0;; ++round) {
      ASSIGN_OR_RETURN(LandmarkFlow flow,
                       flowToLandmarks(context_, surface(), cover_, match.map, exact));
      if (flow.met) {
        match.map = std::move(flow.map);
        return match;
      }
      if (round == kRounds) return notMet(exact, flow.around);
      ASSIGN_OR_RETURN(match,
                       evenOut(context_, surface(), a_.edgeLengths(), cover_, std::move(flow.map)));
    }
  }

  const Connectivity& surface() const { return a_.connectivity(); }

  static std::vector<CoverLandmark> onCover(const Landmarks& landmarks) {
    std::vector<CoverLandmark> result;
    for (const MatchLandmark& landmark : landmarks) {
      result.push_back({landmark.a, landmark.b, landmark.name});
    }
    return result;
  }

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
