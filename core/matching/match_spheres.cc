#include "core/matching/match_spheres.h"

#include <optional>
#include <utility>

#include "core/base/side_by_side.h"
#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/matching/conformal_sphere.h"
#include "core/matching/homeomorphism.h"
#include "core/matching/unfold_sphere.h"
#include "core/matching/whole_map.h"
#include "core/spherical/landmark_map.h"

namespace moduli {
namespace {

/// Of what soft landmarks have made of a map: shorter than that of targets, for they are better
/// known.
constexpr double kSoftSmoothing = 0.02;

class SphereMatching {
 public:
  SphereMatching(Context& context, const MatchPair& pair, const SpectralGuess& guess,
                 const MatchOptions& options)
      : context_(context), pair_(pair), a_(pair.a), b_(pair.b), guess_(guess), options_(options) {}

  Result<SphereCorrespondence> run() {
    const bool near_isometry = guess_.method == MatchMethod::kNearIsometry;
    const bool coarse = near_isometry && pair_.thin_a.has_value();
    const TriangleMesh& from = coarse ? pair_.coarseA() : a_;
    Result<ConformalSphere> first = ConformalSphere(), second = ConformalSphere();
    sideBySide(
        context_, [&](Context& context) { first = sphereOf(context, from); },
        [&](Context& context) { second = sphereOf(context, b_); });
    ASSIGN_OR_RETURN(sphere_a_, std::move(first));
    ASSIGN_OR_RETURN(ConformalSphere sphere_b, std::move(second));
    ASSIGN_OR_RETURN(const SphereLocator locator,
                     SphereLocator::make(b_.connectivity(), std::move(sphere_b.points)));
    ASSIGN_OR_RETURN(Points3 points, align(locator, coarse));
    if (near_isometry) {
      HomeomorphismOptions fitting;
      if (guess_.by_shape) fitting.smoothing = fitting.last_smoothing = kShapeSmoothing;
      ASSIGN_OR_RETURN(points, fit(locator, from, std::move(points), targets(coarse), fitting));
    }
    if (coarse) {
      ASSIGN_OR_RETURN(points, ofWhole(locator, points));
    }
    if (!options_.soft_landmarks.empty()) {
      ASSIGN_OR_RETURN(points, draw(locator, std::move(points)));
    }
    if (!options_.landmarks.empty()) {
      LandmarkMapOptions meeting;
      meeting.align = guess_.method != MatchMethod::kNearIsometry;
      ASSIGN_OR_RETURN(points, meet(locator, std::move(points), options_.landmarks, meeting));
    }
    const Context::Stage stage(context_, "locate");
    SphereCorrespondence result;
    for (const Eigen::Vector3d& p : points) result.images.push_back(locator.locate(p));
    for (const auto& [landmarks, images] :
         {std::pair(&options_.landmarks, &result.landmarks),
          std::pair(&options_.soft_landmarks, &result.soft_landmarks)}) {
      for (const MatchLandmark& landmark : *landmarks) {
        images->push_back(locator.locate(spherePoint(a_.connectivity(), points, landmark.a)));
      }
    }
    ASSIGN_OR_RETURN(result.inverse,
                     invertHomeomorphism(context_, a_.connectivity(), points, locator));
    return result;
  }

 private:
  Result<ConformalSphere> sphereOf(Context& context, const TriangleMesh& mesh) const {
    return conformalSphere(context, mesh, options_.initial_delaunay);
  }

  /// A's sphere, or that of what stands for it, moved onto B's. What is very small may fold on the
  /// way, by rounding.
  Result<Points3> align(const SphereLocator& b, bool coarse) {
    std::vector<PointPair> pairs;
    for (const Index i : guess_.samples) {
      pairs.push_back({sphere_a_.points[coarse ? i : guess_.vertices[i]],
                       spherePoint(b_.connectivity(), b.points(), guess_.points[i])});
    }
    ASSIGN_OR_RETURN(Points3 points, broughtNear(sphere_a_.points, pairs));
    return unfoldSphere(context_, coarse ? pair_.coarseA() : a_, std::move(points));
  }

  std::vector<VertexTarget> targets(bool coarse) const {
    std::vector<VertexTarget> targets;
    for (std::size_t i = 0; i < guess_.points.size(); ++i) {
      const Index v = coarse ? static_cast<Index>(i) : guess_.vertices[i];
      targets.push_back({v, guess_.points[i], 1});
    }
    return targets;
  }

  /// Of all vertices, from the thinned surface's. Its own sphere takes the place of the latter's.
  Result<Points3> ofWhole(const SphereLocator& b, const Points3& points) {
    ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(a_.connectivity(), a_.edgeLengths()));
    sphere_a_.lengths = unitLengths(mollified.lengths);
    return mapWhole(context_, *pair_.thin_a, a_, {b, b_.positions()}, points);
  }

  /// To soft landmarks, together with the others, as far as that goes, and evened out again.
  Result<Points3> draw(const SphereLocator& b, Points3 points) {
    std::vector<MatchLandmark> all = options_.landmarks;
    all.insert(all.end(), options_.soft_landmarks.begin(), options_.soft_landmarks.end());
    LandmarkMapOptions meeting;
    meeting.align = guess_.method != MatchMethod::kNearIsometry;
    meeting.partly = true;
    ASSIGN_OR_RETURN(points, meet(b, std::move(points), all, meeting));
    if (guess_.method != MatchMethod::kNearIsometry) return points;
    std::vector<VertexTarget> there;
    for (Index v = 0; v < a_.vertexCount(); ++v) there.push_back({v, b.locate(points[v]), 1});
    HomeomorphismOptions fitting;
    fitting.smoothing = kSoftSmoothing;
    fitting.last_smoothing = kSoftSmoothing;  // Settling would take the landmarks back.
    return fit(b, a_, std::move(points), there, fitting);
  }

  Result<Points3> fit(const SphereLocator& b, const TriangleMesh& from, Points3 start,
                      const std::vector<VertexTarget>& there, const HomeomorphismOptions& fitting) {
    ASSIGN_OR_RETURN(Homeomorphism map,
                     fitHomeomorphism(context_, {from.connectivity(), from.positions(), start},
                                      {b, b_.positions()}, there, fitting));
    return std::move(map.points);
  }

  Result<Points3> meet(const SphereLocator& b, Points3 points,
                       const std::vector<MatchLandmark>& wanted,
                       const LandmarkMapOptions& meeting) {
    std::vector<Landmark> landmarks;
    for (const MatchLandmark& landmark : wanted) {
      landmarks.push_back(
          {landmark.a, spherePoint(b_.connectivity(), b.points(), landmark.b), landmark.name});
    }
    ASSIGN_OR_RETURN(LandmarkMap met, meetLandmarks(context_, a_.connectivity(), sphere_a_.lengths,
                                                    std::move(points), landmarks, meeting));
    return std::move(met.points);
  }

  Context& context_;
  const MatchPair& pair_;
  const TriangleMesh& a_;
  const TriangleMesh& b_;
  const SpectralGuess& guess_;
  const MatchOptions& options_;
  ConformalSphere sphere_a_;
};

}  // namespace

Result<SphereCorrespondence> matchSpheres(Context& context, const MatchPair& pair,
                                          const SpectralGuess& guess, const MatchOptions& options) {
  return SphereMatching(context, pair, guess, options).run();
}

}  // namespace moduli
