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

#include "core/matching/equivariant_map.h"
#include "core/matching/path_search.h"

namespace moduli {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Of a kernel, in ways that its landmark has before it.
constexpr double kReach = 6;
/// And at least, in edges.
constexpr double kEdges = 3;
/// Of a kernel's reach: how far a landmark goes in one step.
constexpr double kStep = 0.1;
constexpr double kMet = 1e-7;
constexpr double kSameMotion = 1e-6;
constexpr int kMostSteps = 200, kMostHalvings = 12;

/// Smooth, 1 at 0 and 0 from 1 on.
double kernel(double x) {
  if (!(x < 1)) return 0;
  const double rest = (1 - x) * (1 - x);
  return rest * rest * (4 * x + 1);
}

/// What a landmark sees around it.
struct View {
  double reach = 0;
  /// Vertices within reach, with the motions from their frames to the landmark's.
  std::unordered_map<Index, Motion> motions;
};

class Flow {
 public:
  Flow(Context& context, const Connectivity& surface, const CoverSurface& cover,
       const CoverMap& map, const std::vector<CoverLandmark>& landmarks)
      : context_(context),
        surface_(surface),
        cover_(cover),
        plane_(cover.geometry),
        map_(map),
        landmarks_(landmarks),
        links_(linksOf(surface, cover, map)),
        moves_(surface.vertexCount(), Motion::Identity()) {}

  Result<LandmarkFlow> run() {
    const Context::Stage stage(context_, "landmarks");
    findGoals();
    LandmarkFlow result;
    for (std::size_t i = 0; i < landmarks_.size(); ++i) wayLeft(i, &travel_.emplace_back());
    double share = 1;  // Of what a step could be.
    int halvings = 0;
    while (!met()) {
      RETURN_IF_ERROR(context_.check());
      if (++result.steps > kMostSteps || halvings > kMostHalvings) {
        result.met = false;
        break;
      }
      if (step(share)) {
        share = std::min(1.0, 2 * share);
        halvings = std::max(0, halvings - 1);
      } else {
        share /= 2;
        ++halvings;
      }
    }
    result.around = result.met ? std::vector<std::size_t>() : around_;
    result.map = moved(surface_, cover_, map_, moves_);
    if (countFolded(surface_, result.map) > 0) {
      result.met = false;
      result.map = map_;
    }
    return result;
  }

 private:
  Index firstHalfedge(std::size_t i) const { return 3 * landmarks_[i].point.face; }

  /// The corners of a landmark's face in the frame of the first one.
  std::array<Motion, 3> corners(std::size_t i) const {
    const Index h = firstHalfedge(i);
    return {Motion::Identity(), links_[h], links_[surface_.twin(h + 2)]};
  }

  /// The landmark in the frame of its face's first corner.
  Vector3d placeOf(std::size_t i) const {
    const std::array<Motion, 3> at = corners(i);
    Vector3d sum = Vector3d::Zero();
    for (int c = 0; c < 3; ++c) sum += landmarks_[i].point.barycentric[c] * at[c].col(2);
    return plane_.normalized(sum);
  }

  /// From the landmark's frame to that of its face's first corner.
  Motion frameOf(std::size_t i) const { return plane_.shift(plane_.wayTo(placeOf(i))); }

  /// Targets as the first corners of the landmarks' faces see them, by the shortest ways.
  void findGoals() {
    PathSearch search(cover_, cover_.surface.vertexCount());
    search.searchAll();
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      const Index first = surface_.tail(firstHalfedge(i)), face = map_.images[first].face;
      const Motion frame = plane_.shift(plane_.wayTo(map_.places[first]));
      const CoverArrival here = walkStraight(cover_, face, map_.places[first],
                                             plane_.normalized(Vector3d(frame * placeOf(i))));
      search.start(cover_.pointAt(here.face, here.place));
      const Motion way = search.find(landmarks_[i].target).value_or(Motion::Identity());
      goals_.push_back(plane_.normalized(Vector3d(plane_.inverse(frame) * here.motion * way *
                                                  cover_.place(landmarks_[i].target))));
    }
  }

  /// In the landmark's frame; its length to `length`, where one is given.
  Vector2d wayLeft(std::size_t i, double* length = nullptr) const {
    const Vector2d way = plane_.wayTo(Vector3d(plane_.inverse(frameOf(i)) * goals_[i]));
    if (length != nullptr) *length = way.norm();
    return way;
  }

  double edgeAt(std::size_t i) const {
    double longest = 0;
    for (Index h = firstHalfedge(i); h < firstHalfedge(i) + 3; ++h) {
      longest = std::max(longest, plane_.wayTo(links_[h].col(2)).norm());
    }
    return longest;
  }

  bool met() const {
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      if (wayLeft(i).norm() > kMet * edgeAt(i)) return false;
    }
    return true;
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
    view.reach = std::max(kReach * travel_[i], kEdges * edgeAt(i));
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
          view.reach = std::max(distanceTo(known->second), kEdges * edgeAt(i) / 2);
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
    return kernel(way.norm() / view.reach) * turn.topLeftCorner<2, 2>().transpose();
  }

  /// The vectors at the landmarks under which all of them go a share of their ways.
  std::vector<Vector2d> strengths(const std::vector<View>& views, double share) const {
    const auto count = static_cast<Eigen::Index>(views.size());
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(2 * count, 2 * count);
    Eigen::VectorXd wanted(2 * count);
    for (Eigen::Index i = 0; i < count; ++i) {
      wanted.segment<2>(2 * i) = share * wayLeft(static_cast<std::size_t>(i));
      addRows(views, i, system);
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
      size += landmarks_[number].point.barycentric[c] * (back * at[c])(2, 2);
    }
    for (int c = 0; c < 3; ++c) {
      const double weight = landmarks_[number].point.barycentric[c] / size;
      const Index v = surface_.tail(firstHalfedge(number) + c);
      const Matrix2d seen = (back * at[c]).topLeftCorner<2, 2>();
      for (Eigen::Index j = 0; j < system.cols() / 2; ++j) {
        const auto motion = views[j].motions.find(v);
        if (motion == views[j].motions.end()) continue;
        system.block<2, 2>(2 * i, 2 * j) += weight * seen * carried(views[j], motion->second);
      }
    }
  }

  /// Goes on, with every landmark at most kStep of its reach; false where that would fold a face.
  bool step(double share) {
    std::vector<View> views;
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      views.push_back(lookAround(i));
      const double left = wayLeft(i).norm();
      if (share * left > kStep * views[i].reach) share = kStep * views[i].reach / left;
    }
    const std::vector<Vector2d> vectors = strengths(views, share);
    std::unordered_map<Index, Vector2d> ways;
    for (std::size_t i = 0; i < views.size(); ++i) {
      for (const auto& [v, motion] : views[i].motions) {
        const Vector2d way = carried(views[i], motion) * vectors[i];
        ways.try_emplace(v, Vector2d::Zero()).first->second += way;
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

  /// The two landmarks that are nearest to folded faces, of those that move them.
  void blame(const std::vector<View>& views, const std::vector<bool>& folded) {
    std::vector<std::pair<double, std::size_t>> found;
    for (std::size_t i = 0; i < views.size(); ++i) {
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
    std::sort(around_.begin(), around_.end());
  }

  Context& context_;
  const Connectivity& surface_;
  const CoverSurface& cover_;
  const CoverPlane plane_;
  const CoverMap& map_;
  const std::vector<CoverLandmark>& landmarks_;
  VertexLinks links_;
  std::vector<Motion> moves_;    ///< As HarmonicMap has them.
  std::vector<Vector3d> goals_;  ///< In the frames of the first corners of the landmarks' faces.
  std::vector<double> travel_;   ///< How far the landmarks are from their targets at first.
  std::vector<std::size_t> around_;
};

}  // namespace

Result<LandmarkFlow> flowToLandmarks(Context& context, const Connectivity& surface,
                                     const CoverSurface& cover, const CoverMap& map,
                                     const std::vector<CoverLandmark>& landmarks) {
  return Flow(context, surface, cover, map, landmarks).run();
}

}  // namespace moduli
