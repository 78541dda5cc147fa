#include "core/matching/match_disks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/side_by_side.h"
#include "core/intrinsic/edge_graph.h"
#include "core/matching/border_landmarks.h"
#include "core/matching/capped_disk.h"
#include "core/matching/disk_alignment.h"
#include "core/matching/disk_rim.h"
#include "core/matching/hemisphere_flow.h"
#include "core/matching/homeomorphism.h"
#include "core/matching/landmark_meeting.h"
#include "core/matching/rim_targets.h"
#include "core/matching/split_surface.h"
#include "core/spherical/robust_disk.h"

namespace moduli {
namespace {

/// Beside the mean squared distance of the samples: keeps the Möbius map from squeezing where they
/// do not tell. As small as that, for what is on limbs near the boundary is squeezed into tiny
/// parts of the half sphere, and missed by a little more.
constexpr double kRotationPreference = 1e-5;
/// A conformal map is taken as it is where it is no farther from the guess than the guess itself is
/// off, as a share of the root of the area;
constexpr double kGuessError = 0.005;
/// else, and to meet landmarks, it is drawn there, with little regard to lengths.
constexpr double kConformalSmoothing = 0.03;

/// A disk made ready: split, closed and mapped.
struct Disk {
  SplitSurface split;
  TriangleMesh capped;
  Points3 points;  ///< Per vertex of `capped`.

  const Connectivity& surface() const { return capped.connectivity(); }
  Index pole() const { return capped.vertexCount() - 1; }
};

Result<Disk> conformalDisk(Context& context, const TriangleMesh& mesh,
                           const std::vector<SurfacePoint>& marks, bool initial_delaunay) {
  ASSIGN_OR_RETURN(SplitSurface split, SplitSurface::make(mesh, marks));
  ASSIGN_OR_RETURN(TriangleMesh capped, cappedDisk(split.mesh()));
  ASSIGN_OR_RETURN(Points3 points,
                   conformalHemisphere(context, split.mesh(), capped, initial_delaunay));
  return Disk{std::move(split), std::move(capped), std::move(points)};
}

/// Points of B's boundary near points of B.
class RimFinder {
 public:
  RimFinder(const TriangleMesh& capped, const TriangleMesh& disk, const DiskRim& rim)
      : capped_(capped), rim_(rim) {
    std::vector<Index> vertices;
    for (Index i = 0; i < rim.size(); ++i) {
      vertices.push_back(capped.connectivity().tail(rim.halfedge(i)));
    }
    const EdgeGraph graph(disk.connectivity(), disk.edgeLengths());
    nearest_ = graph.farthestSamples(vertices, rim.size()).nearest;
  }

  /// How far along the boundary the point near `point` is.
  double placeNear(const SurfacePoint& point) const {
    const Connectivity& surface = capped_.connectivity();
    const auto heaviest = std::max_element(point.barycentric.begin(), point.barycentric.end());
    const Index v = surface.face(point.face)[heaviest - point.barycentric.begin()];
    const Eigen::Vector3d p = spacePoint(surface, capped_.positions(), point);
    const Index at = nearest_[v], before = at == 0 ? rim_.size() - 1 : at - 1;
    double least = std::numeric_limits<double>::infinity(), best = 0;
    for (const Index i : {before, at}) {
      const Index h = rim_.halfedge(i);
      const Eigen::Vector3d tail = capped_.positions()[surface.tail(h)];
      const Eigen::Vector3d side = capped_.positions()[surface.head(h)] - tail;
      const double square = side.squaredNorm();
      const double t = square > 0 ? std::clamp((p - tail).dot(side) / square, 0.0, 1.0) : 0;
      const double distance = (tail + t * side - p).norm();
      if (!(distance < least)) continue;
      least = distance;
      best = rim_.begin(i) + t * side.norm();
    }
    return best;
  }

 private:
  const TriangleMesh& capped_;
  const DiskRim& rim_;
  std::vector<Index> nearest_;
};

class DiskMatching {
 public:
  DiskMatching(Context& context, const TriangleMesh& a, const TriangleMesh& b,
               const SpectralGuess& guess, const MatchOptions& options)
      : context_(context), a_(a), b_(b), guess_(guess), options_(options) {}

  Result<SphereCorrespondence> run() {
    RETURN_IF_ERROR(prepare());
    ASSIGN_OR_RETURN(const SphereLocator locator, SphereLocator::make(to_->surface(), to_->points));
    ASSIGN_OR_RETURN(Points3 points, align());
    const DiskRim rim(to_->surface(), to_->points, to_->capped.positions());
    const bool conformal = guess_.method != MatchMethod::kNearIsometry;
    std::vector<SurfacePoint> images = located(locator, rim, points);
    const bool good = conformal && distanceFromGuess(images) < kGuessError;
    const bool is_drawn = !options_.soft_landmarks.empty();
    if (good && options_.landmarks.empty()) {
      return is_drawn ? drawn(locator, rim, std::move(points)) : described(images, points);
    }
    HomeomorphismOptions fitting;
    if (conformal) fitting.smoothing = kConformalSmoothing;
    ASSIGN_OR_RETURN(
        Homeomorphism map,
        fit(locator, points, good ? targetsAt(images) : spectralTargets(rim), fitting));
    return is_drawn ? drawn(locator, rim, std::move(map.points))
                    : described(map.images, map.points);
  }

 private:
  Status prepare() {
    std::vector<MatchLandmark> all = options_.landmarks;
    all.insert(all.end(), options_.soft_landmarks.begin(), options_.soft_landmarks.end());
    RETURN_IF_ERROR(checkBorderSides(a_.connectivity(), b_.connectivity(), all));
    RETURN_IF_ERROR(checkDistinct(a_, b_, all));
    RETURN_IF_ERROR(checkBorderOrder(BorderPlaces(a_), BorderPlaces(b_), a_.connectivity(),
                                     b_.connectivity(), options_.landmarks));
    std::vector<SurfacePoint> marks;
    for (const MatchLandmark& landmark : options_.landmarks) marks.push_back(landmark.a);
    std::optional<Result<Disk>> first, second;
    const bool delaunay = options_.initial_delaunay;
    sideBySide(
        context_,
        [&](Context& context) { first.emplace(conformalDisk(context, a_, marks, delaunay)); },
        [&](Context& context) { second.emplace(conformalDisk(context, b_, {}, delaunay)); });
    RETURN_IF_ERROR(first->status());
    RETURN_IF_ERROR(second->status());
    from_.emplace(**std::move(first));
    to_.emplace(**std::move(second));
    return {};
  }

  /// Of A as it is split.
  bool isRim(Index v) const { return from_->split.mesh().connectivity().isBoundaryVertex(v); }

  /// A's half of the sphere moved onto B's.
  Result<Points3> align() {
    std::vector<DiskPair> pairs;
    for (const Index v : guess_.samples) {
      const SurfacePoint there = to_->split.after(guess_.points[v]);
      pairs.push_back({sphereToDisk(from_->points[v]),
                       sphereToDisk(spherePoint(to_->surface(), to_->points, there))});
    }
    ASSIGN_OR_RETURN(const MobiusMap best, alignDisks(pairs, kRotationPreference));
    Points3 points;
    for (Index v = 0; v < from_->pole(); ++v) {
      points.push_back(diskToSphere(best(sphereToDisk(from_->points[v]))));
    }
    points.emplace_back(0, 0, -1);
    return unfoldHemisphere(context_, from_->capped, std::move(points));
  }

  /// Inside as the guess has them; along the boundary in order.
  std::vector<VertexTarget> spectralTargets(const DiskRim& rim) const {
    std::vector<VertexTarget> targets;
    for (Index v = 0; v < a_.vertexCount(); ++v) {
      if (!isRim(v)) targets.push_back({v, to_->split.after(guess_.points[v]), 1});
    }
    const RimFinder finder(to_->capped, to_->split.mesh(), rim);
    const DiskRim own(from_->surface(), from_->points, from_->capped.positions());
    std::vector<Index> vertices;
    std::vector<double> begin, there;
    for (Index i = 0; i < own.size(); ++i) {
      const Index v = from_->surface().tail(own.halfedge(i));
      if (v >= a_.vertexCount()) continue;  // A landmark on an edge.
      vertices.push_back(v);
      begin.push_back(own.begin(i) / own.length());
      there.push_back(finder.placeNear(to_->split.after(guess_.points[v])) / rim.length());
    }
    const std::vector<double> ordered = orderedAroundCircle(begin, there);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      targets.push_back({vertices[i], rim.atPlace(ordered[i] * rim.length()), 1});
    }
    return targets;
  }

  static std::vector<VertexTarget> targetsAt(const std::vector<SurfacePoint>& images) {
    std::vector<VertexTarget> targets;
    for (const SurfacePoint& image : images) {
      targets.push_back({static_cast<Index>(targets.size()), image, 1});
    }
    return targets;
  }

  /// Mean over A's vertices, over the root of B's area.
  double distanceFromGuess(const std::vector<SurfacePoint>& images) const {
    const TriangleMesh& parts = to_->split.mesh();
    double sum = 0;
    for (Index v = 0; v < a_.vertexCount(); ++v) {
      sum += (spacePoint(parts.connectivity(), parts.positions(), images[v]) -
              spacePoint(b_.connectivity(), b_.positions(), guess_.points[v]))
                 .norm();
    }
    return sum / a_.vertexCount() / std::sqrt(b_.area());
  }

  /// With the landmarks that are met.
  Result<Homeomorphism> fit(const SphereLocator& locator, const Points3& start,
                            std::vector<VertexTarget> targets,
                            const HomeomorphismOptions& fitting) const {
    std::vector<ExactVertex> exact;
    for (std::size_t i = 0; i < options_.landmarks.size(); ++i) {
      const Index v = from_->split.vertices()[i];
      const MatchLandmark& landmark = options_.landmarks[i];
      std::erase_if(targets, [v](const VertexTarget& target) { return target.vertex == v; });
      targets.push_back({v, to_->split.after(landmark.b), 1});
      exact.push_back({v, landmark.name});
    }
    return fitHomeomorphism(
        context_, {from_->surface(), from_->capped.positions(), start, from_->pole(), exact},
        {locator, to_->capped.positions(), to_->pole()}, targets, fitting);
  }

  /// On the boundary to the last bit, if there.
  HemisphereMark markOf(const MatchLandmark& landmark) const {
    const auto here = borderPointAt(a_.connectivity(), landmark.a);
    const auto there = borderPointAt(b_.connectivity(), landmark.b);
    const SurfacePoint to = to_->split.after(there ? there->point() : landmark.b);
    return {from_->split.after(here ? here->point() : landmark.a),
            spherePoint(to_->surface(), to_->points, to)};
  }

  /// Soft landmarks taken to their places as far as no face folds, and what came of that evened
  /// out.
  Result<SphereCorrespondence> drawn(const SphereLocator& locator, const DiskRim& rim,
                                     Points3 points) const {
    std::vector<HemisphereMark> marks;
    for (const auto* landmarks : {&options_.landmarks, &options_.soft_landmarks}) {
      for (const MatchLandmark& landmark : *landmarks) marks.push_back(markOf(landmark));
    }
    ASSIGN_OR_RETURN(HemisphereFlow flow,
                     flowOnHemisphere(context_, from_->surface(), std::move(points), marks));
    points = std::move(flow.points);
    const std::vector<SurfacePoint> images = located(locator, rim, points);
    const bool conformal = guess_.method != MatchMethod::kNearIsometry;
    if (conformal && options_.landmarks.empty()) return described(images, points);
    HomeomorphismOptions fitting;
    fitting.smoothing = kSoftSmoothing;
    ASSIGN_OR_RETURN(const Homeomorphism map, fit(locator, points, targetsAt(images), fitting));
    return described(map.images, map.points);
  }

  /// Where the vertices are on B.
  std::vector<SurfacePoint> located(const SphereLocator& locator, const DiskRim& rim,
                                    const Points3& points) const {
    std::vector<SurfacePoint> images;
    for (Index v = 0; v < from_->pole(); ++v) {
      images.push_back(isRim(v) ? rim.at(points[v]) : locator.locate(points[v]));
    }
    return images;
  }

  /// images: per vertex of A as it is split. points: the same on B's sphere, and the pole.
  Result<SphereCorrespondence> described(const std::vector<SurfacePoint>& images,
                                         const Points3& points) const {
    const Context::Stage stage(context_, "locate");
    SphereCorrespondence result;
    std::vector<Eigen::Vector3d> places;
    for (Index v = 0; v < from_->pole(); ++v) {
      const SurfacePoint image = to_->split.before(images[v]);
      places.push_back(spacePoint(b_.connectivity(), b_.positions(), image));
      if (v < a_.vertexCount()) result.images.push_back(image);
    }
    for (std::size_t i = 0; i < options_.landmarks.size(); ++i) {
      result.landmarks.push_back(to_->split.before(images[from_->split.vertices()[i]]));
    }
    ASSIGN_OR_RETURN(result.soft_landmarks, softImages(points));
    const TriangleMesh& parts = from_->split.mesh();
    result.report = measureSpaceMap(parts.connectivity(), parts.positions(), places);
    result.distance = isometricDistortion(parts.connectivity(), parts.positions(), places);
    ASSIGN_OR_RETURN(const SphereLocator back, SphereLocator::make(from_->surface(), points));
    const DiskRim rim(from_->surface(), points, from_->capped.positions());
    for (Index w = 0; w < b_.vertexCount(); ++w) {
      if (w % 10000 == 0) RETURN_IF_ERROR(context_.check());
      const Eigen::Vector3d& there = to_->points[w];
      const bool on_rim = b_.connectivity().isBoundaryVertex(w);
      result.inverse.push_back(from_->split.before(on_rim ? rim.at(there) : back.locate(there)));
    }
    return result;
  }

  Result<std::vector<SurfacePoint>> softImages(const Points3& points) const {
    std::vector<SurfacePoint> images;
    if (options_.soft_landmarks.empty()) return images;
    ASSIGN_OR_RETURN(const SphereLocator locator, SphereLocator::make(to_->surface(), to_->points));
    const DiskRim rim(to_->surface(), to_->points, to_->capped.positions());
    for (const MatchLandmark& landmark : options_.soft_landmarks) {
      const Eigen::Vector3d there =
          spherePoint(from_->surface(), points, from_->split.after(landmark.a));
      const bool on_rim = borderPointAt(a_.connectivity(), landmark.a).has_value();
      images.push_back(to_->split.before(on_rim ? rim.at(there) : locator.locate(there)));
    }
    return images;
  }

  Context& context_;
  const TriangleMesh& a_;
  const TriangleMesh& b_;
  const SpectralGuess& guess_;
  const MatchOptions& options_;
  std::optional<Disk> from_, to_;
};

}  // namespace

Result<SphereCorrespondence> matchDisks(Context& context, const TriangleMesh& a,
                                        const TriangleMesh& b, const SpectralGuess& guess,
                                        const MatchOptions& options) {
  return DiskMatching(context, a, b, guess, options).run();
}

}  // namespace moduli
