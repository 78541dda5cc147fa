#include "core/spherical/heat_flow.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "core/forms/cotan.h"
#include "core/linalg/spd_solver.h"
#include "core/spherical/delaunay_weights.h"
#include "core/spherical/sphere_start.h"

namespace moduli {
namespace {

using spherical::WeightedSurface;

/// Three columns, one row per vertex.
using Field = Eigen::Matrix<double, Eigen::Dynamic, 3>;

struct Edge {
  Index tail, head;
  double weight;
};

/// Vertex areas of the surface scaled to the area of the sphere.
std::vector<double> sphereAreas(const Connectivity& surface, const std::vector<double>& lengths) {
  std::vector<double> areas = vertexAreas(surface, unitLengths(lengths));
  double total = 0;
  for (const double area : areas) total += area;
  for (double& area : areas) area *= 4 * std::numbers::pi / total;
  return areas;
}

/// The energy of maps to the sphere, and its slope among the centred ones.
class DirichletEnergy {
 public:
  DirichletEnergy(const WeightedSurface& metric, const std::vector<double>& areas) : areas_(areas) {
    const Connectivity& surface = metric.surface;
    for (Index e = 0; e < surface.edgeCount(); ++e) {
      const Index h = surface.halfedge(e);
      if (surface.tail(h) == surface.head(h)) continue;  // A loop has no length in the image.
      edges_.push_back({surface.tail(h), surface.head(h), metric.weights[e]});
    }
  }

  double value(const Points3& points) const {
    double sum = 0;
    for (const Edge& e : edges_) sum += e.weight * (points[e.head] - points[e.tail]).squaredNorm();
    return sum / 2;
  }

  /// Tangential part of L phi, less what pushes along Möbius maps: the rest is orthogonal to the
  /// fields V_k = e_k - phi_k phi, and 0 exactly where the energy is stationary among centred maps.
  Field gradient(const Points3& points) const {
    Field result = Field::Zero(static_cast<Eigen::Index>(points.size()), 3);
    for (const Edge& e : edges_) {
      const Eigen::RowVector3d pull = (e.weight * (points[e.tail] - points[e.head])).transpose();
      result.row(e.tail) += pull;
      result.row(e.head) -= pull;
    }
    makeTangential(points, result);
    Eigen::Matrix3d overlap = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) overlap += areas_[i] * projector(points[i]);
    const Eigen::Vector3d push = overlap.ldlt().solve(result.colwise().sum().transpose());
    for (std::size_t i = 0; i < points.size(); ++i) {
      result.row(static_cast<Eigen::Index>(i)) -=
          (areas_[i] * (projector(points[i]) * push)).transpose();
    }
    return result;
  }

  /// Makes a field tangential and takes out the Möbius field that moves the centre.
  void keepCentre(const Points3& points, Field& field) const {
    makeTangential(points, field);
    Eigen::Matrix3d overlap = Eigen::Matrix3d::Zero();
    Eigen::Vector3d drift = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      overlap += areas_[i] * projector(points[i]);
      drift += areas_[i] * field.row(static_cast<Eigen::Index>(i)).transpose();
    }
    const Eigen::Vector3d push = overlap.ldlt().solve(drift);
    for (std::size_t i = 0; i < points.size(); ++i) {
      field.row(static_cast<Eigen::Index>(i)) -= (projector(points[i]) * push).transpose();
    }
  }

 private:
  static Eigen::Matrix3d projector(const Eigen::Vector3d& point) {
    return Eigen::Matrix3d::Identity() - point * point.transpose();
  }

  static void makeTangential(const Points3& points, Field& field) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      field.row(row) -= field.row(row).dot(points[i].transpose()) * points[i].transpose();
    }
  }

  std::vector<Edge> edges_;
  const std::vector<double>& areas_;
};

SparseMatrix implicitMatrix(const WeightedSurface& metric, const std::vector<double>& areas,
                            double step) {
  SparseMatrix matrix = step * stiffnessMatrix(metric.surface, metric.weights);
  for (std::size_t v = 0; v < areas.size(); ++v) {
    const auto row = static_cast<Eigen::Index>(v);
    matrix.coeffRef(row, row) += areas[v];
  }
  matrix.makeCompressed();
  return matrix;
}

class HeatFlow {
 public:
  HeatFlow(const WeightedSurface& metric, const std::vector<double>& areas,
           const HeatFlowOptions& options, SpdSolver solver)
      : areas_(areas), options_(options), energy_(metric, areas), solver_(std::move(solver)) {}

  /// From centred points to where the energy falls no further.
  Result<HeatFlowMap> run(Context& context, Points3 start) {
    map_.points = std::move(start);
    map_.energies = {energy_.value(map_.points)};
    const Context::Stage stage(context, "heat flow");
    for (int step = 0; step < options_.max_steps; ++step) {
      const Field gradient = energy_.gradient(map_.points);
      map_.tangent_residual = gradient.rowwise().norm().maxCoeff();
      if (map_.tangent_residual <= options_.tangent_tolerance) return std::move(map_);
      ASSIGN_OR_RETURN(Field direction, solver_.solve(context, -options_.step * gradient));
      energy_.keepCentre(map_.points, direction);
      const double before = map_.energies.back();
      RETURN_IF_ERROR(descend(context, direction));
      if (before - map_.energies.back() <= options_.energy_tolerance * before) {
        return std::move(map_);
      }
    }
    return Status(Reason::kNoConvergence,
                  "the heat flow to the sphere still moves after " +
                      std::to_string(options_.max_steps) + " steps",
                  "use the method robust");
  }

 private:
  /// A full step where it lowers the energy, a shorter one otherwise; none where rounding hides the
  /// slope.
  Status descend(Context& context, const Field& direction) {
    const double before = map_.energies.back();
    for (double t = 1; t > 1e-4; t /= 2) {
      RETURN_IF_ERROR(context.check());
      Points3 moved = map_.points;
      for (std::size_t i = 0; i < moved.size(); ++i) {
        moved[i] += t * direction.row(static_cast<Eigen::Index>(i)).transpose();
        moved[i].normalize();
      }
      Result<MobiusCentering> centered = centerByMobius(context, std::move(moved), areas_);
      RETURN_IF_ERROR(context.check());
      if (!centered.ok()) continue;
      const double energy = energy_.value(centered->points);
      if (!(energy < before)) continue;
      map_.points = std::move(centered->points);
      map_.centering_residual = centered->residual;
      map_.energies.push_back(energy);
      return {};
    }
    return {};
  }

  const std::vector<double>& areas_;
  const HeatFlowOptions& options_;
  DirichletEnergy energy_;
  SpdSolver solver_;
  HeatFlowMap map_;
};

struct Start {
  Points3 points;
  bool from_gauss_map = false;
};

/// The centred Gauss map, if it does not fold.
std::optional<Points3> unfoldedGaussMap(Context& context, const Connectivity& surface,
                                        const std::vector<double>& lengths,
                                        const std::vector<Eigen::Vector3d>& positions,
                                        const std::vector<double>& areas) {
  if (positions.empty()) return std::nullopt;
  Points3 normals = spherical::gaussMap(surface, positions);
  if (measureSphereMap(surface, lengths, normals).flipped_faces > 0) return std::nullopt;
  Result<MobiusCentering> centered = centerByMobius(context, std::move(normals), areas);
  if (!centered.ok()) return std::nullopt;
  return std::move(centered->points);
}

/// The face with the largest area: a limb's tip is a bad place for infinity.
Index polarFace(const Connectivity& surface, const std::vector<double>& lengths) {
  const std::vector<double> areas = faceAreas(surface, unitLengths(lengths));
  return static_cast<Index>(std::max_element(areas.begin(), areas.end()) - areas.begin());
}

Result<Start> startMap(Context& context, const Connectivity& surface,
                       const std::vector<double>& lengths,
                       const std::vector<Eigen::Vector3d>& positions,
                       const std::vector<double>& areas) {
  const Context::Stage stage(context, "start");
  std::optional<Points3> normals = unfoldedGaussMap(context, surface, lengths, positions, areas);
  RETURN_IF_ERROR(context.check());
  if (normals) return Start{std::move(*normals), true};
  ASSIGN_OR_RETURN(Points3 points,
                   spherical::tutteMap(context, surface, areas, polarFace(surface, lengths)));
  return Start{std::move(points), false};
}

Status checkOptions(const Connectivity& surface, const std::vector<Eigen::Vector3d>& positions,
                    const HeatFlowOptions& options) {
  if (!positions.empty() && positions.size() != static_cast<std::size_t>(surface.vertexCount())) {
    return {Reason::kInvalidOption, "there are " + std::to_string(positions.size()) +
                                        " positions for " + std::to_string(surface.vertexCount()) +
                                        " vertices"};
  }
  if (!(options.step > 0) || !std::isfinite(options.step) || !(options.tangent_tolerance >= 0) ||
      !(options.energy_tolerance >= 0) || options.max_steps < 0) {
    return {Reason::kInvalidOption,
            "the heat flow needs a positive step and tolerances that are not negative"};
  }
  return {};
}

}  // namespace

Result<HeatFlowMap> mapToSphereHeatFlow(Context& context, const Connectivity& surface,
                                        const std::vector<double>& lengths,
                                        const std::vector<Eigen::Vector3d>& positions,
                                        const HeatFlowOptions& options) {
  RETURN_IF_ERROR(spherical::checkSphere(surface));
  RETURN_IF_ERROR(checkOptions(surface, positions, options));
  const Context::Stage stage(context, "sphere map");
  const std::vector<double> areas = sphereAreas(surface, lengths);
  ASSIGN_OR_RETURN(Start start, startMap(context, surface, lengths, positions, areas));
  ASSIGN_OR_RETURN(const WeightedSurface metric,
                   spherical::delaunayWeights(context, surface, lengths));
  ASSIGN_OR_RETURN(SpdSolver solver,
                   SpdSolver::make(context, implicitMatrix(metric, areas, options.step)));
  HeatFlow flow(metric, areas, options, std::move(solver));
  ASSIGN_OR_RETURN(HeatFlowMap map, flow.run(context, std::move(start.points)));
  map.from_gauss_map = start.from_gauss_map;
  map.flips = metric.flips;
  map.quality = measureSphereMap(surface, lengths, map.points);
  if (map.quality.flipped_faces > 0 && !options.accept_folds) {
    return Status(Reason::kFoldedMap,
                  "the harmonic map to the sphere folds " +
                      std::to_string(map.quality.flipped_faces) + " of " +
                      std::to_string(surface.faceCount()) + " faces",
                  "use the method robust");
  }
  return map;
}

}  // namespace moduli
