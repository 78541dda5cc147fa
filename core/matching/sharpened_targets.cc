#include "core/matching/sharpened_targets.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/base/parallel.h"
#include "core/intrinsic/edge_graph.h"
#include "core/matching/map_report.h"
#include "core/matching/nearest_in_triangle.h"

namespace moduli {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vectors = std::vector<Vector3d>;

/// Of the root of the area.
constexpr double kFirstRadius = 0.2;
/// Rounds with one radius: until targets go less than this share of it.
constexpr double kAtRest = 0.003;
constexpr int kMostRounds = 20;
/// Weight of the distance from the target beside that from the plane there.
constexpr double kPointShare = 0.1;
/// Of edges.
constexpr int kParts = 4;
/// Fewer vertices than these many edges around tell no motion.
constexpr double kLeastEdges = 3;
/// Of the radius: a turn by one radian counts as such a shift.
constexpr double kTurn = 0.2;
constexpr std::size_t kRows = 64;

/// A surface of area 1, a vertex at 0.
struct Body {
  explicit Body(const TriangleMesh& mesh)
      : surface(mesh.connectivity()),
        positions(mesh.positions()),
        normals(positions.size(), Vector3d::Zero()),
        areas(positions.size(), 0.0) {
    const double unit = std::sqrt(mesh.area());
    const Vector3d origin = positions.front();
    for (Vector3d& p : positions) p = (p - origin) / unit;
    for (Index f = 0; f < surface.faceCount(); ++f) {
      const Vector3d normal = normalOf(f);
      for (const Index v : surface.face(f)) {
        normals[v] += normal;
        areas[v] += normal.norm() / 6;
      }
    }
    for (Vector3d& n : normals) n.normalize();
  }

  Vector3d place(const SurfacePoint& point) const { return spacePoint(surface, positions, point); }

  Vector3d normalAt(const SurfacePoint& point) const {
    return spacePoint(surface, normals, point).normalized();
  }

  /// As long as the face is large, twice.
  Vector3d normalOf(Index f) const {
    const auto& [i, j, k] = surface.face(f);
    return (positions[j] - positions[i]).cross(positions[k] - positions[i]);
  }

  const Connectivity& surface;
  Vectors positions, normals;
  std::vector<double> areas;
};

/// Vertices by the cubes they are in.
class Cubes {
 public:
  Cubes(const Body& body, double side) : body_(body), side_(side) {
    for (Index v = 0; v < body.surface.vertexCount(); ++v) {
      inside_[key(cubeOf(body.positions[v]))].push_back(v);
    }
  }

  /// The vertex of least square distance, that of normals counted as `turn` for each radian; kNone
  /// beyond a distance.
  Index nearest(const Vector3d& place, const Vector3d& normal, double turn, double most) const {
    const Cube middle = cubeOf(place);
    Index found = kNone;
    double best = most * most;
    for (std::int64_t shell = 0; static_cast<double>(shell - 1) * side_ < std::sqrt(best);
         ++shell) {
      Cube cube;
      for (cube[0] = middle[0] - shell; cube[0] <= middle[0] + shell; ++cube[0]) {
        for (cube[1] = middle[1] - shell; cube[1] <= middle[1] + shell; ++cube[1]) {
          const bool outer =
              std::abs(cube[0] - middle[0]) == shell || std::abs(cube[1] - middle[1]) == shell;
          const std::int64_t step = outer || shell == 0 ? 1 : 2 * shell;
          for (cube[2] = middle[2] - shell; cube[2] <= middle[2] + shell; cube[2] += step) {
            const auto here = inside_.find(key(cube));
            if (here == inside_.end()) continue;
            for (const Index v : here->second) {
              const double square = (body_.positions[v] - place).squaredNorm() +
                                    turn * turn * (body_.normals[v] - normal).squaredNorm();
              if (!(square < best)) continue;
              best = square;
              found = v;
            }
          }
        }
      }
    }
    return found;
  }

 private:
  using Cube = std::array<std::int64_t, 3>;

  Cube cubeOf(const Vector3d& p) const {
    Cube cube;
    for (int c = 0; c < 3; ++c) cube[c] = static_cast<std::int64_t>(std::floor(p[c] / side_));
    return cube;
  }

  /// Different ones for cubes that are not half a million sides from each other.
  static std::uint64_t key(const Cube& cube) {
    constexpr std::uint64_t kMany = 1 << 20;
    return (static_cast<std::uint64_t>(cube[0]) * kMany + static_cast<std::uint64_t>(cube[1])) *
               kMany +
           static_cast<std::uint64_t>(cube[2]);
  }

  const Body& body_;
  double side_;
  std::unordered_map<std::uint64_t, std::vector<Index>> inside_;
};

/// The rigid motion that brings points nearest to others, by weights.
struct RigidMotion {
  Matrix3d turn = Matrix3d::Identity();
  Vector3d shift = Vector3d::Zero();
  Vector3d operator()(const Vector3d& p) const { return turn * p + shift; }
};

class Sharpening {
 public:
  Sharpening(const TriangleMesh& a, const TriangleMesh& b)
      : a_(a), b_(b), graph_(a.connectivity(), lengthsOf(a)) {}

  static double meanEdge(const Body& body) { return std::sqrt(2.3 / body.surface.faceCount()); }

  Result<SharpTargets> run(Context& context, const std::vector<SurfacePoint>& targets) {
    const Context::Stage stage(context, "sharpen");
    for (const SurfacePoint& target : targets) {
      places_.push_back(b_.place(target));
      target_normals_.push_back(b_.normalAt(target));
    }
    const double least = kLeastEdges * meanEdge(a_);
    SharpTargets result;
    result.vertices = targets;
    for (double radius = kFirstRadius; !(radius_ == least); radius /= 2) {
      RETURN_IF_ERROR(setRadius(context, std::max(radius, least)));
      double gone = std::numeric_limits<double>::infinity();
      for (int round = 0; round < kMostRounds && gone > kAtRest * radius_; ++round) {
        RETURN_IF_ERROR(moveAll(context));
        inParallel(context, targets.size(), [&](std::size_t v) {
          take({motions_[v](a_.positions[v]), motions_[v].turn * a_.normals[v]},
               result.vertices[v]);
        });
        RETURN_IF_ERROR(context.check());
        gone = replacePlaces(result.vertices);
      }
    }
    RETURN_IF_ERROR(moveAll(context));
    result.ways = waysOf(context, result.vertices);
    RETURN_IF_ERROR(context.check());
    return result;
  }

 private:
  struct Moved {
    Vector3d place, normal;
  };

  static std::vector<double> lengthsOf(const TriangleMesh& mesh) {
    std::vector<double> lengths = mesh.edgeLengths();
    for (double& length : lengths) length /= std::sqrt(mesh.area());
    return lengths;
  }

  template <typename Work>
  static void inParallel(Context& context, std::size_t count, const Work& work) {
    parallelBlocks(count, kRows, [&](std::size_t begin, std::size_t end) {
      if (!context.check().ok()) return;
      for (std::size_t i = begin; i < end; ++i) work(i);
    });
  }

  Status setRadius(Context& context, double radius) {
    radius_ = radius;
    cubes_.emplace(b_, std::max(meanEdge(b_), kTurn * radius / 2));
    near_.resize(places_.size());
    inParallel(context, near_.size(),
               [&](std::size_t v) { near_[v] = graph_.within(static_cast<Index>(v), radius); });
    return context.check();
  }

  Status moveAll(Context& context) {
    motions_.resize(places_.size());
    inParallel(context, motions_.size(), [&](std::size_t v) { motions_[v] = motionAround(v); });
    return context.check();
  }

  /// Returns how far the targets have gone, on average.
  double replacePlaces(const std::vector<SurfacePoint>& targets) {
    double sum = 0;
    for (std::size_t v = 0; v < targets.size(); ++v) {
      const Vector3d place = b_.place(targets[v]);
      sum += (place - places_[v]).norm();
      places_[v] = place;
      target_normals_[v] = b_.normalAt(targets[v]);
    }
    return sum / static_cast<double>(targets.size());
  }

  EdgeWays waysOf(Context& context, const std::vector<SurfacePoint>& targets) const {
    EdgeWays ways(static_cast<std::size_t>(a_.surface.edgeCount()));
    inParallel(context, ways.size(), [&](std::size_t e) {
      const Index h = a_.surface.halfedge(static_cast<Index>(e));
      SurfacePoint point = targets[a_.surface.tail(h)];
      for (int part = 1; part < kParts; ++part) {
        take(movedOnEdge(h, static_cast<double>(part) / kParts), point);
        ways[e].push_back(point);
      }
    });
    return ways;
  }

  /// What the motions of both ends make of a point of an edge.
  Moved movedOnEdge(Index h, double share) const {
    const Index v = a_.surface.tail(h), w = a_.surface.head(h);
    const Vector3d place = (1 - share) * a_.positions[v] + share * a_.positions[w];
    Vector3d across = a_.normalOf(h / 3);
    if (const Index twin = a_.surface.twin(h); twin != kNone) across += a_.normalOf(twin / 3);
    // From one end's to that of the two faces and to the other end's.
    const double middle = 2 * std::min(share, 1 - share);
    const Vector3d normal =
        middle * across.normalized() +
        (share < 0.5 ? (1 - middle) * a_.normals[v] : (1 - middle) * a_.normals[w]);
    const RigidMotion &m = motions_[v], &n = motions_[w];
    return {(1 - share) * m(place) + share * n(place),
            ((1 - share) * (m.turn * normal) + share * (n.turn * normal)).normalized()};
  }

  /// The point of b nearest to what was moved; where none is, all stays.
  void take(const Moved& moved, SurfacePoint& point) const {
    const Index near = cubes_->nearest(moved.place, moved.normal, kTurn * radius_, radius_);
    if (near != kNone) point = pointNear(moved.place, near);
  }

  RigidMotion motionAround(std::size_t v) const {
    const auto& near = near_[v];
    double sum = 0;
    Vector3d from = Vector3d::Zero(), to = Vector3d::Zero();
    std::vector<double> weights;
    for (const auto& [w, distance] : near) {
      const double share = 1 - distance * distance / (radius_ * radius_);
      weights.push_back(a_.areas[w] * share * share);
      sum += weights.back();
      from += weights.back() * a_.positions[w];
      to += weights.back() * places_[w];
    }
    from /= sum;
    to /= sum;
    Matrix3d product = Matrix3d::Zero();
    for (std::size_t i = 0; i < near.size(); ++i) {
      const Index w = near[i].first;
      product += weights[i] * (places_[w] - to) * (a_.positions[w] - from).transpose();
    }
    const Eigen::JacobiSVD<Matrix3d> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Matrix3d sign = Matrix3d::Identity();
    sign(2, 2) = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
    RigidMotion motion;
    motion.turn = svd.matrixU() * sign * svd.matrixV().transpose();
    motion.shift = to - motion.turn * from;
    return towardsPlanes(motion, near, weights, to);
  }

  /// From the motion of least distances from the targets one step of Gauss and Newton's method for
  /// those from the planes that touch b there, and a little for the former: points slide where b is
  /// smooth. middle: the mean of the targets.
  RigidMotion towardsPlanes(const RigidMotion& start,
                            const std::vector<std::pair<Index, double>>& near,
                            const std::vector<double>& weights, const Vector3d& middle) const {
    using Row = Eigen::Matrix<double, 6, 1>;
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Row right = Row::Zero();
    Matrix3d spread = Matrix3d::Zero();
    double sum = 0;
    for (std::size_t i = 0; i < near.size(); ++i) {
      const Index w = near[i].first;
      const Vector3d place = start(a_.positions[w]), arm = place - middle;
      const Vector3d& plane = target_normals_[w];
      Row slope;
      slope << arm.cross(plane), plane;
      normal.noalias() += weights[i] * slope * slope.transpose();
      right += weights[i] * plane.dot(places_[w] - place) * slope;
      spread.noalias() += weights[i] * arm * arm.transpose();
      sum += weights[i];
    }
    // The targets themselves draw nowhere at the start, which is nearest to them.
    normal.topLeftCorner<3, 3>() += kPointShare * (spread.trace() * Matrix3d::Identity() - spread);
    normal.bottomRightCorner<3, 3>() += kPointShare * sum * Matrix3d::Identity();
    const Row step = normal.ldlt().solve(right);
    if (!step.allFinite()) return start;
    const Vector3d turn = step.head<3>();
    const double angle = turn.norm();
    const Matrix3d more = angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix()
                                    : Matrix3d(Matrix3d::Identity());
    RigidMotion motion;
    motion.turn = more * start.turn;
    motion.shift = more * (start.shift - middle) + middle + step.tail<3>();
    return motion;
  }

  /// The nearest point of the faces around a vertex of b.
  SurfacePoint pointNear(const Vector3d& place, Index vertex) const {
    SurfacePoint nearest;
    double best = std::numeric_limits<double>::infinity();
    const Index first = b_.surface.outgoing(vertex);
    Index h = first;
    do {
      const auto& [i, j, k] = b_.surface.face(h / 3);
      const auto weights =
          nearestInTriangle<Vector3d>(place, b_.positions[i], b_.positions[j], b_.positions[k]);
      const SurfacePoint point{h / 3, weights};
      const double square = (b_.place(point) - place).squaredNorm();
      if (square < best) {
        best = square;
        nearest = point;
      }
      h = b_.surface.rotate(h);
    } while (h != kNone && h != first);
    return nearest;
  }

  const Body a_, b_;
  EdgeGraph graph_;
  std::optional<Cubes> cubes_;
  Vectors places_;  ///< Of the targets, as they are now.
  Vectors target_normals_;
  double radius_ = 0;
  std::vector<std::vector<std::pair<Index, double>>> near_;  ///< Per vertex, within the radius.
  std::vector<RigidMotion> motions_;
};

}  // namespace

Result<SharpTargets> sharpenTargets(Context& context, const TriangleMesh& a, const TriangleMesh& b,
                                    const std::vector<SurfacePoint>& targets) {
  return Sharpening(a, b).run(context, targets);
}

}  // namespace moduli
