#include "core/matching/homeomorphism.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/matching/refinement.h"
#include "core/matching/relaxation.h"
#include "core/matching/settling.h"
#include "core/matching/thinning.h"

namespace moduli {
namespace {

using Positions = std::vector<Eigen::Vector3d>;

Status checkOptions(const HomeomorphismOptions& options) {
  const bool good = options.smoothing > 0 && std::isfinite(options.smoothing) &&
                    options.last_smoothing > 0 && std::isfinite(options.last_smoothing) &&
                    options.outlier > 0 && std::isfinite(options.outlier) &&
                    options.coarse_vertices >= 4 && options.coarse_sweeps >= 0 &&
                    options.sweeps >= 0 && options.tolerance >= 0;
  if (good) return {};
  return {Reason::kInvalidOption,
          "a homeomorphism needs smoothings and an outlier distance above 0, at least 4 coarse "
          "vertices and no negative sweeps or tolerance"};
}

Status checkTargets(const Connectivity& a, const Connectivity& b,
                    const std::vector<VertexTarget>& targets) {
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const VertexTarget& target = targets[i];
    const std::string name = "target " + std::to_string(i);
    if (target.vertex < 0 || target.vertex >= a.vertexCount()) {
      return {Reason::kInvalidOption, name + " is of vertex " + std::to_string(target.vertex) +
                                          ", but there are " + std::to_string(a.vertexCount())};
    }
    if (!(target.weight >= 0) || !std::isfinite(target.weight)) {
      return {Reason::kInvalidOption, name + " has no weight >= 0"};
    }
    RETURN_IF_ERROR(checkSurfacePoint(b, target.point, name));
  }
  return {};
}

Status checkPoles(const SphericalSource& a, const SphericalTarget& b) {
  const bool disks =
      a.pole == a.surface.vertexCount() - 1 && b.pole == b.sphere.surface().vertexCount() - 1;
  if (disks || (a.pole == kNone && b.pole == kNone)) return {};
  return {Reason::kInvalidOption,
          "two disks have their poles for last vertices, two spheres have none"};
}

/// pole: its faces do not count.
double areaOf(const Connectivity& surface, const Positions& positions, Index pole) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.faces()) {
    if (pole != kNone && (a == pole || b == pole || c == pole)) continue;
    sum += (positions[b] - positions[a]).cross(positions[c] - positions[a]).norm() / 2;
  }
  return sum;
}

class Fitting {
 public:
  Fitting(Context& context, const SphericalSource& a, const SphericalTarget& b, RingMesh mesh,
          const HomeomorphismOptions& options)
      : context_(context),
        a_(a),
        b_(b),
        options_(options),
        mesh_(std::move(mesh)),
        positions_(a.positions),
        domain_(b.sphere, b.positions, std::sqrt(areaOf(b.sphere.surface(), b.positions, b.pole)),
                b.pole) {
    const double unit = std::sqrt(areaOf(a.surface, a.positions, a.pole));
    for (Eigen::Vector3d& p : positions_) p /= unit;
    attractions_.resize(positions_.size());
    for (const ExactVertex& exact : a.exact) mesh_.hold(exact.vertex);
  }

  Result<Homeomorphism> run(const std::vector<VertexTarget>& targets) {
    attract(targets);
    ASSIGN_OR_RETURN(std::vector<Attempt> attempts, tryAll());
    for (Attempt& attempt : attempts) {
      const Status status = finish(attempt.map);
      if (status.reason() == Reason::kFoldedMap) continue;
      RETURN_IF_ERROR(status);
      Result<Homeomorphism> found = describe(attempt, targets);
      if (found.status().reason() != Reason::kFoldedMap) return found;
    }
    // All vertices at once, from where the start has them: this folds nothing, but stays near it.
    Attempt last{Relaxation(mesh_, positions_, domain_, attractions_)};
    for (const Index v : last.map.present()) last.map.setImage(v, startOf(v));
    RETURN_IF_ERROR(finish(last.map));
    return describe(last, targets);
  }

  /// Whether the start covers the sphere once; its faces are positive.
  bool startCoversOnce() const {
    Relaxation map(mesh_, positions_, domain_, attractions_);
    for (const Index v : map.present())
      map.setImage(v, Image{{}, Eigen::Vector3d::Zero(), a_.start[v]});
    return coversOnce(map);
  }

 private:
  /// A map of a coarse mesh.
  struct Attempt {
    Relaxation map;
    bool at_targets = false;
    double excess = 0;
  };

  /// Weights have the mean 1, and none is heavier than a few.
  void attract(const std::vector<VertexTarget>& targets) {
    double sum = 0;
    for (const VertexTarget& target : targets) sum += target.weight;
    const double factor = sum > 0 ? static_cast<double>(targets.size()) / sum : 0;
    for (const VertexTarget& target : targets) {
      Image image = domain_.at(target.point);
      if (mesh_.isRim(target.vertex)) image = domain_.onRim(image.direction);
      attractions_[target.vertex] = {image.space, image,
                                     std::min(target.weight * factor, kHeaviest)};
    }
    likely_ = attractions_;
  }

  Image startOf(Index v) const {
    if (v == mesh_.pole()) return poleImage();
    return mesh_.isRim(v) ? domain_.onRim(a_.start[v]) : domain_.at(a_.start[v]);
  }

  Image poleImage() const { return domain_.at(vertexPoint(b_.sphere.surface(), b_.pole)); }

  /// Coarse maps of equally many vertices, best first.
  Result<std::vector<Attempt>> tryAll() {
    std::vector<Attempt> attempts;
    for (const bool at_targets : {true, false}) {
      RingMesh mesh = mesh_;
      for (Index size = kSizes * options_.coarse_vertices; size >= options_.coarse_vertices;
           size /= 2) {
        const Index before = mesh.vertexCount();
        RETURN_IF_ERROR(at_targets ? thinForTargets(mesh, size) : thinForStart(mesh, size));
        if (mesh.vertexCount() == before && size == options_.coarse_vertices) break;
        Attempt attempt{Relaxation(mesh, positions_, domain_, likely_), at_targets};
        ASSIGN_OR_RETURN(const bool begun,
                         at_targets ? beginAtTargets(attempt.map) : beginAtStart(attempt.map));
        if (begun) attempts.push_back(std::move(attempt));
      }
    }
    for (Attempt& attempt : attempts) {
      const double excess = attempt.map.excess(attempt.map.present());
      attempt.excess = excess < kNothing ? 0 : excess;
    }
    std::stable_sort(
        attempts.begin(), attempts.end(),
        [](const Attempt& one, const Attempt& other) { return one.excess < other.excess; });
    return attempts;
  }

  Status thinForStart(RingMesh& mesh, Index size) {
    const Points3& start = a_.start;
    const FaceRule rule = [&](Index a, Index b, Index c) {
      return spherical::orientationSign(start[a], start[b], start[c]) > 0;
    };
    return thinEvenly(context_, mesh, positions_, std::vector<char>(positions_.size(), 1), rule,
                      size);
  }

  /// Vertices without a target go first.
  Status thinForTargets(RingMesh& mesh, Index size) {
    const FaceRule any = [](Index, Index, Index) { return true; };
    std::vector<char> free;
    Index drawn = 0;
    for (const Attraction& to : attractions_) {
      free.push_back(to.weight > 0 ? 0 : 1);
      drawn += to.weight > 0 ? 1 : 0;
    }
    if (mesh.vertexCount() > drawn) {
      RETURN_IF_ERROR(thinEvenly(context_, mesh, positions_, free, any, drawn));
    }
    return thinEvenly(context_, mesh, positions_, std::vector<char>(positions_.size(), 1), any,
                      size);
  }

  /// The coarse mesh with its vertices as the start has them.
  Result<bool> beginAtStart(Relaxation& map) {
    for (const Index v : map.present()) {
      map.setImage(v, startOf(v));
      likely_[v] = attractions_[likelyTarget(v)];
    }
    return relaxCoarse(map);
  }

  /// The coarse mesh with its vertices at their targets and without those that fold it or have
  /// none, which are then put back. False where nothing is left.
  Result<bool> beginAtTargets(Relaxation& map) {
    const std::vector<Index> vertices = map.present();
    for (const Index v : vertices) {
      // Without a target: at the centre, where no face is positive.
      map.setImage(v, v == mesh_.pole() ? poleImage() : Image());
      if (!(attractions_[v].weight > 0)) continue;
      likely_[v] = attractions_[likelyTarget(v)];
      map.setImage(v, likely_[v].image);
    }
    if (!thinUntilTame(map)) return false;
    map.setPull(pull(), kFar);
    const auto count = static_cast<Index>(vertices.size());
    const Status status = restoreVertices(context_, map, count, coarseWork());
    if (status.reason() == Reason::kFoldedMap) return false;
    RETURN_IF_ERROR(status);
    return relaxCoarse(map);
  }

  /// With the attractions' scale from far down to what is asked for, and then up to the size at
  /// which attempts are compared. False where that fails.
  Result<bool> relaxCoarse(Relaxation& map) {
    const Context::Stage stage(context_, "coarse");
    const std::vector<Index> vertices = map.inSweepOrder();
    map.setPull(pull(), options_.outlier);
    for (const Index v : vertices) map.jump(v);
    for (double scale = std::max(kFar, options_.outlier);; scale /= 2) {
      scale = std::max(scale, options_.outlier);
      map.setPull(pull(), scale);
      RETURN_IF_ERROR(map.relaxAll(context_, vertices, options_.coarse_sweeps, options_.tolerance));
      RETURN_IF_ERROR(repairMap(context_, map, coarseWork()));
      if (scale == options_.outlier) break;
    }
    const Status status = refine(map, kSizes * options_.coarse_vertices);
    if (status.reason() == Reason::kFoldedMap) return false;
    RETURN_IF_ERROR(status);
    return true;
  }

  /// Up to all vertices, and then at rest.
  Status finish(Relaxation& map) {
    map.setAttractions(attractions_);
    map.setPull(pull(), options_.outlier);
    RETURN_IF_ERROR(refineToAll(map));
    if (a_.pole != kNone || !(options_.last_smoothing > options_.smoothing)) return {};
    RETURN_IF_ERROR(settle(context_, a_.surface, domain_, attractions_, map, settling()));
    return smoothCrumples(map);
  }

  Status refineToAll(Relaxation& map, double wildest = kWild) {
    const Context::Stage stage(context_, "refine");
    const Index all = a_.surface.vertexCount();
    if (map.mesh().vertexCount() < all) return refine(map, all, wildest);
    return map.relaxAll(context_, map.inSweepOrder(), options_.sweeps, options_.tolerance);
  }

  /// While faces are stuck: on coarse meshes of two sizes in turn, which have no room for what is
  /// crumpled, and from there again. Keeps what helps.
  Status smoothCrumples(Relaxation& map) {
    int failures = 0;
    for (int round = 0; round < kRounds && failures < 2 && !isAllTame(map, kOdd); ++round) {
      ASSIGN_OR_RETURN(std::optional<Relaxation> again,
                       onceMore(map, options_.coarse_vertices << (round % 2)));
      ++failures;
      if (!again) continue;
      const double before = map.excess(map.present()), after = again->excess(again->present());
      if (after < kLess * before) failures = 0;
      if (after < before) map = *std::move(again);
    }
    return {};
  }

  /// The map by way of a coarse mesh of its own vertices. Nothing where that fails.
  Result<std::optional<Relaxation>> onceMore(const Relaxation& map, Index size) {
    std::optional<Relaxation> none;
    Relaxation again(mesh_, positions_, domain_, attractions_);
    for (const Index v : again.present()) again.setImage(v, map.image(v));
    again.setPull(settling().pull, options_.outlier);
    const FaceRule positive = [&](Index i, Index j, Index k) {
      return SphereDomain::isPositive(again.image(i), again.image(j), again.image(k));
    };
    RETURN_IF_ERROR(thinEvenly(context_, again.mesh(), positions_,
                               std::vector<char>(positions_.size(), 1), positive, size));
    if (!thinUntilTame(again, kStuck)) return none;
    RETURN_IF_ERROR(
        again.relaxAll(context_, again.inSweepOrder(), options_.coarse_sweeps, options_.tolerance));
    const Status status = refineToAll(again, kStuck);
    if (status.reason() == Reason::kFoldedMap) return none;
    RETURN_IF_ERROR(status);
    RETURN_IF_ERROR(settle(context_, a_.surface, domain_, attractions_, again, settling()));
    return std::optional(std::move(again));
  }

  SettlingOptions settling() const {
    SettlingOptions result;
    result.pull = 4 / (options_.last_smoothing * options_.last_smoothing);
    result.scale = options_.outlier;
    return result;
  }

  /// Level by level, each with twice the vertices.
  Status refine(Relaxation& map, Index wanted, double wildest = kWild) {
    const Index most = std::min(wanted, a_.surface.vertexCount());
    while (map.mesh().vertexCount() < most) {
      const Index next = std::min(2 * map.mesh().vertexCount(), most);
      // The coarse mesh's work, while it is more than the finest one's.
      const double share = static_cast<double>(options_.coarse_vertices) / next;
      const RefinementOptions work{
          std::max(options_.sweeps, static_cast<int>(options_.coarse_sweeps * share)),
          options_.tolerance, wildest};
      RETURN_IF_ERROR(restoreVertices(context_, map, next, work));
      RETURN_IF_ERROR(repairMap(context_, map, work));
    }
    return {};
  }

  RefinementOptions coarseWork() const {
    return {options_.coarse_sweeps, options_.tolerance, kWild};
  }

  double pull() const { return 4 / (options_.smoothing * options_.smoothing); }

  /// The vertex near v whose target is in the middle of those of all near v; v itself where its own
  /// target is about as far from that one as v is from the vertex.
  Index likelyTarget(Index v) const {
    if (mesh_.isHeld(v)) return v;
    const std::size_t count =
        std::clamp<std::size_t>(positions_.size() / options_.coarse_vertices, 7, 20);
    std::vector<Index> near = {v};
    // Ring by whole ring, whatever the numbering.
    for (std::size_t begin = 0; near.size() < count && begin < near.size();) {
      const std::size_t end = near.size();
      for (; begin < end; ++begin) {
        for (const Index w : mesh_.ring(near[begin])) {
          // Not through a cap; vertices of the boundary by those of the boundary.
          if (w == mesh_.pole() || (mesh_.isRim(v) && !mesh_.isRim(w))) continue;
          if (std::find(near.begin(), near.end(), w) == near.end()) near.push_back(w);
        }
      }
    }
    double least = std::numeric_limits<double>::infinity();
    Index best = v;
    for (const Index w : near) {
      if (!(attractions_[w].weight > 0) || mesh_.isRim(w) != mesh_.isRim(v)) continue;
      double sum = 0;
      for (const Index other : near) {
        const Attraction& to = attractions_[other];
        sum += to.weight * std::min((to.place - attractions_[w].place).norm(), kFar);
      }
      if (sum < least) {
        least = sum;
        best = w;
      }
    }
    const double away = (attractions_[v].place - attractions_[best].place).norm();
    const bool fits =
        attractions_[v].weight > 0 && away <= kStretch * (positions_[v] - positions_[best]).norm();
    return fits ? v : best;
  }

  Result<Homeomorphism> describe(const Attempt& attempt,
                                 const std::vector<VertexTarget>& targets) const {
    const Relaxation& map = attempt.map;
    Homeomorphism result;
    result.began_at_targets = attempt.at_targets;
    const std::size_t count = positions_.size();
    Positions images;
    for (std::size_t v = 0; v < count; ++v) {
      const Image& image = map.image(static_cast<Index>(v));
      result.points.push_back(image.direction);
      result.images.push_back(image.point);
      images.push_back(spacePoint(b_.sphere.surface(), b_.positions, image.point));
    }
    ASSIGN_OR_RETURN(result.report, reportOn(images));
    RETURN_IF_ERROR(checkExact(result.points));
    for (const auto& [p, q, r] : a_.surface.faces()) {
      const Points3& at = result.points;
      if (spherical::orientationSign(at[p], at[q], at[r]) <= 0) ++result.report.folded_faces;
    }
    double sum = 0, weights = 0;
    for (const VertexTarget& target : targets) {
      const Eigen::Vector3d to = spacePoint(b_.sphere.surface(), b_.positions, target.point);
      sum += target.weight * (images[target.vertex] - to).norm();
      weights += target.weight;
    }
    result.mean_distance = weights > 0 ? sum / weights : 0;
    if (result.report.folded_faces == 0) return result;
    return Status(Reason::kFoldedMap,
                  std::to_string(result.report.folded_faces) + " faces of the map are folded");
  }

  /// Of the surface's own faces.
  Result<MapReport> reportOn(const Positions& images) const {
    if (a_.pole == kNone) return measureSpaceMap(a_.surface, a_.positions, images);
    std::vector<Triangle> own;
    for (const Triangle& face : a_.surface.faces()) {
      if (!mesh_.isCap(face[0], face[1], face[2])) own.push_back(face);
    }
    ASSIGN_OR_RETURN(const Connectivity disk, Connectivity::fromFaces(a_.pole, std::move(own)));
    return measureSpaceMap(disk, a_.positions, images);
  }

  Status checkExact(const Points3& points) const {
    for (const auto& [v, name] : a_.exact) {
      if (!(attractions_[v].weight > 0) || points[v] == attractions_[v].image.direction) continue;
      return {Reason::kFoldedMap,
              "no map without folds was found that takes " + name + " to its place"};
    }
    return {};
  }

  static constexpr Index kSizes = 2;   ///< Coarse meshes up to this many times the coarsest.
  static constexpr double kFar = 0.5;  ///< The pull's first scale: it reaches over the surface.
  /// A target may be this many times as far from one nearby as the vertices are from each other.
  static constexpr double kStretch = 2;
  /// A near isometry has no reason to have faces of more than twice an isometry's energy, stretched
  /// by 2.4: something is stuck;
  static constexpr double kOdd = 2;
  static constexpr double kStuck = 4;  ///< what has more is taken out first.
  static constexpr int kRounds = 6;
  static constexpr double kLess = 0.95;     ///< A round that lowers the excess less is a failure.
  static constexpr double kHeaviest = 10;   ///< Weight of a target, where the mean is 1.
  static constexpr double kNothing = 1e-9;  ///< Excess of an isometry, with its rounding.

  Context& context_;
  const SphericalSource& a_;
  const SphericalTarget& b_;
  const HomeomorphismOptions& options_;
  RingMesh mesh_;
  Positions positions_;
  const SphereDomain domain_;
  std::vector<Attraction> attractions_;
  std::vector<Attraction> likely_;
};

}  // namespace

Result<Homeomorphism> fitHomeomorphism(Context& context, const SphericalSource& a,
                                       const SphericalTarget& b,
                                       const std::vector<VertexTarget>& targets,
                                       const HomeomorphismOptions& options) {
  const auto count = static_cast<std::size_t>(a.surface.vertexCount());
  const auto count_b = static_cast<std::size_t>(b.sphere.surface().vertexCount());
  if (a.positions.size() != count || a.start.size() != count || b.positions.size() != count_b) {
    return Status(Reason::kInvalidOption,
                  "a homeomorphism needs positions of both surfaces and a "
                  "start, one point for every vertex");
  }
  RETURN_IF_ERROR(checkOptions(options));
  RETURN_IF_ERROR(checkPoles(a, b));
  RETURN_IF_ERROR(checkTargets(a.surface, b.sphere.surface(), targets));
  ASSIGN_OR_RETURN(RingMesh mesh, RingMesh::make(a.surface, a.pole));
  // The locator's own check: no face of the start is folded.
  if (auto start = SphereLocator::make(a.surface, a.start); !start.ok()) {
    return start.status().withContext("the start");
  }
  Fitting fitting(context, a, b, std::move(mesh), options);
  if (!fitting.startCoversOnce()) {
    return Status(Reason::kFoldedMap, "the start covers the sphere more than once");
  }
  return fitting.run(targets);
}

Result<std::vector<SurfacePoint>> invertHomeomorphism(Context& context, const Connectivity& a,
                                                      const Points3& map, const SphereLocator& b) {
  ASSIGN_OR_RETURN(const SphereLocator locator, SphereLocator::make(a, map));
  std::vector<SurfacePoint> places;
  places.reserve(b.points().size());
  for (const Eigen::Vector3d& direction : b.points()) {
    if (places.size() % 10000 == 0) RETURN_IF_ERROR(context.check());
    places.push_back(locator.locate(direction));
  }
  return places;
}

}  // namespace moduli
