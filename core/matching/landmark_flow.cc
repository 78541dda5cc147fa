#include "core/matching/landmark_flow.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <unordered_map>
#include <utility>

#include "core/base/parallel.h"
#include "core/matching/border_places.h"
#include "core/matching/boundary_links.h"
#include "core/matching/equivariant_map.h"
#include "core/matching/flow_kernel.h"
#include "core/mesh/double_cover.h"

namespace moduli {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSameMotion = 1e-6;

/// What a landmark sees around it.
struct View {
  double reach = 0;
  /// Vertices within reach, with the motions from their frames to the landmark's.
  std::unordered_map<Index, Motion> motions;
};

/// A closed surface that moves, and the points of it that are to go somewhere.
struct FlowProblem {
  Connectivity surface;
  VertexLinks links;
  std::vector<Index> mirror = {};     ///< Per vertex of a double its image; else empty.
  std::vector<SurfacePoint> points;   ///< Of the first copy.
  std::vector<Vector3d> goals;        ///< In the frames of the first corners of the points' faces.
  std::vector<Index> halfedges = {};  ///< Per point of a boundary one along it; kNone elsewhere.
};

class Flow {
 public:
  Flow(Context& context, Geometry geometry, FlowProblem problem)
      : context_(context),
        surface_(std::move(problem.surface)),
        mirror_(std::move(problem.mirror)),
        plane_(geometry),
        points_(std::move(problem.points)),
        halfedges_(std::move(problem.halfedges)),
        links_(std::move(problem.links)),
        moves_(surface_.vertexCount(), Motion::Identity()),
        goals_(std::move(problem.goals)),
        rests_(points_.size(), false) {
    halfedges_.resize(points_.size(), kNone);
  }

  /// All but the map. partly: a landmark beside a fold stays where it is, and the others go on.
  Result<LandmarkFlow> run(bool partly) {
    findTravels();
    ASSIGN_OR_RETURN(const FlowCourse course, runFlow(context_, *this, partly));
    LandmarkFlow result;
    result.met = course.met;
    result.steps = course.steps;
    if (!result.met) result.around = around_;
    std::sort(result.around.begin(), result.around.end());
    return result;
  }

  /// The one nearest to the last fold that has not come to rest; false where there is none.
  bool stayBehind() {
    if (around_.empty()) return false;
    rests_[around_.front()] = true;
    around_.clear();
    return true;
  }

  bool met() const {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (wayLeft(i).norm() > kFlowMet * edgeAt(i)) return false;
    }
    return true;
  }

  /// Goes on, with every landmark at most kFlowStep of its reach; false where that would fold a
  /// face.
  bool step(double share) {
    std::vector<View> views(points_.size());
    parallelBlocks(views.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) views[i] = lookAround(i);
    });
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double left = wayLeft(i).norm();
      if (share * left > kFlowStep * views[i].reach) share = kFlowStep * views[i].reach / left;
    }
    const std::vector<Vector2d> vectors = strengths(views, share);
    std::unordered_map<Index, Vector2d> ways;
    for (std::size_t i = 0; i < views.size(); ++i) {
      for (const auto& [v, motion] : views[i].motions) {
        const Vector2d way = carried(views[i], motion) * vectors[i];
        ways.try_emplace(v, Vector2d::Zero()).first->second += way;
        if (mirror_.empty()) continue;
        ways.try_emplace(mirror_[v], Vector2d::Zero()).first->second += mirrored(way);
      }
    }
    VertexLinks links = links_;
    std::vector<Motion> shifts(surface_.vertexCount(), Motion::Identity());
    for (const auto& [v, way] : ways) shifts[v] = plane_.shift(way);
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      const Index h = surface_.halfedge(e), i = surface_.tail(h), j = surface_.head(h);
      if (!ways.contains(i) && !ways.contains(j)) continue;
      links[h] = plane_.normalized(Motion(plane_.inverse(shifts[i]) * links[h] * shifts[j]));
      links[surface_.twin(h)] = plane_.inverse(links[h]);
    }
    if (const std::vector<bool> folded = foldedFaces(surface_, links);
        std::find(folded.begin(), folded.end(), true) != folded.end()) {
      blame(views, folded);
      return false;
    }
    links_ = std::move(links);
    for (const auto& [v, way] : ways) moves_[v] = plane_.normalized(Motion(moves_[v] * shifts[v]));
    for (std::size_t i = 0; i < goals_.size(); ++i) {
      const Index first = surface_.tail(firstHalfedge(i));
      goals_[i] = plane_.normalized(Vector3d(plane_.inverse(shifts[first]) * goals_[i]));
    }
    return true;
  }

  /// As HarmonicMap has them.
  const std::vector<Motion>& moves() const { return moves_; }

 private:
  Index firstHalfedge(std::size_t i) const { return 3 * points_[i].face; }

  /// The corners of a landmark's face in the frame of the first one.
  std::array<Motion, 3> corners(std::size_t i) const {
    const Index h = firstHalfedge(i);
    return {Motion::Identity(), links_[h], links_[surface_.twin(h + 2)]};
  }

  /// The landmark in the frame of its face's first corner.
  Vector3d placeOf(std::size_t i) const {
    const std::array<Motion, 3> at = corners(i);
    Vector3d sum = Vector3d::Zero();
    for (int c = 0; c < 3; ++c) sum += points_[i].barycentric[c] * at[c].col(2);
    return plane_.normalized(sum);
  }

  /// From the landmark's frame to that of its face's first corner.
  Motion frameOf(std::size_t i) const { return plane_.shift(plane_.wayTo(placeOf(i))); }

  /// What a landmark can do, in its frame: all, or go along the boundary.
  Matrix2d freedom(std::size_t i) const {
    const Index h = halfedges_[i];
    if (h == kNone) return Matrix2d::Identity();
    const std::array<Motion, 3> at = corners(i);
    const Motion back = plane_.inverse(frameOf(i));
    Vector2d along = Vector2d::Zero();
    for (const Index end : {h, Connectivity::next(h)}) {
      const Vector2d way = plane_.wayTo(Vector3d(back * at[end % 3].col(2)));
      if (way.norm() > along.norm()) along = way;
    }
    return along * along.transpose() / along.squaredNorm();
  }

  /// In the landmark's frame.
  Vector2d wayLeft(std::size_t i) const {
    if (rests_[i]) return Vector2d::Zero();
    return freedom(i) * plane_.wayTo(Vector3d(plane_.inverse(frameOf(i)) * goals_[i]));
  }

  double edgeAt(std::size_t i) const {
    double longest = 0;
    for (Index h = firstHalfedge(i); h < firstHalfedge(i) + 3; ++h) {
      longest = std::max(longest, plane_.wayTo(links_[h].col(2)).norm());
    }
    return longest;
  }

  void findTravels() {
    for (std::size_t i = 0; i < points_.size(); ++i) travel_.push_back(wayLeft(i).norm());
    spreadTravels(travel_, [this](std::size_t i) {
      const View view = lookAround(i);
      std::vector<double> shares(points_.size(), 0.0);
      for (std::size_t j = 0; j < points_.size(); ++j) {
        for (const Index v : surface_.face(points_[j].face)) {
          shares[j] = std::max(shares[j], shareAt(view, v));
          if (!mirror_.empty()) shares[j] = std::max(shares[j], shareAt(view, mirror_[v]));
        }
      }
      return shares;
    });
  }

  double shareAt(const View& view, Index v) const {
    const auto seen = view.motions.find(v);
    return seen == view.motions.end() ? 0 : flowKernel(distanceTo(seen->second) / view.reach);
  }

  struct Candidate {
    double distance = 0;
    Index vertex = kNone;
    Motion motion;
    bool operator<(const Candidate& other) const {
      return distance != other.distance ? distance > other.distance : vertex > other.vertex;
    }
  };

  double distanceTo(const Motion& motion) const { return plane_.wayTo(motion.col(2)).norm(); }

  /// Vertices nearest first. Where two ways to one differ, they lead around a handle: the reach
  /// ends before.
  View lookAround(std::size_t i) const {
    View view;
    view.reach = std::max(kFlowReach * travel_[i], kFlowEdges * edgeAt(i));
    const Motion back = plane_.inverse(frameOf(i));
    std::priority_queue<Candidate> queue;
    const std::array<Motion, 3> at = corners(i);
    for (int c = 0; c < 3; ++c) {
      const Motion motion = plane_.normalized(Motion(back * at[c]));
      queue.push({distanceTo(motion), surface_.tail(firstHalfedge(i) + c), motion});
    }
    while (!queue.empty() && queue.top().distance < view.reach) {
      const Candidate next = queue.top();
      queue.pop();
      const auto [known, is_new] = view.motions.try_emplace(next.vertex, next.motion);
      if (!is_new) {
        const Motion around = plane_.inverse(known->second) * next.motion;
        if (distanceToUnit(around) > kSameMotion * (1 + next.motion(2, 2))) {
          view.reach = std::max(distanceTo(known->second), kFlowEdges * edgeAt(i) / 2);
        }
        continue;
      }
      const Index first = surface_.outgoing(next.vertex);
      Index h = first;
      do {
        const Motion motion = plane_.normalized(Motion(next.motion * links_[h]));
        const auto other = view.motions.find(surface_.head(h));
        const bool same = other != view.motions.end() &&
                          distanceToUnit(plane_.inverse(other->second) * motion) < kSameMotion;
        if (!same) queue.push({distanceTo(motion), surface_.head(h), motion});
        h = surface_.rotate(h);
      } while (h != first);
    }
    return view;
  }

  /// What a motion of a landmark by a vector makes of a vertex: the vector, carried there and
  /// weakened.
  Matrix2d carried(const View& view, const Motion& motion) const {
    const Vector2d way = plane_.wayTo(motion.col(2));
    const Motion turn = plane_.inverse(plane_.shift(way)) * motion;
    return flowKernel(way.norm() / view.reach) * turn.topLeftCorner<2, 2>().transpose();
  }

  /// The same of all that goes with a landmark: of a double, its mirror image moves alike.
  Matrix2d carriedTo(const View& view, Index v) const {
    Matrix2d sum = Matrix2d::Zero();
    if (const auto seen = view.motions.find(v); seen != view.motions.end()) {
      sum += carried(view, seen->second);
    }
    if (mirror_.empty()) return sum;
    if (const auto seen = view.motions.find(mirror_[v]); seen != view.motions.end()) {
      sum += mirrored(carried(view, seen->second));
    }
    return sum;
  }

  template <typename Rows>
  static Rows mirrored(Rows rows) {
    rows.row(1) *= -1;
    return rows;
  }

  /// The vectors at the landmarks under which all of them go a share of their ways.
  std::vector<Vector2d> strengths(const std::vector<View>& views, double share) const {
    const auto count = static_cast<Eigen::Index>(views.size());
    std::vector<Matrix2d> freedoms;
    for (std::size_t i = 0; i < views.size(); ++i) freedoms.push_back(freedom(i));
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(2 * count, 2 * count);
    Eigen::VectorXd wanted(2 * count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto number = static_cast<std::size_t>(i);
      wanted.segment<2>(2 * i) = share * wayLeft(number);
      addRows(views, i, system);
      system.middleRows<2>(2 * i) = (freedoms[number] * system.middleRows<2>(2 * i)).eval();
      // What it cannot do stays undone.
      system.block<2, 2>(2 * i, 2 * i) += Matrix2d::Identity() - freedoms[number];
    }
    const Eigen::VectorXd found =
        Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(system).solve(wanted);
    std::vector<Vector2d> vectors;
    for (Eigen::Index i = 0; i < count; ++i) vectors.push_back(found.segment<2>(2 * i));
    return vectors;
  }

  /// How landmark i moves, to first order, with the vectors at all of them.
  void addRows(const std::vector<View>& views, Eigen::Index i, Eigen::MatrixXd& system) const {
    const auto number = static_cast<std::size_t>(i);
    const Motion back = plane_.inverse(frameOf(number));
    const std::array<Motion, 3> at = corners(number);
    double size = 0;  // Of the combination of the corners' vectors.
    for (int c = 0; c < 3; ++c) {
      size += points_[number].barycentric[c] * (back * at[c])(2, 2);
    }
    for (int c = 0; c < 3; ++c) {
      const double weight = points_[number].barycentric[c] / size;
      const Index v = surface_.tail(firstHalfedge(number) + c);
      const Matrix2d seen = (back * at[c]).topLeftCorner<2, 2>();
      for (Eigen::Index j = 0; j < system.cols() / 2; ++j) {
        system.block<2, 2>(2 * i, 2 * j) += weight * seen * carriedTo(views[j], v);
      }
    }
  }

  /// The two landmarks that are nearest to folded faces, of those that move them and go on.
  void blame(const std::vector<View>& views, const std::vector<bool>& folded) {
    std::vector<std::pair<double, std::size_t>> found;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (rests_[i]) continue;
      double nearest = std::numeric_limits<double>::infinity();
      for (Index f = 0; f < surface_.faceCount(); ++f) {
        if (!folded[f]) continue;
        for (const Index v : surface_.face(f)) {
          const auto motion = views[i].motions.find(v);
          if (motion == views[i].motions.end()) continue;
          nearest = std::min(nearest, distanceTo(motion->second) / views[i].reach);
        }
      }
      if (std::isfinite(nearest)) found.emplace_back(nearest, i);
    }
    std::sort(found.begin(), found.end());
    around_.clear();
    for (std::size_t i = 0; i < std::min<std::size_t>(2, found.size()); ++i) {
      around_.push_back(found[i].second);
    }
  }

  Context& context_;
  Connectivity surface_;
  std::vector<Index> mirror_;
  const CoverPlane plane_;
  std::vector<SurfacePoint> points_;
  std::vector<Index> halfedges_;
  VertexLinks links_;
  std::vector<Motion> moves_;
  std::vector<Vector3d> goals_;
  std::vector<bool> rests_;  ///< Per landmark: whether it has given up.
  std::vector<double> travel_;
  std::vector<std::size_t> around_;  ///< Landmarks near the last fold, nearest first.
};

std::vector<SurfacePoint> pointsOf(const std::vector<CoverLandmark>& landmarks) {
  std::vector<SurfacePoint> points;
  for (const CoverLandmark& landmark : landmarks) points.push_back(landmark.point);
  return points;
}

/// Follows a flow with a map.
void follow(const Connectivity& surface, const CoverSurface& cover, const CoverMap& map,
            const std::vector<Motion>& moves, LandmarkFlow& flow) {
  flow.map = moved(surface, cover, map, moves);
  if (countFolded(surface, flow.map) == 0) return;
  flow.met = false;
  flow.map = map;
}

/// A surface with boundary and its mirror image. Frames of the latter are mirrored along the first
/// axis, which at the boundary is its direction.
class Doubling {
 public:
  Doubling(const Connectivity& surface, const CoverPlane& plane, const VertexLinks& links)
      : surface_(surface), plane_(plane) {
    for (const Vector2d& along : boundaryDirections(surface, plane, links)) {
      turns_.push_back(along.isZero(0) ? Motion(Motion::Identity())
                                       : CoverPlane::turn(std::atan2(along[1], along[0])));
    }
  }

  /// From the frame of vertex v as it was given to the one along the boundary.
  Motion back(Index v) const { return turns_[v].transpose(); }

  VertexLinks links(const DoubleCover& doubled, const VertexLinks& links) const {
    VertexLinks result(doubled.connectivity.halfedgeCount());
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      result[h] = back(surface_.tail(h)) * links[h] * turns_[surface_.head(h)];
    }
    Motion mirror = Motion::Identity();
    mirror(1, 1) = -1;
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      const Index image = 3 * (h / 3 + doubled.face_count) + 2 - h % 3;  // The other way around.
      result[image] = mirror * plane_.inverse(result[h]) * mirror;
      if (surface_.twin(h) == kNone) result[image] = plane_.inverse(result[h]);
    }
    return result;
  }

  /// Of the first copy, in the frames as they were given.
  std::vector<Motion> moves(const std::vector<Motion>& moves) const {
    std::vector<Motion> result;
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      result.push_back(turns_[v] * moves[v] * back(v));
    }
    return result;
  }

 private:
  const Connectivity& surface_;
  CoverPlane plane_;
  std::vector<Motion> turns_;
};

}  // namespace

Result<LandmarkFlow> flowToLandmarks(Context& context, const Connectivity& surface,
                                     const CoverSurface& cover, const CoverMap& map,
                                     const std::vector<CoverLandmark>& landmarks, bool partly) {
  const Context::Stage stage(context, "landmarks");
  Flow flow(context, cover.geometry,
            {.surface = surface,
             .links = linksOf(surface, cover, map),
             .points = pointsOf(landmarks),
             .goals = nearestGoals(surface, cover, map, landmarks)});
  ASSIGN_OR_RETURN(LandmarkFlow result, flow.run(partly));
  follow(surface, cover, map, flow.moves(), result);
  return result;
}

Result<LandmarkFlow> flowToLandmarks(Context& context, const Connectivity& surface,
                                     const TriangleMesh& b, const CoverSurface& cover,
                                     const CoverMap& map,
                                     const std::vector<CoverLandmark>& landmarks, bool partly) {
  const Context::Stage stage(context, "landmarks");
  ASSIGN_OR_RETURN(DoubleCover doubled, doubleCover(surface));
  const VertexLinks links = linksOf(surface, cover, map);
  const Doubling doubling(surface, cover.plane(), links);
  std::vector<CoverLandmark> marks = landmarks;
  std::vector<Index> halfedges;
  for (CoverLandmark& mark : marks) {
    const auto at = borderPointAt(surface, mark.point);
    if (at) mark.point = at->point();
    halfedges.push_back(at ? at->halfedge : kNone);
  }
  FlowProblem problem{.surface = doubled.connectivity,
                      .links = doubling.links(doubled, links),
                      .mirror = std::move(doubled.involution),
                      .points = pointsOf(marks),
                      .goals = nearestGoals(surface, b, cover, map, marks),
                      .halfedges = std::move(halfedges)};
  for (std::size_t i = 0; i < marks.size(); ++i) {
    problem.goals[i] = doubling.back(surface.tail(3 * marks[i].point.face)) * problem.goals[i];
  }
  Flow flow(context, cover.geometry, std::move(problem));
  ASSIGN_OR_RETURN(LandmarkFlow result, flow.run(partly));
  follow(surface, cover, map, doubling.moves(flow.moves()), result);
  return result;
}

}  // namespace moduli
