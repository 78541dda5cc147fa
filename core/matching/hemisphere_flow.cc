#include "core/matching/hemisphere_flow.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/matching/flow_kernel.h"
#include "core/spherical/exact_sign.h"
#include "core/spherical/landmark_checks.h"

namespace moduli {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
/// Directions at a mark: two, or the one along the equator.
using Basis = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 2>;

Vector3d mirrored(const Vector3d& p) {
  return {p[0], p[1], -p[2]};
}

/// p -> v x p.
Matrix3d crossing(const Vector3d& v) {
  Matrix3d cross;
  cross << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return cross;
}

class HemisphereMotion {
 public:
  HemisphereMotion(Context& context, const Connectivity& surface, Points3 points,
                   const std::vector<HemisphereMark>& marks)
      : context_(context),
        surface_(surface),
        points_(std::move(points)),
        marks_(marks),
        rests_(marks.size(), false),
        nearest_(marks.size()) {}

  Result<HemisphereFlow> run() {
    const Context::Stage stage(context_, "landmarks");
    findTravels();
    ASSIGN_OR_RETURN(const FlowCourse course, runFlow(context_, *this, true));
    return HemisphereFlow{std::move(points_), course.met, course.steps};
  }

  bool met() const {
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      if (wayLeft(i).norm() > kFlowMet * edgeAt(i)) return false;
    }
    return true;
  }

  bool stayBehind() {
    if (nearest_ == marks_.size()) return false;
    rests_[nearest_] = true;
    nearest_ = marks_.size();
    return true;
  }

  bool step(double share) {
    std::vector<Source> sources;
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      const Vector3d place = placeOf(i);
      sources.push_back({place, reachOf(i), basisAt(i, place)});
      const double left = wayLeft(i).norm();
      if (share * left > kFlowStep * sources.back().reach) {
        share = kFlowStep * sources.back().reach / left;
      }
    }
    const Eigen::VectorXd vectors = strengths(sources, share);
    Points3 points = points_;
    for (Index v = 0; v < pole(); ++v) {
      Vector3d turn = Vector3d::Zero();
      Eigen::Index row = 0;
      for (const Source& source : sources) {
        turn += source.at(points_[v]) * vectors.segment(row, source.basis.cols());
        row += source.basis.cols();
      }
      const double angle = turn.norm();
      if (!(angle > 0)) continue;
      points[v] = (Eigen::AngleAxisd(angle, turn / angle) * points_[v]).normalized();
      if (points_[v][2] == 0) {
        points[v][2] = 0;
        points[v].normalize();
      }
    }
    bool folds = false;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : surface_.faces()) {
      if (spherical::orientationSign(points[a], points[b], points[c]) > 0) continue;
      for (std::size_t i = 0; i < sources.size(); ++i) {
        const double away = (points_[a] - sources[i].place).norm() / sources[i].reach;
        if (rests_[i] || !(away < std::min(least, 1.0))) continue;
        least = away;
        nearest_ = i;
      }
      folds = true;
    }
    if (!folds) points_ = std::move(points);
    return !folds;
  }

 private:
  Index pole() const { return surface_.vertexCount() - 1; }
  bool isOnRim(std::size_t i) const { return marks_[i].target[2] == 0; }
  Index corner(std::size_t i, int c) const { return surface_.face(marks_[i].point.face)[c]; }

  Vector3d placeOf(std::size_t i) const {
    Vector3d place = spherePoint(surface_, points_, marks_[i].point);
    if (isOnRim(i)) place[2] = 0;
    return place;
  }

  Basis basisAt(std::size_t i, const Vector3d& place) const {
    Basis basis(3, isOnRim(i) ? 1 : 2);
    const Vector3d axis = std::abs(place[2]) < 0.9 ? Vector3d::UnitZ() : Vector3d::UnitX();
    basis.col(0) = axis.cross(place).normalized();
    if (!isOnRim(i)) basis.col(1) = place.cross(basis.col(0));
    return basis;
  }

  /// The direction to a mark's target, as long as the angle.
  Vector3d wayLeft(std::size_t i) const {
    if (rests_[i]) return Vector3d::Zero();
    const Vector3d place = placeOf(i), target = marks_[i].target;
    const Vector3d side = target - place.dot(target) * place;
    const double length = side.norm();
    return length > 0 ? Vector3d(spherical::angleBetween(place, target) / length * side) : side;
  }

  double edgeAt(std::size_t i) const {
    double longest = 0;
    for (int c = 0; c < 3; ++c) {
      longest = std::max(longest, (points_[corner(i, c)] - points_[corner(i, (c + 1) % 3)]).norm());
    }
    return longest;
  }

  double reachOf(std::size_t i) const {
    return std::max(kFlowReach * travel_[i], kFlowEdges * edgeAt(i));
  }

  void findTravels() {
    for (std::size_t i = 0; i < marks_.size(); ++i) travel_.push_back(wayLeft(i).norm());
    spreadTravels(travel_, [this](std::size_t i) {
      const Vector3d place = placeOf(i);
      std::vector<double> shares;
      for (std::size_t j = 0; j < marks_.size(); ++j) {
        shares.push_back(flowKernel(spherical::angleBetween(place, placeOf(j)) / reachOf(i)));
      }
      return shares;
    });
  }

  /// A mark and what it moves.
  struct Source {
    Vector3d place;
    double reach = 0;
    Basis basis;

    /// The rotation that a vector at the mark, in its basis, makes of what is at q, with the mirror
    /// image's.
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 2> at(const Vector3d& q) const {
      const auto share = [&](const Vector3d& p) {
        // Cheaper than the angle, which is at least the chord.
        return (p - q).squaredNorm() < reach * reach
                   ? flowKernel(spherical::angleBetween(p, q) / reach)
                   : 0;
      };
      const double own = share(place), other = share(mirrored(place));
      Basis turns = crossing(place) * basis;
      // A turn's axis is reflected the other way.
      turns.topRows<2>() *= own - other;
      turns.row(2) *= own + other;
      return turns;
    }
  };

  /// The vectors of the marks, one after the other in their bases, that carry all a share on.
  Eigen::VectorXd strengths(const std::vector<Source>& sources, double share) const {
    Eigen::Index size = 0;
    for (const Source& source : sources) size += source.basis.cols();
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd wanted(size);
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const Basis& basis = sources[i].basis;
      wanted.segment(row, basis.cols()) = share * basis.transpose() * wayLeft(i);
      Vector3d sum = Vector3d::Zero();
      for (int c = 0; c < 3; ++c) sum += marks_[i].point.barycentric[c] * points_[corner(i, c)];
      for (int c = 0; c < 3; ++c) {
        const Vector3d& q = points_[corner(i, c)];
        const double weight = marks_[i].point.barycentric[c] / sum.norm();
        Eigen::Index column = 0;
        for (const Source& source : sources) {
          const Eigen::Index count = source.basis.cols();
          system.block(row, column, basis.cols(), count) -=
              weight * basis.transpose() * crossing(q) * source.at(q);
          column += count;
        }
      }
      row += basis.cols();
    }
    return Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(system).solve(wanted);
  }

  Context& context_;
  const Connectivity& surface_;
  Points3 points_;
  const std::vector<HemisphereMark>& marks_;
  std::vector<bool> rests_;  ///< Per mark: whether it has given up.
  std::vector<double> travel_;
  std::size_t nearest_;  ///< Of the marks that go on, to the last fold; their number for none.
};

}  // namespace

Result<HemisphereFlow> flowOnHemisphere(Context& context, const Connectivity& surface,
                                        Points3 points, const std::vector<HemisphereMark>& marks) {
  return HemisphereMotion(context, surface, std::move(points), marks).run();
}

}  // namespace moduli
