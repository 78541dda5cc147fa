#include "core/signature/curvature_fields.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/forms/cotan.h"
#include "core/intrinsic/refine.h"
#include "core/linalg/spd_solver.h"
#include "core/signature/edge_bending.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRingWidth = 0.5;
/// Cutting needles costs no more than meshes of this size do.
constexpr Index kMostAdded = 40000;

using Positions = std::vector<Eigen::Vector3d>;

/// Of each vertex cell the integrals of the tensor (xx, yy, zz, yz, zx, xy), of the normal (x, y,
/// z) and of 1.
Eigen::MatrixXd cellIntegrals(const Connectivity& surface, const Positions& positions) {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(surface.vertexCount(), 10);
  const EdgeBending bending = edgeBending(surface, positions);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    const Index tail = surface.tail(h), head = surface.head(h);
    const Eigen::Vector3d edge = positions[head] - positions[tail];
    const double length = edge.norm();
    if (!(length > 0)) continue;
    const Eigen::Vector3d d = edge / length;
    Eigen::Matrix<double, 1, 6> tensor;
    tensor << d.x() * d.x(), d.y() * d.y(), d.z() * d.z(), d.y() * d.z(), d.z() * d.x(),
        d.x() * d.y();
    tensor *= length * bending.angles[e] / 2;
    sums.row(tail).head<6>() += tensor;
    sums.row(head).head<6>() += tensor;
  }
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto& [a, b, c] = surface.face(f);
    const double area = (positions[b] - positions[a]).cross(positions[c] - positions[a]).norm() / 2;
    for (const Index v : surface.face(f)) {
      sums.row(v).segment<3>(6) += area / 3 * bending.normals[f].transpose();
      sums(v, 9) += area / 3;
    }
  }
  return sums;
}

/// Eigenvalues of a tensor restricted to the plane across a normal, the larger first.
std::array<double, 2> acrossNormal(const Eigen::Matrix<double, 1, 10>& row) {
  Eigen::Matrix3d tensor;
  tensor << row[0], row[5], row[4], row[5], row[1], row[3], row[4], row[3], row[2];
  const Eigen::Vector3d normal = row.segment<3>(6).transpose();
  if (!(normal.squaredNorm() > 0)) return {0, 0};
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.normalized().cross(u);
  const double uu = u.dot(tensor * u), vv = v.dot(tensor * v), uv = u.dot(tensor * v);
  const double middle = (uu + vv) / 2;
  const double spread = std::hypot((uu - vv) / 2, uv);
  return {middle + spread, middle - spread};
}

/// From the first vertex, in units of the radius.
Eigen::MatrixXd scaledPositions(const Positions& positions, double radius) {
  Eigen::MatrixXd scaled(positions.size(), 3);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    scaled.row(static_cast<Eigen::Index>(v)) = (positions[v] - positions[0]).transpose() / radius;
  }
  return scaled;
}

/// With edges no longer than the least length over which the flow smooths.
Result<RefinedMesh> refineForFlow(Context& context, const TriangleMesh& mesh,
                                  const std::vector<double>& lengths) {
  const std::vector<double> areas = faceAreas(mesh.connectivity(), lengths);
  const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
  RefineOptions options;
  options.longest = std::sqrt(2 * kSmoothingTimes.front() * area);
  options.most_added = kMostAdded;
  return refineInSpace(context, {mesh.connectivity(), lengths, mesh.positions()}, options);
}

/// solver: of M + t L; mass: the diagonal of M.
Result<SmoothedCurvatures> curvaturesOf(Context& context, const Connectivity& surface,
                                        const SpdSolver& solver, const Eigen::VectorXd& mass,
                                        const Eigen::MatrixXd& positions) {
  ASSIGN_OR_RETURN(const Eigen::MatrixXd moved,
                   solver.solve(context, mass.asDiagonal() * positions));
  Positions smooth(surface.vertexCount());
  for (Index v = 0; v < surface.vertexCount(); ++v) smooth[v] = moved.row(v).transpose();
  const Eigen::MatrixXd cells = cellIntegrals(surface, smooth);
  ASSIGN_OR_RETURN(const Eigen::MatrixXd spread, solver.solve(context, cells));
  SmoothedCurvatures curvatures;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    // A cell without area has no curvature, and no weight either.
    const double area = spread(v, 9);
    const auto [first, second] = acrossNormal(spread.row(v));
    curvatures.first.push_back(area > 0 ? first / area : 0);
    curvatures.second.push_back(area > 0 ? second / area : 0);
    curvatures.areas.push_back(cells(v, 9));
  }
  const double total = cells.col(9).sum();
  for (double& area : curvatures.areas) area /= total;
  return curvatures;
}

}  // namespace

Result<std::vector<SmoothedCurvatures>> smoothedCurvatures(Context& context,
                                                           const TriangleMesh& mesh,
                                                           const std::vector<double>& lengths,
                                                           double radius) {
  ASSIGN_OR_RETURN(const RefinedMesh fine, refineForFlow(context, mesh, lengths));
  const Connectivity& surface = fine.surface;
  const std::vector<double> areas = vertexAreas(surface, fine.lengths);
  Eigen::VectorXd mass =
      Eigen::Map<const Eigen::VectorXd>(areas.data(), static_cast<Eigen::Index>(areas.size()));
  mass /= mass.sum();
  const Eigen::MatrixXd positions = scaledPositions(fine.positions, radius);
  const SparseMatrix stiffness = stiffnessMatrix(surface, cotanWeights(surface, fine.lengths));
  std::vector<SmoothedCurvatures> result;
  std::optional<SpdSolver> solver;
  for (const double time : kSmoothingTimes) {
    SparseMatrix matrix = time * stiffness;
    for (Index v = 0; v < surface.vertexCount(); ++v) matrix.coeffRef(v, v) += mass[v];
    matrix.makeCompressed();
    if (solver) {
      RETURN_IF_ERROR(solver->refactorize(context, matrix));
    } else {
      ASSIGN_OR_RETURN(solver, SpdSolver::make(context, matrix));
    }
    const Context::Stage stage(context, "curvature");
    ASSIGN_OR_RETURN(SmoothedCurvatures curvatures,
                     curvaturesOf(context, surface, *solver, mass, positions));
    result.push_back(std::move(curvatures));
  }
  return result;
}

std::vector<double> shapeIndexHistogram(const SmoothedCurvatures& curvatures) {
  std::vector<double> bins(kShapeIndexBins, 0.0);
  for (std::size_t v = 0; v < curvatures.areas.size(); ++v) {
    const double mean = (curvatures.first[v] + curvatures.second[v]) / 2;
    const double half = (curvatures.first[v] - curvatures.second[v]) / 2;
    const double curvedness = std::hypot(mean, half);
    const double ring = std::min<double>(std::log1p(curvedness) / kRingWidth, kCurvednessRings);
    const double index = (std::atan2(mean, half) / (kPi / 2) + 1) * 2;  // 0 .. 4
    const int low_ring = std::min(static_cast<int>(ring), kCurvednessRings - 1);
    const int low_index = std::min(static_cast<int>(index), 3);
    for (int i = 0; i < 2; ++i) {
      const double share = curvatures.areas[v] * (i == 0 ? low_ring + 1 - ring : ring - low_ring);
      if (low_ring + i == 0) {
        bins[0] += share;
        continue;
      }
      const int first = 1 + 5 * (low_ring + i - 1) + low_index;
      bins[first] += share * (low_index + 1 - index);
      bins[first + 1] += share * (index - low_index);
    }
  }
  return bins;
}

}  // namespace moduli
