#include "core/matching/match_spheres.h"

#include <optional>
#include <utility>

#include "core/base/side_by_side.h"
#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/matching/homeomorphism.h"
#include "core/matching/unfold_sphere.h"
#include "core/spherical/landmark_alignment.h"
#include "core/spherical/landmark_map.h"
#include "core/spherical/robust_map.h"
#include "core/spherical/sphere_map.h"

namespace moduli {
namespace {

/// Beside the mean squared distance of the landmarks: keeps the Möbius map from squeezing.
constexpr double kRotationPreference = 0.001;

/// Of what soft landmarks have made of a map: shorter than that of targets, for they are better
/// known.
constexpr double kSoftSmoothing = 0.02;

struct Sphere {
  std::vector<double> lengths;
  Points3 points;
};

/// A conformal map without folded faces: the few that the robust one folds are moved.
Result<Sphere> conformalSphere(Context& context, const TriangleMesh& mesh, bool initial_delaunay) {
  const Connectivity& surface = mesh.connectivity();
  ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(surface, mesh.edgeLengths()));
  Sphere sphere;
  sphere.lengths = unitLengths(mollified.lengths);
  Result<SphereMap> map =
      mapToSphereRobust(context, surface, sphere.lengths, mesh.positions(), initial_delaunay);
  if (map.status().reason() == Reason::kNoConvergence) {
    map = mapToSphereLinear(context, surface, sphere.lengths);
  }
  RETURN_IF_ERROR(map.status());
  sphere.points = std::move(map->points);
  if (map->quality.flipped_faces > 0) {
    ASSIGN_OR_RETURN(sphere.points, unfoldSphere(context, mesh, std::move(sphere.points)));
  }
  return sphere;
}

class SphereMatching {
 public:
  SphereMatching(Context& context, const TriangleMesh& a, const TriangleMesh& b,
                 const SpectralGuess& guess, const MatchOptions& options)
      : context_(context), a_(a), b_(b), guess_(guess), options_(options) {}

  Result<SphereCorrespondence> run() {
    Result<Sphere> first = Sphere(), second = Sphere();
    const bool delaunay = options_.initial_delaunay;
    sideBySide(
        context_, [&](Context& context) { first = conformalSphere(context, a_, delaunay); },
        [&](Context& context) { second = conformalSphere(context, b_, delaunay); });
    ASSIGN_OR_RETURN(sphere_a_, std::move(first));
    ASSIGN_OR_RETURN(Sphere sphere_b, std::move(second));
    ASSIGN_OR_RETURN(const SphereLocator locator,
                     SphereLocator::make(b_.connectivity(), std::move(sphere_b.points)));
    ASSIGN_OR_RETURN(Points3 points, align(locator));
    if (guess_.method == MatchMethod::kNearIsometry) {
      ASSIGN_OR_RETURN(points, straighten(locator, std::move(points)));
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
  /// A's sphere moved onto B's.
  Result<Points3> align(const SphereLocator& b) {
    std::vector<PointPair> pairs;
    for (const Index v : guess_.samples) {
      pairs.push_back(
          {sphere_a_.points[v], spherePoint(b_.connectivity(), b.points(), guess_.points[v])});
    }
    AlignmentOptions alignment;
    alignment.rotation_preference = kRotationPreference;
    ASSIGN_OR_RETURN(const LandmarkAlignment best, alignLandmarks(pairs, alignment));
    Points3 points;
    for (const Eigen::Vector3d& p : sphere_a_.points) points.push_back(best.map(p).normalized());
    return points;
  }

  Result<Points3> straighten(const SphereLocator& b, Points3 start) {
    return fit(b, std::move(start), guess_.points, {});
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
    std::vector<SurfacePoint> targets;
    for (const Eigen::Vector3d& p : points) targets.push_back(b.locate(p));
    HomeomorphismOptions fitting;
    fitting.smoothing = kSoftSmoothing;
    fitting.last_smoothing = kSoftSmoothing;  // Settling would take the landmarks back.
    return fit(b, std::move(points), targets, fitting);
  }

  Result<Points3> fit(const SphereLocator& b, Points3 start,
                      const std::vector<SurfacePoint>& points,
                      const HomeomorphismOptions& fitting) {
    std::vector<VertexTarget> targets;
    for (Index v = 0; v < a_.vertexCount(); ++v) targets.push_back({v, points[v], 1});
    ASSIGN_OR_RETURN(Homeomorphism map,
                     fitHomeomorphism(context_, {a_.connectivity(), a_.positions(), start},
                                      {b, b_.positions()}, targets, fitting));
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
  const TriangleMesh& a_;
  const TriangleMesh& b_;
  const SpectralGuess& guess_;
  const MatchOptions& options_;
  Sphere sphere_a_;
};

}  // namespace

Result<SphereCorrespondence> matchSpheres(Context& context, const TriangleMesh& a,
                                          const TriangleMesh& b, const SpectralGuess& guess,
                                          const MatchOptions& options) {
  return SphereMatching(context, a, b, guess, options).run();
}

}  // namespace moduli
