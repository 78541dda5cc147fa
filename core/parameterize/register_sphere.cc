#include "core/parameterize/register_sphere.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/parameterize/genus_zero.h"
#include "core/spherical/hemispheres.h"
#include "core/spherical/sphere_locator.h"

namespace moduli {
namespace {

/// A sphere with the faces that its map has.
struct FineSphere {
  const MappedSphere& given;
  std::optional<Connectivity> refined;
  std::vector<double> lengths;
  std::vector<double> field;  ///< Per vertex of surface(); empty where there is none.

  const Connectivity& surface() const { return refined ? *refined : given.surface; }
  const Points3& points() const { return given.map.sphere; }

  SurfacePoint carried(const SurfacePoint& point) const {
    if (!refined) return point;
    return pointInPieces(given.surface, *given.map.subdivision, *refined, point);
  }
};

Result<FineSphere> fineSphere(const MappedSphere& given, const char* name) {
  const auto vertices = static_cast<std::size_t>(given.surface.vertexCount());
  if (!given.field.empty() && given.field.size() != vertices) {
    return Status(Reason::kInvalidOption, std::string(name) + ": the field has " +
                                              std::to_string(given.field.size()) + " values for " +
                                              std::to_string(vertices) + " vertices");
  }
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(given.surface, given.lengths));
  FineSphere fine{given, {}, mollified.lengths, given.field};
  if (given.map.subdivision) {
    const Subdivision& cut = *given.map.subdivision;
    ASSIGN_OR_RETURN(
        fine.refined,
        Connectivity::fromFaces(static_cast<Index>(vertices + cut.vertices.size()), cut.faces));
    fine.lengths = subdividedLengths(given.surface, mollified.lengths, cut, *fine.refined);
    if (!fine.field.empty()) {
      for (const Subdivision::Vertex& vertex : cut.vertices) {
        fine.field.push_back((1 - vertex.fraction) *
                                 given.field[given.surface.tail(vertex.halfedge)] +
                             vertex.fraction * given.field[given.surface.head(vertex.halfedge)]);
      }
    }
  }
  if (fine.points().size() != static_cast<std::size_t>(fine.surface().vertexCount())) {
    return Status(Reason::kInvalidOption,
                  std::string(name) + ": the map to the sphere has not a point for every vertex");
  }
  return fine;
}

/// The weights of a piece's corner among those of the whole face.
Eigen::Vector3d weightsInFace(const Connectivity& surface, const Subdivision& cut, Index face,
                              Index v) {
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) {
    if (surface.face(face)[c] != v) continue;
    weights[c] = 1;
    return weights;
  }
  const Subdivision::Vertex& vertex = cut.vertices[v - surface.vertexCount()];
  for (int c = 0; c < 3; ++c) {
    const Index h = 3 * face + c;
    if (surface.edge(h) != surface.edge(vertex.halfedge)) continue;
    const double t = h == vertex.halfedge ? vertex.fraction : 1 - vertex.fraction;
    weights[c] = 1 - t;
    weights[(c + 1) % 3] = t;
    return weights;
  }
  return weights;
}

/// The corner that a point is; kNone within edges and faces.
Index vertexOf(const Connectivity& surface, const SurfacePoint& point) {
  for (int c = 0; c < 3; ++c) {
    if (point.barycentric[c] == 1) return surface.face(point.face)[c];
  }
  return kNone;
}

class SphereRegistering {
 public:
  SphereRegistering(Context& context, FineSphere sphere, FineSphere reference,
                    const SphereRegistrationOptions& options)
      : context_(context),
        sphere_(std::move(sphere)),
        reference_(std::move(reference)),
        options_(options) {}

  Result<SphereRegistration> run() {
    RETURN_IF_ERROR(gatherLandmarks());
    RETURN_IF_ERROR(chooseField());
    target_ = options_.mirror ? mirrorSphere(reference_.surface(), reference_.points())
                              : MirroredSphere{reference_.surface(), reference_.points()};
    weights_ = vertexAreas(sphere_.surface(), sphere_.lengths);
    auto at_target = SphereLocator::make(target_->surface, target_->points);
    if (!at_target.ok()) return at_target.status().withContext("the reference");
    RETURN_IF_ERROR(move(*at_target));
    RETURN_IF_ERROR(compare(*at_target));
    result_.quality = measureSphereMap(sphere_.surface(), sphere_.lengths, result_.points);
    if (result_.quality.flipped_faces == 0) return std::move(result_);
    return foldedMap("the registered sphere", result_.quality.flipped_faces,
                     sphere_.surface().faceCount(),
                     "parts of it are thinner than doubles tell apart once they are moved");
  }

 private:
  /// Single pairs, then points of curves; of these none that is a pair of vertices already.
  Status gatherLandmarks() {
    std::set<std::pair<Index, Index>> vertices;
    for (const SphereLandmark& landmark : options_.landmarks) {
      RETURN_IF_ERROR(checkSurfacePoint(sphere_.given.surface, landmark.point, landmark.name));
      RETURN_IF_ERROR(checkSurfacePoint(reference_.given.surface, landmark.reference,
                                        landmark.name + " of the reference"));
      vertices.insert(verticesOf(landmark));
      add(landmark);
    }
    for (const SphereCurve& curve : options_.curves) {
      const CurvePair& pair = curve.pair;
      auto a = resampleCurve(sphere_.given.surface, sphere_.given.lengths, pair.path_a, pair.count,
                             pair.closed);
      if (!a.ok()) return a.status().withContext(curve.name);
      auto b = resampleCurve(reference_.given.surface, reference_.given.lengths, pair.path_b,
                             pair.count, pair.closed);
      if (!b.ok()) return b.status().withContext(curve.name + ": on the reference");
      for (std::size_t i = 0; i < a->size(); ++i) {
        const SphereLandmark landmark{
            (*a)[i], (*b)[i], curve.name + " (point " + std::to_string(i + 1) + " of the curve)"};
        const auto ends = verticesOf(landmark);
        const bool known =
            ends.first != kNone && ends.second != kNone && !vertices.insert(ends).second;
        if (!known) add(landmark);
      }
    }
    result_.landmarks = static_cast<int>(landmarks_.size());
    return {};
  }

  std::pair<Index, Index> verticesOf(const SphereLandmark& landmark) const {
    return {vertexOf(sphere_.given.surface, landmark.point),
            vertexOf(reference_.given.surface, landmark.reference)};
  }

  void add(const SphereLandmark& landmark) {
    Eigen::Vector3d target = spherePoint(reference_.surface(), reference_.points(),
                                         reference_.carried(landmark.reference));
    if (options_.mirror) target.x() = -target.x();
    landmarks_.push_back({sphere_.carried(landmark.point), target, landmark.name});
  }

  Status chooseField() {
    const bool both = !sphere_.field.empty() && !reference_.field.empty();
    if (both) result_.field = ComparedField::kGiven;
    if (both || !landmarks_.empty()) return {};
    if (sphere_.field.empty() != reference_.field.empty()) {
      return {Reason::kInvalidOption, "only one of the surfaces has a field",
              "give the same field of both, or landmarks"};
    }
    result_.field = ComparedField::kAreaDistortion;
    sphere_.field = areaDistortion(sphere_.surface(), sphere_.lengths, sphere_.points());
    reference_.field =
        areaDistortion(reference_.surface(), reference_.lengths, reference_.points());
    return {};
  }

  Status move(const SphereLocator& at_target) {
    if (!landmarks_.empty()) return meet(at_target);
    ASSIGN_OR_RETURN(const SphereLocator here,
                     SphereLocator::make(sphere_.surface(), sphere_.points()));
    const SphereField a{here, sphere_.field}, b{at_target, reference_.field};
    ASSIGN_OR_RETURN(const FieldAlignment best,
                     alignFields(context_, a, weights_, b, options_.search));
    for (const Eigen::Vector3d& p : sphere_.points()) {
      result_.points.push_back((best.rotation * p).normalized());
    }
    ASSIGN_OR_RETURN(result_.correlation_before, correlate(sphere_.points(), at_target));
    return {};
  }

  Status meet(const SphereLocator& at_target) {
    ASSIGN_OR_RETURN(LandmarkMap met,
                     meetLandmarks(context_, sphere_.surface(), sphere_.lengths, sphere_.points(),
                                   landmarks_, options_.meeting));
    result_.landmark_distance = *std::max_element(met.distances.begin(), met.distances.end());
    result_.mean_beltrami = met.mean_beltrami;
    result_.max_beltrami = met.max_beltrami;
    result_.points = std::move(met.points);
    if (result_.field == ComparedField::kNothing) return {};
    ASSIGN_OR_RETURN(result_.correlation_before, correlate(sphere_.points(), at_target));
    return {};
  }

  Result<double> correlate(const Points3& points, const SphereLocator& at_target) const {
    RETURN_IF_ERROR(context_.check());
    ASSIGN_OR_RETURN(const SphereLocator here, SphereLocator::make(sphere_.surface(), points));
    return fieldCorrelation({here, sphere_.field}, weights_, {at_target, reference_.field},
                            Eigen::Matrix3d::Identity());
  }

  /// Carries the reference's field, and judges how like the other it is.
  Status compare(const SphereLocator& at_target) {
    if (reference_.field.empty()) return {};
    const Context::Stage stage(context_, "compare");
    constexpr std::size_t kBetweenChecks = 10000;
    for (std::size_t v = 0; v < result_.points.size(); ++v) {
      if (v % kBetweenChecks == 0) RETURN_IF_ERROR(context_.check());
      const SurfacePoint place = at_target.locate(result_.points[v]);
      result_.carried.push_back(valueAt(target_->surface, reference_.field, place));
    }
    if (result_.field != ComparedField::kNothing) {
      double sum = 0, total = 0;
      for (std::size_t v = 0; v < weights_.size(); ++v) {
        sum += weights_[v] * std::abs(sphere_.field[v] - result_.carried[v]);
        total += weights_[v];
      }
      result_.mean_absolute_difference = sum / total;
      ASSIGN_OR_RETURN(result_.correlation_after, correlate(result_.points, at_target));
    }
    result_.carried.resize(static_cast<std::size_t>(sphere_.given.surface.vertexCount()));
    return {};
  }

  Context& context_;
  FineSphere sphere_, reference_;
  const SphereRegistrationOptions& options_;
  std::optional<MirroredSphere> target_;  ///< The reference, or its mirror image.
  std::vector<double> weights_;
  std::vector<Landmark> landmarks_;
  SphereRegistration result_;
};

}  // namespace

SurfacePoint pointInPieces(const Connectivity& surface, const Subdivision& cut,
                           const Connectivity& refined, const SurfacePoint& point) {
  for (int c = 0; c < 3; ++c) {
    if (point.barycentric[c] == 1) return vertexPoint(refined, surface.face(point.face)[c]);
  }
  const Eigen::Vector3d wanted(point.barycentric.data());
  const auto [first, last] = std::equal_range(cut.parent.begin(), cut.parent.end(), point.face);
  SurfacePoint best;
  double depth = -std::numeric_limits<double>::infinity();
  for (auto piece = first; piece != last; ++piece) {
    const auto f = static_cast<Index>(piece - cut.parent.begin());
    Eigen::Matrix3d corners;
    for (int c = 0; c < 3; ++c) {
      corners.col(c) = weightsInFace(surface, cut, point.face, cut.faces[f][c]);
    }
    const Eigen::Vector3d weights = corners.partialPivLu().solve(wanted);
    if (!(weights.minCoeff() > depth)) continue;
    depth = weights.minCoeff();
    const Eigen::Vector3d inside = weights.cwiseMax(0) / weights.cwiseMax(0).sum();
    best = {f, {inside[0], inside[1], inside[2]}};
  }
  return best;
}

std::optional<Parameterization> asSphere(const Connectivity& surface,
                                         const std::vector<double>& lengths,
                                         const std::vector<Eigen::Vector3d>& positions) {
  constexpr double kRound = 1e-3;
  if (positions.empty() || !checkGenusZero(surface, "", 0, 0).ok()) return {};
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (const Eigen::Vector3d& p : positions) {
    nearest = std::min(nearest, p.stableNorm());
    farthest = std::max(farthest, p.stableNorm());
  }
  if (!(nearest > 0) || !(farthest - nearest <= kRound * farthest)) return {};
  Parameterization map;
  for (const Eigen::Vector3d& p : positions) map.sphere.push_back(p.stableNormalized());
  map.certificate.quality = measureSphereMap(surface, lengths, map.sphere);
  const MapQuality& quality = map.certificate.quality;
  if (quality.flipped_faces > 0 || std::abs(quality.covering_degree - 1) > 0.5) return {};
  for (Index h = 0; h < surface.halfedgeCount(); ++h) map.corner.push_back(surface.tail(h));
  return map;
}

std::vector<double> areaDistortion(const Connectivity& surface, const std::vector<double>& lengths,
                                   const Points3& points) {
  const std::vector<double> areas = vertexAreas(surface, lengths);
  std::vector<double> images(areas.size(), 0.0), field;
  for (const auto& [a, b, c] : surface.faces()) {
    const double third = signedSolidAngle(points[a], points[b], points[c]) / 3;
    for (const Index v : {a, b, c}) images[v] += third;
  }
  // Areas below the smallest number stay finite.
  constexpr double kLeast = std::numeric_limits<double>::min();
  for (std::size_t v = 0; v < areas.size(); ++v) {
    field.push_back(std::log(std::max(areas[v], kLeast)) - std::log(std::max(images[v], kLeast)));
  }
  return field;
}

Result<SphereRegistration> registerSphere(Context& context, const MappedSphere& sphere,
                                          const MappedSphere& reference,
                                          const SphereRegistrationOptions& options) {
  ASSIGN_OR_RETURN(FineSphere fine, fineSphere(sphere, "the surface"));
  ASSIGN_OR_RETURN(FineSphere fine_reference, fineSphere(reference, "the reference"));
  return SphereRegistering(context, std::move(fine), std::move(fine_reference), options).run();
}

}  // namespace moduli
