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
#include "core/matching/space_mobius.h"
#include "core/matching/spectral_match.h"
#include "core/matching/split_surface.h"
#include "core/matching/torus_map.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// One of several triangulations that agree is right if the spectral match is this much nearer to
/// it than to any other.
constexpr double kClearlyNearer = 0.5;
/// A near isometry as good as this needs no other explanation,
constexpr double kGoodDefect = 0.03;
/// and is the better one unless the other's defect is this part of its own, or the distances left
/// by the best Möbius map of space.
constexpr double kMobiusShare = 0.5;
/// A Möbius map of space is one of the surfaces if it misses half of the points by less than this
/// share of the root of the area.
constexpr double kNearMobius = 0.03;
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
    if (same.size() == 1 && options_.alternative == 0) return takeTriangulation(same.front());
    ASSIGN_OR_RETURN(const SpectralGuess guess, wantedGuess());
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
    if (guess.method == MatchMethod::kMobius && isClosed()) {
      ASSIGN_OR_RETURN(const std::optional<TriangleMesh> image, mobiusImage(guess));
      if (image) {
        SpectralGuess isometry = guess;
        isometry.method = MatchMethod::kNearIsometry;
        return straighten(*image, isometry);
      }
    }
    return straighten(a_, guess);
  }

  /// a: or, of closed surfaces, what stands for it.
  Status straighten(const TriangleMesh& a, const SpectralGuess& guess) {
    if (a.connectivity().eulerCharacteristic() == 2) {
      ASSIGN_OR_RETURN(SphereCorrespondence map, matchSpheres(context_, a, b_, guess, options_));
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
      ASSIGN_OR_RETURN(BorderedCorrespondence map, matchBordered(context_, a_, b_, guess.points));
      result_.images = std::move(map.images);
      result_.inverse = std::move(map.inverse);
      return {};
    }
    ASSIGN_OR_RETURN(HandleCorrespondence map,
                     matchHandles(context_, a, b_, guess.points,
                                  guess.method == MatchMethod::kNearIsometry, options_));
    result_.images = std::move(map.images);
    result_.inverse = std::move(map.inverse);
    measureLandmarks(map.landmarks, map.soft_landmarks);
    return {};
  }

  bool isClosed() const { return computeTopology(a_.connectivity()).boundary_loops.empty(); }

  /// The Möbius map of space nearest to a guess, its median over the root of b's area.
  Result<SpaceMobiusFit> mobiusOf(const SpectralGuess& guess) const {
    std::vector<Eigen::Vector3d> points, targets;
    for (const Index v : guess.samples) {
      points.push_back(a_.positions()[v]);
      targets.push_back(spacePoint(b_.connectivity(), b_.positions(), guess.points[v]));
    }
    ASSIGN_OR_RETURN(SpaceMobiusFit fit, fitSpaceMobius(points, targets));
    fit.median /= std::sqrt(b_.area());
    return fit;
  }

  /// Whether the second guess is of surfaces that a Möbius map of space carries to each other. It
  /// has 10 numbers, and the guess some hundred points: they do not agree by accident.
  bool isMobius(const SpectralGuess& isometry, const SpectralGuess& mobius) const {
    if (mobius.match.defect < kMobiusShare * isometry.match.defect) return true;
    if (!isClosed()) return false;
    const Result<SpaceMobiusFit> fit = mobiusOf(mobius), other = mobiusOf(isometry);
    if (!fit.ok() || !(fit->median < kNearMobius)) return false;
    return !other.ok() || fit->median < kMobiusShare * other->median;
  }

  /// Where the Möbius map of space nearest to a guess takes a: what is left is a near isometry.
  /// Nothing where no such map is near.
  Result<std::optional<TriangleMesh>> mobiusImage(const SpectralGuess& guess) const {
    std::optional<TriangleMesh> none;
    const Result<SpaceMobiusFit> fit = mobiusOf(guess);
    if (!fit.ok() || !(fit->median < kNearMobius)) return none;
    TriangleSoup soup{a_.positions(), a_.connectivity().faces()};
    for (Eigen::Vector3d& p : soup.vertices) {
      p = fit->map(p);
      if (!p.allFinite()) return none;
    }
    ASSIGN_OR_RETURN(TriangleMesh image, TriangleMesh::fromSoup(std::move(soup)));
    return std::optional(std::move(image));
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

  /// The matches by one metric, best first, and what they look at.
  struct Answers {
    MatchMethod method = MatchMethod::kNearIsometry;
    Pair surfaces;
    std::vector<SpectralMatch> matches;
  };
  /// One of them.
  struct Answer {
    const Answers* by = nullptr;
    const SpectralMatch* match = nullptr;
  };

  Result<Answers> answersBy(MatchMethod method) {
    const bool mobius = method == MatchMethod::kMobius;
    ASSIGN_OR_RETURN(Pair pair, spectralPair(mobius ? MatchMetric::kMobius : MatchMetric::kOwn));
    ASSIGN_OR_RETURN(std::vector<SpectralMatch> matches,
                     matchSpectra(context_, pair.first, pair.second));
    return Answers{method, std::move(pair), std::move(matches)};
  }

  /// The match by either metric that is wanted; tells of the others.
  Result<SpectralGuess> wantedGuess() {
    ASSIGN_OR_RETURN(const Answers own, answersBy(MatchMethod::kNearIsometry));
    std::vector<const Answers*> all = {&own};
    std::optional<Result<Answers>> mobius;
    if (own.matches.empty() || own.matches.front().defect > kGoodDefect) {
      mobius.emplace(answersBy(MatchMethod::kMobius));
      RETURN_IF_ERROR(mobius->status());
      all.push_back(&**mobius);
    }
    std::vector<SpectralGuess> guesses;
    for (const Answers* answers : all) {
      if (answers->matches.empty()) continue;
      ASSIGN_OR_RETURN(SpectralGuess guess, guessOf({answers, &answers->matches.front()}));
      guesses.push_back(std::move(guess));
    }
    if (guesses.empty()) {
      return Status(Reason::kNoConvergence,
                    "no correspondence of the surfaces was found that keeps orientation",
                    "--mirror looks for one that turns it over; --landmarks tells points that "
                    "correspond");
    }
    const bool second = guesses.size() == 2 && isMobius(guesses.front(), guesses.back());
    SpectralGuess& best = second ? guesses.back() : guesses.front();
    const std::vector<Answer> ranked = ranking(all, best);
    const auto wanted = static_cast<std::size_t>(options_.alternative);
    if (wanted >= ranked.size()) {
      return Status(Reason::kInvalidOption,
                    "there is no answer " + std::to_string(options_.alternative) +
                        ": beside the best there are " + std::to_string(ranked.size() - 1),
                    "the best one's list of others tells them");
    }
    for (std::size_t i = 0; i < ranked.size(); ++i) {
      if (i != wanted) {
        result_.alternatives.push_back({ranked[i].by->method, ranked[i].match->defect});
      }
    }
    if (wanted == 0) return std::move(best);
    return guessOf(ranked[wanted]);
  }

  /// The best, and those that are nearly as good or better by their defects.
  static std::vector<Answer> ranking(const std::vector<const Answers*>& all,
                                     const SpectralGuess& best) {
    std::vector<Answer> ranked(1);
    for (const Answers* answers : all) {
      for (const SpectralMatch& match : answers->matches) {
        const Answer answer{answers, &match};
        if (answers->method == best.method && &match == &answers->matches.front()) {
          ranked.front() = answer;
        } else if (match.defect < kNearlyAsGood * best.match.defect) {
          ranked.push_back(answer);
        }
      }
    }
    std::stable_sort(ranked.begin() + 1, ranked.end(), [](const Answer& x, const Answer& y) {
      return x.match->defect < y.match->defect;
    });
    return ranked;
  }

  Result<SpectralGuess> guessOf(const Answer& answer) {
    const auto& [x, y] = answer.by->surfaces;
    SpectralGuess guess;
    guess.method = answer.by->method;
    guess.match = *answer.match;
    guess.samples = x.coarse.vertices;
    ASSIGN_OR_RETURN(guess.points, correspondingPoints(context_, x, y, guess.match.functional));
    return guess;
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
    if (isClosed() && a_.connectivity().eulerCharacteristic() == 0) {
      RETURN_IF_ERROR(measureTori());
    }
    return std::move(result_);
  }

  /// The extremal map of the class. Absent where a metric has no straight faces.
  Status measureTori() {
    std::optional<Result<CoverSurface>> first, second;
    sideBySide(
        context_,
        [&](Context& context) {
          first.emplace(straightCover(context, a_.connectivity(), a_.edgeLengths()));
        },
        [&](Context& context) {
          second.emplace(straightCover(context, b_.connectivity(), b_.edgeLengths()));
        });
    if (first->ok() && second->ok()) {
      const Result<TorusMap> map = affineTorusMap(context_, **first, **second, result_.images);
      if (map.ok()) result_.teichmuller_distance = map->distance;
    }
    return context_.check();
  }

  Context& context_;
  const TriangleMesh& a_;
  const TriangleMesh& b_;
  const MatchOptions& options_;
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
  if (options.alternative < 0) {
    return Status(Reason::kInvalidOption, "the number of an answer is negative");
  }
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
