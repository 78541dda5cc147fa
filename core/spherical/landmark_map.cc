#include "core/spherical/landmark_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "core/spherical/beltrami_field.h"
#include "core/spherical/exact_sign.h"
#include "core/spherical/landmark_alignment.h"
#include "core/spherical/landmark_chart.h"
#include "core/spherical/landmark_checks.h"
#include "core/spherical/map_quality.h"

namespace moduli {
namespace {

using spherical::BeltramiCoefficients;
using spherical::BeltramiField;
using spherical::Pin;

/// Landmarks that are this near to their targets are met.
constexpr double kMet = 1e-12;
/// The charts overlap between the radii 1 / kReach and kReach.
constexpr double kReach = 1.5;
/// Pull of conformality on the smoothed coefficients.
constexpr double kDamping = 0.3;
/// Landmarks this near to a fold have to do with it.
constexpr double kNear = 0.3;
/// A round of polishing that gains less than this part is the last.
constexpr double kWorthwhile = 0.01;

/// The first face that is not positively oriented, or kNone. A sphere covered by positive
/// triangles alone, of total area 4 pi, is covered once: the map is bijective.
Index findFold(const Connectivity& surface, const Points3& points) {
  double solid_angle = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto& [a, b, c] = surface.face(f);
    if (spherical::orientationSign(points[a], points[b], points[c]) <= 0) return f;
    solid_angle += signedSolidAngle(points[a], points[b], points[c]);
  }
  return std::abs(solid_angle - 4 * std::numbers::pi) < 1 ? kNone : 0;
}

class LandmarkHomotopy {
 public:
  LandmarkHomotopy(const Connectivity& surface, const BeltramiField& field, Points3 points,
                   const std::vector<Landmark>& landmarks, const LandmarkMapOptions& options)
      : surface_(surface),
        field_(field),
        points_(std::move(points)),
        landmarks_(landmarks),
        options_(options) {
    for (const Landmark& landmark : landmarks) {
      pins_.push_back({landmark.point, landmark.target.normalized()});
      starts_.push_back(spherePoint(surface, points_, landmark.point));
      targets_.push_back(pins_.back().target);
    }
  }

  Status run(Context& context) {
    double farthest = 0;
    for (std::size_t i = 0; i < pins_.size(); ++i) {
      const double angle = spherical::angleBetween(starts_[i], targets_[i]);
      if (i == 0 || angle > farthest) pole_ = starts_[i];
      farthest = std::max(farthest, angle);
    }
    const double longest = 1 / std::ceil(std::max(farthest / options_.longest_step, 1.0));
    if (farthest <= kMet) return {};  // The alignment met them all.
    double done = 0, step = longest;
    int halvings = 0;
    while (done < 1) {
      RETURN_IF_ERROR(context.check());
      context.report("landmarks", done);
      // Steps are binary fractions of the longest: the last one ends at 1 but for rounding.
      const double next = done + step > 1 - 1e-9 ? 1 : done + step;
      ASSIGN_OR_RETURN(const bool moved, advance(context, next));
      if (moved) {
        done = next;
        step = std::min(2 * step, longest);
        halvings = std::max(0, halvings - 1);
        ++steps_;
      } else {
        step /= 2;
        ++halvings_;
        if (++halvings <= options_.max_halvings) continue;
        if (!options_.partly) return foldedMap(done);
        break;
      }
    }
    return done < 1 ? Status() : polish(context);
  }

  const Points3& points() const { return points_; }
  int steps() const { return steps_; }
  int halvings() const { return halvings_; }

 private:
  /// Goes to time t of the homotopy; false if that folds.
  Result<bool> advance(Context& context, double t) {
    for (std::size_t i = 0; i < pins_.size(); ++i) {
      pins_[i].target = spherical::alongArc(starts_[i], targets_[i], t);
      if (t == 1) pins_[i].target = targets_[i];
    }
    const BeltramiCoefficients mu = field_.measure(points_);
    ASSIGN_OR_RETURN(const BeltramiCoefficients smooth, field_.smooth(context, mu, options_.bound));
    for (const BeltramiCoefficients* wanted : {&smooth, &mu}) {
      ASSIGN_OR_RETURN(auto moved, solveCharts(context, *wanted, wanted == &mu, 1));
      if (!moved) continue;
      points_ = std::move(*moved);
      return true;
    }
    return false;
  }

  /// Rounds with the landmarks in place, while they make the map more conformal.
  Status polish(Context& context) {
    BeltramiCoefficients mu = field_.measure(points_);
    double energy = energyOf(mu);
    for (int round = 0; round < options_.polishing; ++round) {
      ASSIGN_OR_RETURN(const BeltramiCoefficients smooth,
                       field_.smooth(context, mu, options_.bound));
      ASSIGN_OR_RETURN(auto moved, solveCharts(context, smooth, false, 2));
      if (!moved) break;
      mu = field_.measure(*moved);
      const double next = energyOf(mu);
      if (!(next < energy)) break;
      points_ = std::move(*moved);
      if (next > (1 - kWorthwhile) * energy) break;
      energy = next;
    }
    return {};
  }

  /// Both charts in turn, so many times; nothing where a face folds. `own`: the coefficients wanted
  /// are those that the map has.
  Result<std::optional<Points3>> solveCharts(Context& context, const BeltramiCoefficients& wanted,
                                             bool own, int rounds) {
    Points3 points = points_;
    for (int half = 0; half < 2 * rounds; ++half) {
      const BeltramiCoefficients mu = field_.measure(points);
      const spherical::ChartProblem problem{surface_,          field_, mu,
                                            own ? mu : wanted, pins_,  options_.stiffness};
      const Eigen::Vector3d pole = half % 2 == 0 ? pole_ : Eigen::Vector3d(-pole_);
      ASSIGN_OR_RETURN(points, relaxChart(context, problem, std::move(points), pole, kReach));
    }
    const bool met = snap(points);
    const Index fold = findFold(surface_, points);
    if (met && fold == kNone) return std::optional<Points3>(std::move(points));
    if (fold != kNone) {
      const auto& [a, b, c] = surface_.face(fold);
      fold_ = (points[a] + points[b] + points[c]).normalized();
    }
    return std::optional<Points3>();
  }

  /// Takes the last digits from the landmarks' distances by the least motion of their corners;
  /// false where that does not converge (sweeps over rows that are far from orthogonal).
  bool snap(Points3& points) const {
    for (int sweep = 0; sweep < 100; ++sweep) {
      double worst = 0;
      for (const Pin& pin : pins_) {
        const Eigen::Vector3d miss = pin.target - spherePoint(surface_, points, pin.point);
        if (!(miss.norm() < 0.1)) return false;
        worst = std::max(worst, miss.norm());
        if (miss.norm() > 1e-15) moveCorners(points, pin, miss);
      }
      if (worst < 1e-14) return true;
    }
    return false;
  }

  void moveCorners(Points3& points, const Pin& pin, const Eigen::Vector3d& miss) const {
    double square = 0;
    for (const double weight : pin.point.barycentric) square += weight * weight;
    for (int c = 0; c < 3; ++c) {
      const double weight = pin.point.barycentric[c];
      if (weight == 0) continue;
      Eigen::Vector3d& p = points[surface_.face(pin.point.face)[c]];
      p = (p + weight / square * miss).normalized();
      if (weight == 1) p = pin.target;
    }
  }

  double energyOf(const BeltramiCoefficients& mu) const {
    double sum = 0;
    for (std::size_t f = 0; f < mu.size(); ++f) {
      sum += field_.frames()[f].area() * std::norm(mu[f]);
    }
    return sum;
  }

  /// Names the landmark nearest to the last fold, and the next one if it is near, too.
  Status foldedMap(double done) const {
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t i = 0; i < pins_.size(); ++i) {
      near.emplace_back((pins_[i].target - fold_).norm(), i);
    }
    std::sort(near.begin(), near.end());
    const std::string percent = std::to_string(static_cast<int>(100 * done)) + " percent";
    if (near.size() > 1 && near[1].first < kNear) {
      const auto [first, second] = std::minmax(near[0].second, near[1].second);
      return {Reason::kFoldedMap,
              spherical::landmarkNames(landmarks_, first, second) +
                  " contradict each other: faces between them fold beyond " + percent +
                  " of their way",
              "leave one of them out, or refine the mesh between them"};
    }
    return {Reason::kFoldedMap,
            spherical::landmarkName(landmarks_, near[0].second) + " folds the map beyond " +
                percent + " of its way",
            "align the spheres first, leave that landmark out, or refine the mesh near it"};
  }

  const Connectivity& surface_;
  const BeltramiField& field_;
  Points3 points_;
  const std::vector<Landmark>& landmarks_;
  const LandmarkMapOptions& options_;
  std::vector<Pin> pins_;
  Points3 starts_, targets_;
  Eigen::Vector3d pole_ = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d fold_ = Eigen::Vector3d::UnitZ();  ///< Where the last attempt folded.
  int steps_ = 0, halvings_ = 0;
};

Status checkMap(const Connectivity& surface, const Points3& points,
                const LandmarkMapOptions& options) {
  if (!(options.stiffness > 0) || !(options.smoothing >= 0) || !(options.bound > 0) ||
      !(options.bound < 1) || !(options.longest_step > 0)) {
    return {Reason::kInvalidOption,
            "a landmark map needs stiffness > 0, smoothing >= 0, a bound in (0, 1) and steps > 0"};
  }
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (surface.isBoundaryEdge(e)) {
      return {Reason::kUnsupportedTopology, "a map to the sphere needs a closed surface"};
    }
  }
  if (points.size() != static_cast<std::size_t>(surface.vertexCount())) {
    return {Reason::kInvalidOption, "a map to the sphere needs one point for every vertex"};
  }
  if (const Index f = findFold(surface, points); f != kNone) {
    return {Reason::kFoldedMap, "the given map folds at face " + std::to_string(f)};
  }
  return {};
}

/// |mu| from the flat faces over the given points to those over the new ones.
void measureBending(const Connectivity& surface, const Points3& given, LandmarkMap& map) {
  double total = 0, sum = 0;
  for (const auto& [a, b, c] : surface.faces()) {
    const FaceFrame from = spherical::chordFrame(given[a], given[b], given[c]);
    const FaceFrame to = spherical::chordFrame(map.points[a], map.points[b], map.points[c]);
    const double mu = std::abs(spherical::FaceMap::between(from, to.base, {to.x, to.y}).beltrami());
    sum += from.area() * mu;
    total += from.area();
    map.max_beltrami = std::max(map.max_beltrami, mu);
  }
  map.mean_beltrami = sum / total;
}

/// The points moved by the best Möbius map that folds no face.
Result<Points3> aligned(const Connectivity& surface, Points3 points,
                        const std::vector<Landmark>& landmarks, const LandmarkMapOptions& options) {
  std::vector<PointPair> pairs;
  for (const Landmark& landmark : landmarks) {
    pairs.push_back({spherePoint(surface, points, landmark.point), landmark.target});
  }
  const Result<LandmarkAlignment> best =
      alignLandmarks(pairs, {.rotation_preference = options.rotation_preference, .rigid = false});
  if (best.ok()) {
    Points3 moved = points;
    for (Eigen::Vector3d& p : moved) p = best->map(p);
    if (findFold(surface, moved) == kNone) return moved;
  }
  ASSIGN_OR_RETURN(const Eigen::Matrix3d rotation, bestRotation(pairs));
  for (Eigen::Vector3d& p : points) p = (rotation * p).normalized();
  return points;
}

}  // namespace

Result<LandmarkMap> meetLandmarks(Context& context, const Connectivity& surface,
                                  const std::vector<double>& lengths, Points3 points,
                                  const std::vector<Landmark>& landmarks,
                                  const LandmarkMapOptions& options) {
  RETURN_IF_ERROR(checkMap(surface, points, options));
  RETURN_IF_ERROR(spherical::checkLandmarks(surface, points, landmarks));
  const Context::Stage stage(context, "landmarks");
  LandmarkMap map;
  map.points = points;
  const auto distance = [&](const Landmark& landmark) {
    return (spherePoint(surface, map.points, landmark.point) - landmark.target.normalized()).norm();
  };
  const bool met = std::all_of(landmarks.begin(), landmarks.end(), [&](const Landmark& landmark) {
    return distance(landmark) <= kMet;
  });
  if (!met) {
    if (options.align) {
      ASSIGN_OR_RETURN(map.points, aligned(surface, std::move(map.points), landmarks, options));
    }
    if (!options.partly) {
      RETURN_IF_ERROR(spherical::checkPaths(context, surface, map.points, landmarks));
    }
    ASSIGN_OR_RETURN(const BeltramiField field, BeltramiField::make(context, surface, map.points,
                                                                    options.smoothing, kDamping));
    LandmarkHomotopy homotopy(surface, field, std::move(map.points), landmarks, options);
    RETURN_IF_ERROR(homotopy.run(context));
    map.points = homotopy.points();
    map.steps = homotopy.steps();
    map.halvings = homotopy.halvings();
  }
  for (const Landmark& landmark : landmarks) map.distances.push_back(distance(landmark));
  measureBending(surface, points, map);
  map.quality = measureSphereMap(surface, lengths, map.points);
  return map;
}

}  // namespace moduli
