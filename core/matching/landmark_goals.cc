#include "core/matching/landmark_goals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/matching/border_places.h"
#include "core/matching/boundary_links.h"
#include "core/matching/path_search.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

/// On the way from where a landmark is to where it is to go.
class GoalFinder {
 public:
  GoalFinder(const Connectivity& surface, const CoverSurface& cover, const CoverMap& map)
      : surface_(surface),
        cover_(cover),
        plane_(cover.geometry),
        map_(map),
        search_(cover, cover.surface.vertexCount()) {
    search_.searchAll();
  }

  /// From points within b, half of the cover, ways stay there.
  void stayWithin(const Connectivity& b) {
    within_.emplace(cover_, b.vertexCount());
    within_->searchAll();
    faces_ = b.faceCount();
  }

  /// Where a point of A is, from the first corner of its face.
  CoverArrival arrival(const SurfacePoint& point) const {
    const std::array<Vector3d, 3> corners = cornersOf(surface_, map_, point.face);
    const Vector3d sum = point.barycentric[0] * corners[0] + point.barycentric[1] * corners[1] +
                         point.barycentric[2] * corners[2];
    const Index first = surface_.tail(3 * point.face);
    return walkStraight(cover_, map_.images[first].face, map_.places[first],
                        plane_.normalized(sum));
  }

  SurfacePoint pointAt(const CoverArrival& here) const {
    return cover_.pointAt(here.face, here.place);
  }

  /// From the coordinates of a point's face to those of an arrival's, by the shortest way.
  Motion shortest(const CoverArrival& here, const SurfacePoint& to) {
    PathSearch& search = within_ && here.face < faces_ ? *within_ : search_;
    search.start(pointAt(here));
    return search.find(to).value_or(Motion::Identity());
  }

  /// way: from the coordinates of the target's face to those of the arrival's.
  Vector3d goal(const CoverLandmark& landmark, const CoverArrival& here, const Motion& way) const {
    const Index first = surface_.tail(3 * landmark.point.face);
    const Motion frame = plane_.shift(plane_.wayTo(map_.places[first]));
    return plane_.normalized(
        Vector3d(plane_.inverse(frame) * here.motion * way * cover_.place(landmark.target)));
  }

 private:
  const Connectivity& surface_;
  const CoverSurface& cover_;
  const CoverPlane plane_;
  const CoverMap& map_;
  PathSearch search_;
  std::optional<PathSearch> within_;
  Index faces_ = 0;
};

/// A landmark on the boundary, where it is and where it is to go along one loop.
struct BorderGoal {
  std::size_t number = 0;
  CoverArrival arrival;
  BorderPoint here, there;
  double at = 0, to = 0;  ///< Shares of the loop.
  Index turns = 0;        ///< Added to the latter.
};

/// Chooses the turns of the landmarks of one loop.
void countTurns(std::vector<BorderGoal>& goals) {
  std::sort(goals.begin(), goals.end(), [](const BorderGoal& x, const BorderGoal& y) {
    return x.at != y.at ? x.at < y.at : x.number < y.number;
  });
  Index turns = 0;
  for (std::size_t i = 1; i < goals.size(); ++i) {
    if (goals[i].to < goals[i - 1].to) ++turns;
    goals[i].turns = turns;
  }
  const BorderGoal &first = goals.front(), &last = goals.back();
  if (last.turns + last.to > 1 + first.to) {
    // Not in order: each the shorter way.
    for (BorderGoal& goal : goals) goal.turns = static_cast<Index>(std::round(goal.at - goal.to));
    return;
  }
  double least = std::numeric_limits<double>::infinity();
  Index best = 0;
  for (const Index whole : {-2, -1, 0, 1, 2}) {
    double sum = 0;
    for (const BorderGoal& goal : goals) sum += std::abs(whole + goal.turns + goal.to - goal.at);
    if (!(sum < least)) continue;
    least = sum;
    best = whole;
  }
  for (BorderGoal& goal : goals) goal.turns += best;
}

class BorderGoals {
 public:
  BorderGoals(const TriangleMesh& b, const CoverSurface& cover)
      : b_(b.connectivity()), cover_(cover), places_(b) {}

  /// Fills in those of the boundary.
  void find(GoalFinder& finder, const Connectivity& surface,
            const std::vector<CoverLandmark>& landmarks, std::vector<Vector3d>& result) const {
    std::vector<std::vector<BorderGoal>> loops(places_.loops().size());
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      if (!borderPointAt(surface, landmarks[i].point)) continue;
      const CoverArrival arrival = finder.arrival(landmarks[i].point);
      const SurfacePoint here = foldedBack(finder.pointAt(arrival), b_.faceCount());
      const auto from = borderPointAt(b_, ontoBoundary(b_, here));
      const auto to = borderPointAt(b_, landmarks[i].target);
      // Of another loop, or of none: by the shortest way, if that can be met at all.
      if (!from || !to || places_.loopOf(from->halfedge) != places_.loopOf(to->halfedge)) continue;
      loops[places_.loopOf(to->halfedge)].push_back(
          {i, arrival, *from, *to, places_.shareAt(*from), places_.shareAt(*to)});
    }
    for (std::vector<BorderGoal>& goals : loops) {
      if (goals.empty()) continue;
      countTurns(goals);
      for (const BorderGoal& goal : goals) {
        const CoverLandmark landmark{{landmarks[goal.number].point}, goal.there.point()};
        const Motion way = finder.shortest(goal.arrival, goal.here.point()) * alongBorder(goal);
        result[goal.number] = finder.goal(landmark, goal.arrival, way);
      }
    }
  }

 private:
  /// From the coordinates of the face where it is to go to those of the one where it is.
  Motion alongBorder(const BorderGoal& goal) const {
    const CoverPlane plane = cover_.plane();
    const std::vector<Index>& loop = places_.loops()[places_.loopOf(goal.here.halfedge)];
    const auto count = static_cast<Index>(loop.size());
    const Index from = places_.numberOf(goal.here.halfedge);
    const Index steps = goal.turns * count + places_.numberOf(goal.there.halfedge) - from;
    Index at = steps < 0 ? goal.there.halfedge : goal.here.halfedge;
    Motion way = Motion::Identity();
    for (Index n = 0; n < std::abs(steps); ++n) {
      const BorderStep step = nextOnBorder(b_, cover_, at);
      way = plane.normalized(Motion(way * step.motion));
      at = step.halfedge;
    }
    return steps < 0 ? plane.inverse(way) : way;
  }

  const Connectivity& b_;
  const CoverSurface& cover_;
  BorderPlaces places_;
};

std::vector<Vector3d> goalsBy(GoalFinder& finder, const std::vector<CoverLandmark>& landmarks) {
  std::vector<Vector3d> goals;
  for (const CoverLandmark& landmark : landmarks) {
    const CoverArrival here = finder.arrival(landmark.point);
    goals.push_back(finder.goal(landmark, here, finder.shortest(here, landmark.target)));
  }
  return goals;
}

}  // namespace

std::vector<Vector3d> nearestGoals(const Connectivity& surface, const CoverSurface& cover,
                                   const CoverMap& map,
                                   const std::vector<CoverLandmark>& landmarks) {
  GoalFinder finder(surface, cover, map);
  return goalsBy(finder, landmarks);
}

std::vector<Vector3d> nearestGoals(const Connectivity& surface, const TriangleMesh& b,
                                   const CoverSurface& cover, const CoverMap& map,
                                   const std::vector<CoverLandmark>& landmarks) {
  GoalFinder finder(surface, cover, map);
  finder.stayWithin(b.connectivity());
  std::vector<Vector3d> goals = goalsBy(finder, landmarks);
  BorderGoals(b, cover).find(finder, surface, landmarks, goals);
  return goals;
}

}  // namespace moduli
