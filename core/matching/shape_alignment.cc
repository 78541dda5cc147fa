#include "core/matching/shape_alignment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/parallel.h"
#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/matching/map_report.h"
#include "core/matching/nearest_in_triangle.h"
#include "core/mesh/vertex_normals.h"

namespace moduli {
namespace {

using Eigen::Vector3d;
using Places = Eigen::Matrix3Xd;  ///< One column per vertex.

/// Lengths over which shapes are smoothed, as shares of the root of the area: each half as long
/// again, from the finest relief to limbs.
constexpr std::array<double, 6> kLengths = {0.02, 0.03, 0.045, 0.0675, 0.1, 0.15};
constexpr int kHeatSteps = 4;      ///< Implicit ones, for one length.
constexpr int kRounds = 40;        ///< Of nearest points and the similarity to them.
constexpr double kAlong = 0.1;     ///< Of distances along a surface beside those across it.
constexpr double kSettled = 1e-3;  ///< Of the mean gap, by which a round must lower it to go on.
constexpr double kWrong = 3;       ///< Times the median: a nearest point that is none.
constexpr double kQuantile = 0.95;
/// Smoothing has to lower the gap to this part, for it lowers that of coarse meshes a little.
constexpr double kClearlyLess = 2.0 / 3;

Places placesOf(const TriangleMesh& mesh) {
  Places places(3, mesh.vertexCount());
  for (Index v = 0; v < mesh.vertexCount(); ++v) places.col(v) = mesh.positions()[v];
  return places;
}

Places normalsOf(const Connectivity& surface, const Places& places) {
  const auto columns = places.colwise();
  const std::vector<Vector3d> normals = vertexNormals(surface, {columns.begin(), columns.end()});
  Places result(3, places.cols());
  for (Eigen::Index v = 0; v < result.cols(); ++v) result.col(v) = normals[v];
  return result;
}

double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Moves the places of a surface by heat flow in its own metric, which stays as it is.
class HeatFlow {
 public:
  static Result<HeatFlow> make(const TriangleMesh& mesh) {
    ASSIGN_OR_RETURN(const MollifiedLengths mollified,
                     mollify(mesh.connectivity(), mesh.edgeLengths()));
    HeatFlow flow;
    flow.stiffness_ =
        stiffnessMatrix(mesh.connectivity(), cotanWeights(mesh.connectivity(), mollified.lengths));
    const std::vector<double> areas = vertexAreas(mesh.connectivity(), mollified.lengths);
    flow.mass_ = Eigen::Map<const Eigen::VectorXd>(areas.data(), mesh.vertexCount());
    flow.places_ = placesOf(mesh);
    return flow;
  }

  /// For the square of a length, a share of the root of the area, as time.
  Result<Places> after(Context& context, double length) const {
    const double step = length * length * mass_.sum() / kHeatSteps;
    SparseMatrix matrix = step * stiffness_;
    for (Eigen::Index v = 0; v < mass_.size(); ++v) matrix.coeffRef(v, v) += mass_[v];
    ASSIGN_OR_RETURN(const SpdSolver solver, SpdSolver::make(context, matrix));
    Eigen::MatrixXd flowing = places_.transpose();
    for (int i = 0; i < kHeatSteps; ++i) {
      ASSIGN_OR_RETURN(flowing, solver.solve(context, mass_.asDiagonal() * flowing));
    }
    return Places(flowing.transpose());
  }

  const Places& places() const { return places_; }

 private:
  SparseMatrix stiffness_;
  Eigen::VectorXd mass_;
  Places places_;
};

/// Nearest vertices of a surface whose normals look the same way.
class LookingNearest {
 public:
  LookingNearest(const Connectivity& surface, const Places& places)
      : surface_(surface), places_(places), normals_(normalsOf(surface, places)) {}

  /// The nearest point of the faces around the nearest vertex.
  SurfacePoint operator()(const Vector3d& place, const Vector3d& normal) const {
    Index nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      const double distance = (places_.col(v) - place).squaredNorm();
      if (!(distance < least) || !(normals_.col(v).dot(normal) > 0)) continue;
      least = distance;
      nearest = v;
    }
    return around(nearest, place);
  }

  Vector3d at(const SurfacePoint& point) const { return between(places_, point); }

  Vector3d normal(const SurfacePoint& point) const {
    return between(normals_, point).stableNormalized();
  }

 private:
  Vector3d between(const Places& columns, const SurfacePoint& point) const {
    const Triangle& face = surface_.face(point.face);
    Vector3d sum = Vector3d::Zero();
    for (int c = 0; c < 3; ++c) sum += point.barycentric[c] * columns.col(face[c]);
    return sum;
  }

  SurfacePoint around(Index vertex, const Vector3d& place) const {
    SurfacePoint nearest;
    double least = std::numeric_limits<double>::infinity();
    const Index first = surface_.outgoing(vertex);
    Index h = first;
    do {
      const auto& [i, j, k] = surface_.face(h / 3);
      const SurfacePoint point = {
          h / 3,
          nearestInTriangle<Vector3d>(place, places_.col(i), places_.col(j), places_.col(k))};
      const double distance = (at(point) - place).squaredNorm();
      if (distance < least) {
        least = distance;
        nearest = point;
      }
      h = surface_.rotate(h);
    } while (h != kNone && h != first);
    return nearest;
  }

  const Connectivity& surface_;
  const Places& places_;
  Places normals_;
};

/// A sample, the point of the other surface that is nearest, and that one's unit normal.
struct Nearby {
  Vector3d from, to, normal;
};

/// Gauss and Newton's step among the similarities: most of a distance counts across the surface
/// (Chen and Medioni 1992), so that points slide along it to where they belong; and some of it
/// along the surface, for round bodies leave turns free.
Eigen::Affine3d stepTowards(const std::vector<Nearby>& points) {
  Vector3d centre = Vector3d::Zero();
  for (const Nearby& one : points) centre += one.from / static_cast<double>(points.size());
  Eigen::Matrix<double, 7, 7> normal_matrix = Eigen::Matrix<double, 7, 7>::Zero();
  Eigen::Matrix<double, 7, 1> side = Eigen::Matrix<double, 7, 1>::Zero();
  for (const Nearby& one : points) {
    const Vector3d x = one.from - centre;
    Eigen::Matrix<double, 3, 7> change;       // Turn, scale, shift.
    change << 0, x[2], -x[1], x[0], 1, 0, 0,  //
        -x[2], 0, x[0], x[1], 0, 1, 0,        //
        x[1], -x[0], 0, x[2], 0, 0, 1;
    const Eigen::Matrix3d weight =
        (1 - kAlong) * one.normal * one.normal.transpose() + kAlong * Eigen::Matrix3d::Identity();
    normal_matrix += change.transpose() * weight * change;
    side += change.transpose() * weight * (one.to - one.from);
  }
  const Eigen::Matrix<double, 7, 1> step = normal_matrix.ldlt().solve(side);
  const Vector3d turn = step.head<3>();
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  result.translate(centre + step.tail<3>());
  result.rotate(Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()));
  result.scale(std::exp(step[3]));
  result.translate(-centre);
  return result;
}

class Aligning {
 public:
  Aligning(Context& context, const TriangleMesh& a, const TriangleMesh& b, HeatFlow flow_a,
           HeatFlow flow_b, const std::vector<Index>& samples, const std::vector<Vector3d>& targets)
      : context_(context),
        a_(a.connectivity()),
        b_(b.connectivity()),
        flow_a_(std::move(flow_a)),
        flow_b_(std::move(flow_b)),
        samples_(samples),
        targets_(3, targets.size()),
        unit_(std::sqrt(b.area())) {
    for (std::size_t i = 0; i < targets.size(); ++i) {
      targets_.col(static_cast<Eigen::Index>(i)) = targets[i];
    }
  }

  Result<std::optional<ShapeAlignment>> run(double most) {
    ShapeAlignment best;
    best.gap = std::numeric_limits<double>::infinity();
    RETURN_IF_ERROR(tryShapes({flow_a_.places(), flow_b_.places()}, best).status());
    for (const bool of_second : {false, true}) {
      // Smoothing brings shapes nearer to each other up to some length, if at all.
      double before = std::numeric_limits<double>::infinity();
      for (const double length : kLengths) {
        Shapes shapes = {flow_a_.places(), flow_b_.places()};
        const HeatFlow& flow = of_second ? flow_b_ : flow_a_;
        ASSIGN_OR_RETURN((of_second ? shapes.b : shapes.a), flow.after(context_, length));
        ShapeAlignment one;
        one.smoothing = length;
        one.of_second = of_second;
        one.gap = best.smoothing > 0 ? best.gap : kClearlyLess * best.gap;
        ASSIGN_OR_RETURN(const double gap, tryShapes(std::move(shapes), one));
        if (!one.points.empty()) best = std::move(one);
        if (gap > before) break;
        before = gap;
      }
    }
    if (!(best.gap <= most)) return std::optional<ShapeAlignment>();
    return std::optional(std::move(best));
  }

 private:
  struct Shapes {
    Places a, b;
  };

  /// Where alignment is better than the known one, it takes that one's place. Returns the gap.
  Result<double> tryShapes(Shapes shapes, ShapeAlignment& known) const {
    RETURN_IF_ERROR(context_.check());
    const LookingNearest nearest(b_, shapes.b);
    const Eigen::Affine3d map = align(shapes.a, nearest);
    return measure(shapes.a, map, nearest, known);
  }

  Eigen::Affine3d align(const Places& a, const LookingNearest& nearest) const {
    Places from(3, samples_.size());
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      from.col(static_cast<Eigen::Index>(i)) = a.col(samples_[i]);
    }
    const Places normals = normalsOf(a_, a);
    Eigen::Affine3d map(Eigen::umeyama(from, targets_));
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kRounds && map.matrix().allFinite(); ++round) {
      std::vector<Nearby> found;
      std::vector<double> gaps;
      for (const Index v : samples_) {
        const Vector3d place = map * a.col(v);
        const SurfacePoint point = nearest(place, map.linear() * normals.col(v));
        found.push_back({place, nearest.at(point), nearest.normal(point)});
        gaps.push_back((found.back().to - place).norm());
      }
      const double limit = kWrong * quantile(gaps, 0.5);
      std::erase_if(found, [&](const Nearby& one) { return (one.to - one.from).norm() > limit; });
      double sum = 0;
      for (const double gap : gaps) sum += std::min(gap, limit);
      if (!(sum < (1 - kSettled) * before)) break;
      before = sum;
      map = stepTowards(found) * map;
    }
    return map;
  }

  double measure(const Places& a, const Eigen::Affine3d& map, const LookingNearest& nearest,
                 ShapeAlignment& known) const {
    if (!map.matrix().allFinite()) return std::numeric_limits<double>::infinity();
    const Places normals = normalsOf(a_, a);
    const auto find = [&](Index v) {
      return nearest(map * a.col(v), map.linear() * normals.col(v));
    };
    const auto gapTo = [&](Index v, const SurfacePoint& point) {
      return (map * a.col(v) - nearest.at(point)).norm() / unit_;
    };
    std::vector<double> gaps;
    for (const Index v : samples_) gaps.push_back(gapTo(v, find(v)));
    const double gap = quantile(std::move(gaps), kQuantile);
    if (!(gap < known.gap)) return gap;
    known.gap = gap;
    known.points.resize(a.cols());
    known.gaps.resize(a.cols());
    parallelBlocks(known.points.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        known.points[v] = find(static_cast<Index>(v));
        known.gaps[v] = gapTo(static_cast<Index>(v), known.points[v]);
      }
    });
    return gap;
  }

  Context& context_;
  const Connectivity& a_;
  const Connectivity& b_;
  HeatFlow flow_a_, flow_b_;
  const std::vector<Index>& samples_;
  Places targets_;
  double unit_;
};

}  // namespace

Result<std::optional<ShapeAlignment>> alignShapes(Context& context, const TriangleMesh& a,
                                                  const TriangleMesh& b,
                                                  const std::vector<Index>& samples,
                                                  const std::vector<Vector3d>& targets,
                                                  double most) {
  const Context::Stage stage(context, "shape");
  ASSIGN_OR_RETURN(HeatFlow flow_a, HeatFlow::make(a));
  ASSIGN_OR_RETURN(HeatFlow flow_b, HeatFlow::make(b));
  return Aligning(context, a, b, std::move(flow_a), std::move(flow_b), samples, targets).run(most);
}

}  // namespace moduli
