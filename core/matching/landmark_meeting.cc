#include "core/matching/landmark_meeting.h"

#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/matching/boundary_links.h"
#include "core/matching/landmark_flow.h"

namespace moduli {
namespace {

/// Of the root of the area: nearer points are one.
constexpr double kOnePoint = 1e-9;
/// How often a map is evened out on the way to landmarks.
constexpr int kRounds = 4;
/// Of the length over which it is, for landmarks that are drawn but not met.
constexpr int kMostHalvings = 6;

using Landmarks = std::vector<MatchLandmark>;

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

class Meeting {
 public:
  Meeting(Context& context, const CoverMeeting& meeting)
      : context_(context), meeting_(meeting), is_closed_(isClosed(meeting.a.connectivity())) {}

  Result<HarmonicMatch> run(HarmonicMatch match) {
    if (!meeting_.soft.empty()) {
      std::vector<CoverLandmark> all = onCover(meeting_.exact);
      for (CoverLandmark& landmark : onCover(meeting_.soft)) all.push_back(std::move(landmark));
      ASSIGN_OR_RETURN(LandmarkFlow flow, flowTo(all, match.map, true));
      ASSIGN_OR_RETURN(match, drawnBack(std::move(flow.map)));
    }
    if (meeting_.exact.empty()) return match;
    const std::vector<CoverLandmark> exact = onCover(meeting_.exact);
    for (int round = 0;; ++round) {
      ASSIGN_OR_RETURN(LandmarkFlow flow, flowTo(exact, match.map));
      if (flow.met) {
        match.map = std::move(flow.map);
        return match;
      }
      if (round == kRounds) return notMet(exact, flow.around);
      ASSIGN_OR_RETURN(match, evenedOut(std::move(flow.map)));
    }
  }

 private:
  static bool isClosed(const Connectivity& surface) {
    for (Index e = 0; e < surface.edgeCount(); ++e) {
      if (surface.isBoundaryEdge(e)) return false;
    }
    return true;
  }

  static std::vector<CoverLandmark> onCover(const Landmarks& landmarks) {
    std::vector<CoverLandmark> result;
    for (const MatchLandmark& landmark : landmarks) {
      result.push_back({landmark.a, landmark.b, landmark.name});
    }
    return result;
  }

  const Connectivity& surface() const { return meeting_.a.connectivity(); }

  Result<LandmarkFlow> flowTo(const std::vector<CoverLandmark>& landmarks, const CoverMap& map,
                              bool partly = false) {
    if (is_closed_)
      return flowToLandmarks(context_, surface(), meeting_.cover, map, landmarks, partly);
    return flowToLandmarks(context_, surface(), meeting_.b, meeting_.cover, map, landmarks, partly);
  }

  /// Not over its own targets: what has been moved around landmarks is far from most, and would go
  /// back first.
  Result<HarmonicMatch> drawnBack(CoverMap map) {
    ASSIGN_OR_RETURN(const MollifiedLengths mollified,
                     mollify(surface(), meeting_.a.edgeLengths()));
    const std::vector<double> lengths = unitLengths(mollified.lengths);
    const std::vector<double> areas = vertexAreas(surface(), lengths);
    const double whole = std::accumulate(areas.begin(), areas.end(), 0.0);
    const std::vector<double> cotan = cotanWeights(surface(), lengths),
                              positive = positiveWeights(surface(), lengths);
    double smoothing = meeting_.soft_smoothing;
    for (int n = 0; n < kMostHalvings; ++n, smoothing /= 2) {
      HarmonicOptions options;
      for (const double area : areas) {
        options.pulls.push_back(area / whole / (smoothing * smoothing));
      }
      for (const std::vector<double>* weights : {&cotan, &positive}) {
        ASSIGN_OR_RETURN(std::optional<HarmonicMatch> match, attempt(map, *weights, options));
        if (!match) continue;
        match->smoothing = smoothing;
        return *std::move(match);
      }
    }
    HarmonicMatch same;
    same.map = std::move(map);
    return same;
  }

  /// Nothing where faces fold or the energy is no convex one.
  Result<std::optional<HarmonicMatch>> attempt(const CoverMap& map,
                                               const std::vector<double>& weights,
                                               HarmonicOptions options) {
    std::optional<HarmonicMatch> match;
    const CoverSurface& cover = meeting_.cover;
    VertexLinks links = linksOf(surface(), cover, map);
    if (!is_closed_) options.slides = boundaryDirections(surface(), cover.plane(), links);
    const Result<HarmonicMap> found =
        harmonicMap(context_, cover.geometry, surface(), weights, std::move(links), options);
    if (found.status().reason() == Reason::kNotPositiveDefinite ||
        found.status().reason() == Reason::kNoConvergence) {
      return match;
    }
    RETURN_IF_ERROR(found.status());
    if (found->folded_faces > 0) return match;
    CoverMap after = moved(surface(), cover, map, found->moves);
    if (countFolded(surface(), after) > 0) return match;
    match.emplace();
    match->map = std::move(after);
    match->energy_ratio = found->energy / area();
    match->iterations = found->iterations;
    return match;
  }

  double area() const { return is_closed_ ? meeting_.cover.area : meeting_.cover.area / 2; }

  Result<HarmonicMatch> evenedOut(CoverMap map) {
    const std::vector<double> lengths = meeting_.a.edgeLengths();
    const CoverSurface& cover = meeting_.cover;
    if (is_closed_) return evenOut(context_, surface(), lengths, cover, std::move(map));
    const VertexLinks links = linksOf(surface(), cover, map);
    TargetLinks start;
    start.replaced.assign(surface().vertexCount(), false);
    start.closure = closureResidual(surface(), links);
    start.area = area();
    start.degree = 1;
    start.slides = boundaryDirections(surface(), cover.plane(), links);
    start.map = std::move(map);
    return matchHarmonically(context_, surface(), lengths, cover, start);
  }

  Context& context_;
  const CoverMeeting& meeting_;
  bool is_closed_;
};

}  // namespace

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

Result<HarmonicMatch> meetOnCover(Context& context, const CoverMeeting& meeting,
                                  HarmonicMatch match) {
  return Meeting(context, meeting).run(std::move(match));
}

}  // namespace moduli
