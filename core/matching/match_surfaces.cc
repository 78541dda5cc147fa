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
#include "core/matching/spectral_match.h"
#include "core/matching/split_surface.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// One of several triangulations that agree is right if the spectral match is this much nearer to
/// it than to any other.
constexpr double kClearlyNearer = 0.5;
/// A near isometry as good as this needs no other explanation,
constexpr double kGoodDefect = 0.03;
/// and is the better one unless the other's defect is this part of its own.
constexpr double kMobiusShare = 0.5;
/// Matches of at most so much more defect than the best are told of.
constexpr double kNearlyAsGood = 2;

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
    if (same.size() == 1) return takeTriangulation(same.front());
    ASSIGN_OR_RETURN(const SpectralGuess guess, bestGuess());
    result_.method = guess.method;
    result_.defect = guess.match.defect;
    const std::optional<std::size_t> nearest = clearlyNearest(same, guess.points);
    if (nearest) return takeTriangulation(same[*nearest]);
    RETURN_IF_ERROR(straighten(guess));
    return judged();
  }

 private:
  Result<SurfaceMatch> takeTriangulation(const std::vector<Index>& image) {
    result_.method = MatchMethod::kSameTriangulation;
    result_.defect.reset();
    result_.alternatives.clear();
    result_.inverse.resize(image.size());
    for (Index v = 0; v < a_.vertexCount(); ++v) {
      result_.images.push_back(vertexPoint(b_.connectivity(), image[v]));
      result_.inverse[image[v]] = vertexPoint(a_.connectivity(), v);
    }
    return judged();
  }

  /// From points that are nearly right to a map without folds.
  Status straighten(const SpectralGuess& guess) {
    if (a_.connectivity().eulerCharacteristic() == 2) {
      ASSIGN_OR_RETURN(SphereCorrespondence map, matchSpheres(context_, a_, b_, guess, options_));
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
    if (!computeTopology(a_.connectivity()).boundary_loops.empty()) {
      ASSIGN_OR_RETURN(BorderedCorrespondence map, matchBordered(context_, a_, b_, guess.points));
      result_.images = std::move(map.images);
      result_.inverse = std::move(map.inverse);
      return {};
    }
    ASSIGN_OR_RETURN(HandleCorrespondence map,
                     matchHandles(context_, a_, b_, guess.points, options_));
    result_.images = std::move(map.images);
    result_.inverse = std::move(map.inverse);
    measureLandmarks(map.landmarks, map.soft_landmarks);
    return {};
  }

  /// Of several numberings the one that the points mean.
  std::optional<std::size_t> clearlyNearest(const std::vector<std::vector<Index>>& numberings,
                                            const std::vector<SurfacePoint>& points) const {
    std::vector<std::pair<double, std::size_t>> distances;
    for (std::size_t i = 0; i < numberings.size(); ++i) {
      double sum = 0;
      for (std::size_t v = 0; v < points.size(); ++v) {
        sum += (spacePoint(b_.connectivity(), b_.positions(), points[v]) -
                b_.positions()[numberings[i][v]])
                   .norm();
      }
      distances.emplace_back(sum, i);
    }
    if (distances.size() < 2) return {};
    std::sort(distances.begin(), distances.end());
    if (!(distances[0].first < kClearlyNearer * distances[1].first)) return {};
    return distances[0].second;
  }

  using Pair = std::pair<SpectralSurface, SpectralSurface>;

  Result<Pair> spectralPair(MatchMetric metric) {
    std::optional<Result<SpectralSurface>> first, second;
    sideBySide(
        context_,
        [&](Context& context) { first.emplace(makeSpectralSurface(context, a_, metric)); },
        [&](Context& context) { second.emplace(makeSpectralSurface(context, b_, metric)); });
    RETURN_IF_ERROR(first->status());
    RETURN_IF_ERROR(second->status());
    return Pair(**std::move(first), **std::move(second));
  }

  Status prepare() {
    if (own_) return {};
    ASSIGN_OR_RETURN(Pair pair, spectralPair(MatchMetric::kOwn));
    own_.emplace(std::move(pair));
    return {};
  }

  /// The best match by either metric; tells of the others.
  Result<SpectralGuess> bestGuess() {
    std::vector<MatchAlternative> all;
    std::vector<SpectralGuess> guesses;
    RETURN_IF_ERROR(addGuess(MatchMethod::kNearIsometry, guesses, all));
    if (guesses.empty() || guesses.front().match.defect > kGoodDefect) {
      RETURN_IF_ERROR(addGuess(MatchMethod::kMobius, guesses, all));
    }
    if (guesses.empty()) {
      return Status(Reason::kNoConvergence,
                    "no correspondence of the surfaces was found that keeps orientation",
                    "--mirror looks for one that turns it over; --landmarks tells points that "
                    "correspond");
    }
    const bool mobius = guesses.front().match.defect * kMobiusShare > guesses.back().match.defect;
    SpectralGuess& best = mobius ? guesses.back() : guesses.front();
    listOthers(std::move(all), best);
    return std::move(best);
  }

  /// The matches that are nearly as good as the chosen one, or better.
  void listOthers(std::vector<MatchAlternative> all, const SpectralGuess& chosen) {
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& x, const auto& y) { return x.defect < y.defect; });
    bool met = false;
    for (const MatchAlternative& other : all) {
      const bool same = other.method == chosen.method && other.defect == chosen.match.defect;
      if (same && !std::exchange(met, true)) continue;
      if (other.defect < kNearlyAsGood * chosen.match.defect) result_.alternatives.push_back(other);
    }
  }

  /// Adds the best match by one metric, if there is any.
  Status addGuess(MatchMethod method, std::vector<SpectralGuess>& guesses,
                  std::vector<MatchAlternative>& all) {
    std::optional<Pair> other;
    if (method == MatchMethod::kMobius) {
      ASSIGN_OR_RETURN(Pair pair, spectralPair(MatchMetric::kMobius));
      other.emplace(std::move(pair));
    } else {
      RETURN_IF_ERROR(prepare());
    }
    const auto& [x, y] = other ? *other : *own_;
    ASSIGN_OR_RETURN(const std::vector<SpectralMatch> matches, matchSpectra(context_, x, y));
    for (const SpectralMatch& match : matches) all.push_back({method, match.defect});
    if (matches.empty()) return {};
    SpectralGuess& guess = guesses.emplace_back();
    guess.method = method;
    guess.match = matches.front();
    guess.samples = x.coarse.vertices;
    ASSIGN_OR_RETURN(guess.points, correspondingPoints(context_, x, y, guess.match.functional));
    return {};
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
    return std::move(result_);
  }

  Context& context_;
  const TriangleMesh& a_;
  const TriangleMesh& b_;
  const MatchOptions& options_;
  std::optional<std::pair<MapReport, double>> measured_;  ///< Of parts of faces.
  std::optional<Pair> own_;                               ///< By their own metrics.
  SurfaceMatch result_;
};

/// Of surfaces with boundary other than disks: without edges that cut across them, which straight
/// boundaries would lay flat.
Result<SurfaceMatch> matchWithoutChords(Context& context, const TriangleMesh& a,
                                        const TriangleMesh& b, const MatchOptions& options) {
  ASSIGN_OR_RETURN(const SplitSurface free_a, SplitSurface::make(a));
  ASSIGN_OR_RETURN(const SplitSurface free_b, SplitSurface::make(b));
  MatchOptions there = options;
  for (MatchLandmark& landmark : there.landmarks) {
    landmark.a = free_a.after(landmark.a);
    landmark.b = free_b.after(landmark.b);
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
  RETURN_IF_ERROR(
      checkTopologies(computeTopology(a.connectivity()), computeTopology(b.connectivity())));
  const bool is_closed = computeTopology(a.connectivity()).boundary_loops.empty();
  const bool is_disk = isDisk(a.connectivity());
  if (!is_closed && ((!is_disk && !options.landmarks.empty()) || !options.soft_landmarks.empty())) {
    return Status(Reason::kUnsupportedTopology,
                  is_disk
                      ? "soft landmarks of disks are not available"
                      : "landmarks of surfaces with boundary other than disks are not available",
                  "match without them, or close the holes with --fill-holes");
  }
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
