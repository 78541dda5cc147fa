#include "core/matching/match_surfaces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/base/side_by_side.h"
#include "core/base/text.h"
#include "core/matching/match_bordered.h"
#include "core/matching/match_disks.h"
#include "core/matching/match_handles.h"
#include "core/matching/match_spheres.h"
#include "core/matching/same_triangulation.h"
#include "core/matching/shape_alignment.h"
#include "core/matching/space_mobius.h"
#include "core/matching/spectral_guess.h"
#include "core/matching/split_surface.h"
#include "core/matching/torus_map.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// One of several triangulations that agree is right if the spectral match is this much nearer to
/// it than to any other.
constexpr double kClearlyNearer = 0.5;
/// Modes of a greater defect tell places badly: their errors are about a quarter of it and more,
/// over the root of the area.
constexpr double kPoorDefect = 0.03;
/// Errors of places of shapes that lie on each other are about as long as the gap between them:
/// they are taken where that is less than this part of the defect,
constexpr double kShapeShare = 1.0 / 3;
/// and of vertices that have no greater gap than this.
constexpr double kNearShape = 0.03;
/// Of more vertices nearest points among all would take too long.
constexpr Index kMostAligned = 2 * kThinnedVertices;

std::string topologyText(const SurfaceTopology& topology) {
  const auto loops = topology.boundary_loops.size();
  return "genus " + std::to_string(topology.genus) +
         (loops == 0 ? ", closed"
                     : " with " + std::to_string(loops) +
                           (loops == 1 ? " boundary loop" : " boundary loops"));
}

/// What would make two surfaces alike.
std::string topologyHint(const SurfaceTopology& a, const SurfaceTopology& b) {
  if (a.boundary_loops.size() != b.boundary_loops.size()) {
    const bool first = a.boundary_loops.size() > b.boundary_loops.size();
    return std::string("--fill-holes closes holes of the ") + (first ? "first" : "second");
  }
  return std::string("the ") + (a.genus > b.genus ? "first" : "second") +
         " has more handles; cut them, or fill the tunnels";
}

Status checkTopologies(const SurfaceTopology& a, const SurfaceTopology& b) {
  if (a.genus != b.genus || a.boundary_loops.size() != b.boundary_loops.size()) {
    return {Reason::kUnsupportedTopology,
            "the surfaces are not of one topology: " + topologyText(a) + ", and " + topologyText(b),
            topologyHint(a, b)};
  }
  return {};
}

/// Of connected surfaces: 2 - 2 g - b is 1.
bool isDisk(const Connectivity& surface) {
  return surface.eulerCharacteristic() == 1;
}

/// Turned over: x with the other sign, and corners 1 and 2 of every face exchanged.
Result<TriangleMesh> mirrorImage(const TriangleMesh& mesh) {
  TriangleSoup soup{mesh.positions(), mesh.connectivity().faces()};
  for (Eigen::Vector3d& p : soup.vertices) p.x() = -p.x();
  for (Triangle& face : soup.faces) std::swap(face[1], face[2]);
  return TriangleMesh::fromSoup(std::move(soup));
}

void turnOver(SurfacePoint& point) {
  std::swap(point.barycentric[1], point.barycentric[2]);
}

class Matching {
 public:
  Matching(Context& context, const TriangleMesh& a, const TriangleMesh& b,
           const MatchOptions& options)
      : context_(context), a_(a), b_(b), options_(options) {}

  Result<SurfaceMatch> run() {
    std::vector<std::vector<Index>> same;
    if (options_.same_triangulation && options_.landmarks.empty() &&
        options_.soft_landmarks.empty()) {
      ASSIGN_OR_RETURN(same, sameTriangulations(context_, a_.connectivity(), b_.connectivity()));
    }
    if (same.size() == 1 && options_.alternative == 0) {
      setTriangulation(same.front());
      return judged();
    }
    ASSIGN_OR_RETURN(const MatchPair thinned, makeMatchPair(context_, a_, b_));
    Status status = correspond(thinned, same);
    if (!status.ok() && (thinned.thin_a || thinned.thin_b) && mayBeOtherwise(status)) {
      result_ = SurfaceMatch();
      status = correspond({a_, b_}, same);
    }
    RETURN_IF_ERROR(status);
    return judged();
  }

 private:
  /// What may have another outcome on all vertices, or from other points.
  static bool mayBeOtherwise(const Status& status) {
    return status.reason() == Reason::kFoldedMap || status.reason() == Reason::kNoConvergence;
  }

  /// By what two surfaces, or what stands for them, tell.
  Status correspond(const MatchPair& pair, const std::vector<std::vector<Index>>& same) {
    ASSIGN_OR_RETURN(SpectralAnswer answer, guessSpectrally(context_, pair, options_));
    SpectralGuess& guess = answer.guess;
    if (const auto nearest = clearlyNearest(same, guess)) {
      setTriangulation(same[*nearest]);
      return {};
    }
    result_.method = guess.method;
    result_.defect = guess.match.defect;
    result_.alternatives = std::move(answer.alternatives);
    RETURN_IF_ERROR(preferShape(pair, guess));
    return straighten(pair, guess);
  }

  /// Takes the points of shapes that lie on each other, where the modes tell little, but not
  /// anything else.
  Status preferShape(const MatchPair& pair, SpectralGuess& guess) {
    if (guess.method != MatchMethod::kNearIsometry || !(guess.match.defect > kPoorDefect) ||
        !isClosed() ||
        std::max(pair.coarseA().vertexCount(), pair.coarseB().vertexCount()) > kMostAligned) {
      return {};
    }
    std::vector<Eigen::Vector3d> targets;
    for (const Index i : guess.samples) {
      targets.push_back(spacePoint(b_.connectivity(), pair.b.positions(), guess.points[i]));
    }
    const double most = std::min(kNearShape, kShapeShare * guess.match.defect);
    ASSIGN_OR_RETURN(
        std::optional<ShapeAlignment> shape,
        alignShapes(context_, pair.coarseA(), pair.coarseB(), guess.samples, targets, most));
    if (!shape) return {};
    if (pair.thin_b) shape->points = onWhole(pair.b, *pair.thin_b, shape->points);
    std::vector<double> moves;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const SurfacePoint& point = shape->points[guess.samples[i]];
      const Eigen::Vector3d place = spacePoint(b_.connectivity(), b_.positions(), point);
      moves.push_back((place - targets[i]).norm() / std::sqrt(b_.area()));
    }
    // Farther away from where the modes are than these err, one of both is wrong: round shapes
    // slide along themselves, and nearly round ones have modes that are easily taken for each
    // other.
    const auto middle = moves.begin() + static_cast<std::ptrdiff_t>(moves.size() / 2);
    std::nth_element(moves.begin(), middle, moves.end());
    if (!(*middle < guess.match.defect)) {
      ASSIGN_OR_RETURN(const bool is_better, changesLess(context_, pair, shape->points,
                                                         guess.points, options_.initial_delaunay));
      if (!is_better) return {};
    }
    for (std::size_t i = 0; i < guess.points.size(); ++i) {
      if (shape->gaps[i] <= kNearShape) guess.points[i] = shape->points[i];
    }
    guess.by_shape = true;
    result_.method = MatchMethod::kShape;
    return {};
  }

  void setTriangulation(const std::vector<Index>& image) {
    result_.method = MatchMethod::kSameTriangulation;
    result_.inverse.resize(image.size());
    for (Index v = 0; v < a_.vertexCount(); ++v) {
      result_.images.push_back(vertexPoint(b_.connectivity(), image[v]));
      result_.inverse[image[v]] = vertexPoint(a_.connectivity(), v);
    }
  }

  /// From points that are nearly right to a map without folds.
  Status straighten(const MatchPair& pair, const SpectralGuess& guess) {
    if (guess.method == MatchMethod::kMobius && isClosed()) {
      const std::optional<SpaceMobius> map = mobiusNear(pair, guess);
      if (map) {
        ASSIGN_OR_RETURN(const TriangleMesh image, imageOf(a_, *map));
        MatchPair images{image, b_, pair.thin_a, pair.thin_b};
        if (images.thin_a) {
          ASSIGN_OR_RETURN(images.thin_a->mesh, imageOf(images.coarseA(), *map));
        }
        SpectralGuess isometry = guess;
        isometry.method = MatchMethod::kNearIsometry;
        const Status status = straightenNear(images, isometry);
        if (status.ok() || !mayBeOtherwise(status)) return status;
        // What Möbius maps keep is little where a surface is round or flat; lengths tell now.
        ASSIGN_OR_RETURN(isometry, guessFromPlaces(context_, images, isometry));
        return straightenNear(images, isometry);
      }
    }
    return straightenNear(pair, guess);
  }

  /// pair: or, of closed surfaces, what stands for it.
  Status straightenNear(const MatchPair& pair, const SpectralGuess& guess) {
    if (a_.connectivity().eulerCharacteristic() == 2) {
      ASSIGN_OR_RETURN(SphereCorrespondence map, matchSpheres(context_, pair, guess, options_));
      result_.images = std::move(map.images);
      result_.inverse = std::move(map.inverse);
      measureLandmarks(map.landmarks, map.soft_landmarks);
      return {};
    }
    if (isDisk(a_.connectivity())) {
      ASSIGN_OR_RETURN(SphereCorrespondence map, matchDisks(context_, a_, b_, guess, options_));
      result_.images = std::move(map.images);
      result_.inverse = std::move(map.inverse);
      measured_ = std::pair(*map.report, *map.distance);
      measureLandmarks(map.landmarks, map.soft_landmarks);
      return {};
    }
    if (!isClosed()) {
      ASSIGN_OR_RETURN(BorderedCorrespondence map,
                       matchBordered(context_, a_, b_, guess.points, {}, options_));
      result_.images = std::move(map.images);
      result_.inverse = std::move(map.inverse);
      measureLandmarks(map.landmarks, map.soft_landmarks);
      return {};
    }
    RETURN_IF_ERROR(makeCovers());
    ASSIGN_OR_RETURN(HandleCorrespondence map,
                     matchHandles(context_, pair, **cover_b_, guess, options_));
    result_.images = std::move(map.images);
    result_.inverse = std::move(map.inverse);
    measureLandmarks(map.landmarks, map.soft_landmarks);
    return {};
  }

  bool isClosed() const { return computeTopology(a_.connectivity()).boundary_loops.empty(); }

  /// The Möbius map of space nearest to a guess; nothing where none is near.
  std::optional<SpaceMobius> mobiusNear(const MatchPair& pair, const SpectralGuess& guess) const {
    const Result<SpaceMobiusFit> fit = mobiusOf(pair, guess);
    if (!fit.ok() || !(fit->median < kNearMobius)) return {};
    for (const Eigen::Vector3d& p : a_.positions()) {
      if (!fit->map(p).allFinite()) return {};
    }
    return fit->map;
  }

  /// Where a Möbius map of space takes a surface.
  static Result<TriangleMesh> imageOf(const TriangleMesh& mesh, const SpaceMobius& map) {
    TriangleSoup soup{mesh.positions(), mesh.connectivity().faces()};
    for (Eigen::Vector3d& p : soup.vertices) p = map(p);
    return TriangleMesh::fromSoup(std::move(soup));
  }

  /// Of several numberings the one that the points mean.
  std::optional<std::size_t> clearlyNearest(const std::vector<std::vector<Index>>& numberings,
                                            const SpectralGuess& guess) const {
    std::vector<std::pair<double, std::size_t>> distances;
    for (std::size_t i = 0; i < numberings.size(); ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < guess.points.size(); ++k) {
        sum += (spacePoint(b_.connectivity(), b_.positions(), guess.points[k]) -
                b_.positions()[numberings[i][guess.vertices[k]]])
                   .norm();
      }
      distances.emplace_back(sum, i);
    }
    if (distances.size() < 2) return {};
    std::sort(distances.begin(), distances.end());
    if (!(distances[0].first < kClearlyNearer * distances[1].first)) return {};
    return distances[0].second;
  }

  /// From where the map takes the landmarks.
  void measureLandmarks(const std::vector<SurfacePoint>& exact,
                        const std::vector<SurfacePoint>& soft) {
    const auto largest = [&](const std::vector<MatchLandmark>& landmarks,
                             const std::vector<SurfacePoint>& images) {
      double error = 0;
      for (std::size_t i = 0; i < landmarks.size(); ++i) {
        const auto there = spacePoint(b_.connectivity(), b_.positions(), images[i]);
        const auto wanted = spacePoint(b_.connectivity(), b_.positions(), landmarks[i].b);
        error = std::max(error, (there - wanted).norm());
      }
      return error / std::sqrt(b_.area());
    };
    if (!exact.empty()) result_.landmark_error = largest(options_.landmarks, exact);
    if (!soft.empty()) result_.soft_landmark_error = largest(options_.soft_landmarks, soft);
  }

  Result<SurfaceMatch> judged() {
    const Context::Stage stage(context_, "judge");
    std::vector<Eigen::Vector3d> places;
    for (const SurfacePoint& point : result_.images) {
      places.push_back(spacePoint(b_.connectivity(), b_.positions(), point));
    }
    if (measured_) {
      std::tie(result_.report, result_.distance) = *measured_;
    } else {
      result_.report = measureSpaceMap(a_.connectivity(), a_.positions(), places);
      result_.distance = isometricDistortion(a_.connectivity(), a_.positions(), places);
    }
    result_.cycle_error = cycleError(a_.connectivity(), a_.positions(), result_.images,
                                     b_.connectivity(), result_.inverse) /
                          std::sqrt(a_.area());
    if (isTorus()) RETURN_IF_ERROR(measureTori());
    return std::move(result_);
  }

  bool isTorus() const { return isClosed() && a_.connectivity().eulerCharacteristic() == 0; }

  /// Of b, and of tori of a, too, whose metric may have no straight faces.
  Status makeCovers() {
    if (cover_b_) return {};
    const auto make = [](Context& context, const TriangleMesh& mesh,
                         std::optional<Result<CoverSurface>>& cover) {
      cover.emplace(straightCover(context, mesh.connectivity(), mesh.edgeLengths()));
    };
    if (isTorus()) {
      sideBySide(
          context_, [&](Context& context) { make(context, a_, cover_a_); },
          [&](Context& context) { make(context, b_, cover_b_); });
    } else {
      make(context_, b_, cover_b_);
    }
    RETURN_IF_ERROR(context_.check());
    return cover_b_->status();
  }

  /// The extremal map of the class. Absent where a metric has no straight faces.
  Status measureTori() {
    if (makeCovers().ok() && cover_a_->ok()) {
      const Result<TorusMap> map = affineTorusMap(context_, **cover_a_, **cover_b_, result_.images);
      if (map.ok()) result_.teichmuller_distance = map->distance;
    }
    return context_.check();
  }

  Context& context_;
  const TriangleMesh& a_;
  const TriangleMesh& b_;
  const MatchOptions& options_;
  std::optional<Result<CoverSurface>> cover_a_, cover_b_;
  std::optional<std::pair<MapReport, double>> measured_;  ///< Of parts of faces.
  SurfaceMatch result_;
};

/// Of surfaces with boundary other than disks: without edges that cut across them, which straight
/// boundaries would lay flat.
Result<SurfaceMatch> matchWithoutChords(Context& context, const TriangleMesh& a,
                                        const TriangleMesh& b, const MatchOptions& options) {
  ASSIGN_OR_RETURN(const SplitSurface free_a, SplitSurface::make(a));
  ASSIGN_OR_RETURN(const SplitSurface free_b, SplitSurface::make(b));
  MatchOptions there = options;
  for (auto* landmarks : {&there.landmarks, &there.soft_landmarks}) {
    for (MatchLandmark& landmark : *landmarks) {
      landmark.a = free_a.after(landmark.a);
      landmark.b = free_b.after(landmark.b);
    }
  }
  ASSIGN_OR_RETURN(SurfaceMatch match,
                   Matching(context, free_a.mesh(), free_b.mesh(), there).run());
  match.images.resize(a.vertexCount());
  match.inverse.resize(b.vertexCount());
  for (SurfacePoint& point : match.images) point = free_b.before(point);
  for (SurfacePoint& point : match.inverse) point = free_a.before(point);
  return match;
}

Result<SurfaceMatch> matchOriented(Context& context, const TriangleMesh& a, const TriangleMesh& b,
                                   const MatchOptions& options) {
  if (isDisk(a.connectivity()) || computeTopology(a.connectivity()).boundary_loops.empty()) {
    return Matching(context, a, b, options).run();
  }
  return matchWithoutChords(context, a, b, options);
}

}  // namespace

Result<SurfaceMatch> matchSurfaces(Context& context, const TriangleMesh& a, const TriangleMesh& b,
                                   const MatchOptions& options) {
  if (options.alternative < 0) {
    return Status(Reason::kInvalidOption, "the number of an answer is negative");
  }
  RETURN_IF_ERROR(
      checkTopologies(computeTopology(a.connectivity()), computeTopology(b.connectivity())));
  for (const auto* landmarks : {&options.landmarks, &options.soft_landmarks}) {
    for (const MatchLandmark& landmark : *landmarks) {
      RETURN_IF_ERROR(checkSurfacePoint(a.connectivity(), landmark.a, landmark.name));
      RETURN_IF_ERROR(checkSurfacePoint(b.connectivity(), landmark.b, landmark.name));
    }
  }
  if (!options.mirror) return matchOriented(context, a, b, options);
  ASSIGN_OR_RETURN(const TriangleMesh mirrored, mirrorImage(b));
  MatchOptions turned = options;
  for (MatchLandmark& landmark : turned.landmarks) turnOver(landmark.b);
  for (MatchLandmark& landmark : turned.soft_landmarks) turnOver(landmark.b);
  ASSIGN_OR_RETURN(SurfaceMatch match, matchOriented(context, a, mirrored, turned));
  for (SurfacePoint& point : match.images) turnOver(point);
  return match;
}

}  // namespace moduli
