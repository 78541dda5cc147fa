#include "core/spherical/linear_map.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace moduli::spherical {
namespace {

constexpr Index kPinned = 0;

/// Corners of a face in its frame.
std::array<Eigen::Vector2d, 3> frameCorners(const FaceFrame& frame) {
  return {Eigen::Vector2d(0, 0), Eigen::Vector2d(frame.base, 0), Eigen::Vector2d(frame.x, frame.y)};
}

/// Right-hand side of the dipole: the gradients of the three hat functions on the pole's face.
Eigen::MatrixXd dipoleSource(const Connectivity& surface, const FaceFrame& frame, Index pole) {
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(surface.vertexCount() - 1, 2);
  const auto corner = frameCorners(frame);
  for (int c = 0; c < 3; ++c) {
    const Index v = surface.face(pole)[c];
    if (v == kPinned) continue;
    const Eigen::Vector2d opposite = corner[(c + 2) % 3] - corner[(c + 1) % 3];
    const double scale = 1 / (2 * frame.area());
    // The opposite edge turned by +90 degrees points to the corner.
    b(v - (v > kPinned ? 1 : 0), 0) = -opposite.y() * scale;
    b(v - (v > kPinned ? 1 : 0), 1) = opposite.x() * scale;
  }
  return b;
}

/// Jacobian of the affine map from a face's frame to its plane image.
Eigen::Matrix2d jacobian(const FaceFrame& frame, const std::complex<double>& z0,
                         const std::complex<double>& z1, const std::complex<double>& z2) {
  const std::complex<double> along = (z1 - z0) / frame.base;
  const std::complex<double> across = ((z2 - z0) - frame.x * along) / frame.y;
  Eigen::Matrix2d j;
  j << along.real(), across.real(), along.imag(), across.imag();
  return j;
}

/// Takes the mean dilatation out of a plane map. The unit-determinant metrics that the faces bring
/// to the plane are points of the hyperbolic plane; their centre (the normalized mean, weighted by
/// area) is the constant metric in which the map is conformal in the mean.
void removeMeanDilatation(const Connectivity& surface, const std::vector<FaceFrame>& frames,
                          PlanePoints& z) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto& [a, b, c] = surface.face(f);
    const Eigen::Matrix2d j = jacobian(frames[f], z[a], z[b], z[c]);
    const double det = std::abs(j.determinant());
    const Eigen::Matrix2d cofactor =
        (Eigen::Matrix2d() << j(1, 1), -j(0, 1), -j(1, 0), j(0, 0)).finished();
    // (J J^T)^{-1} |det J| = C^T C / |det J| with the cofactor matrix C.
    const Eigen::Matrix2d metric = cofactor.transpose() * cofactor / det;
    if (metric.allFinite()) sum += frames[f].area() * metric;
  }
  const double det = sum.determinant();
  if (!(det > 0)) return;
  sum /= std::sqrt(det);
  // Square root of a unit-determinant positive matrix, by Cayley and Hamilton.
  const Eigen::Matrix2d root = (sum + Eigen::Matrix2d::Identity()) / std::sqrt(sum.trace() + 2);
  for (std::complex<double>& value : z) {
    const Eigen::Vector2d image = root * Eigen::Vector2d(value.real(), value.imag());
    value = {image.x(), image.y()};
  }
}

}  // namespace

Result<DipoleMap> DipoleMap::make(Context& context, const Connectivity& surface,
                                  const std::vector<double>& lengths) {
  const std::vector<double> areas = faceAreas(surface, lengths);
  std::vector<FaceFrame> frames(surface.faceCount());
  for (Index f = 0; f < surface.faceCount(); ++f) {
    frames[f] = frameFromSides(lengths[surface.edge(3 * f)], lengths[surface.edge(3 * f + 1)],
                               lengths[surface.edge(3 * f + 2)], areas[f]);
  }
  std::vector<double> weights = cotanWeights(surface, lengths);
  ASSIGN_OR_RETURN(SpdSolver solver,
                   SpdSolver::make(context, pinnedStiffness(surface, weights, kPinned)));
  return DipoleMap(surface, std::move(frames), std::move(weights), std::move(solver));
}

Result<PlanePoints> DipoleMap::solve(Context& context, Index pole) const {
  ASSIGN_OR_RETURN(const Eigen::MatrixXd x,
                   solver_.solve(context, dipoleSource(surface_, frames_[pole], pole)));
  PlanePoints z(surface_.vertexCount(), 0.0);
  for (Index v = 0; v < surface_.vertexCount(); ++v) {
    if (v == kPinned) continue;
    const Index row = v - (v > kPinned ? 1 : 0);
    z[v] = {x(row, 0), x(row, 1)};
  }
  removeMeanDilatation(surface_, frames_, z);
  return z;
}

Index largestFace(const std::vector<FaceFrame>& frames) {
  const auto score = [](const FaceFrame& frame) { return frame.area() * frame.quality(); };
  const auto best =
      std::max_element(frames.begin(), frames.end(),
                       [&](const FaceFrame& a, const FaceFrame& b) { return score(a) < score(b); });
  return static_cast<Index>(best - frames.begin());
}

Index centralFace(const Connectivity& surface, const std::vector<FaceFrame>& frames,
                  const Points3& points) {
  Index best = 0;
  double best_score = -1;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto& [a, b, c] = surface.face(f);
    const double image = (points[b] - points[a]).cross(points[c] - points[a]).norm();
    const double quality = frames[f].quality();
    const double score = image / frames[f].area() * quality * quality;
    if (score > best_score) {
      best_score = score;
      best = f;
    }
  }
  return best;
}

namespace {

/// Stereographic projection from -axes[2] to the plane of the other two axes.
Eigen::Vector2d project(const std::array<Eigen::Vector3d, 3>& axes, const Eigen::Vector3d& point) {
  // 1 + p.n, without cancellation near the centre of projection.
  const double denominator = 0.5 * (point + axes[2]).squaredNorm();
  return Eigen::Vector2d(point.dot(axes[0]), point.dot(axes[1])) / denominator;
}

}  // namespace

Result<ChartRelaxation> ChartRelaxation::make(Context& context, const Connectivity& surface,
                                              const std::vector<double>& weights,
                                              const Points3& points, const Eigen::Vector3d& pole,
                                              double reach) {
  const Eigen::Vector3d helper =
      std::abs(pole.x()) < 0.6 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d axis = pole.cross(helper).normalized();
  const std::array<Eigen::Vector3d, 3> axes = {axis, pole.cross(axis), pole};

  std::vector<Index> row(surface.vertexCount(), kNone);
  std::vector<Index> moving;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (project(axes, points[v]).norm() < reach) {
      row[v] = static_cast<Index>(moving.size());
      moving.push_back(v);
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> diagonal(moving.size(), 0.0);
  std::vector<Pull> pulls;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    const std::array<Index, 2> end = {surface.tail(h), surface.head(h)};
    const std::array<Index, 2> r = {row[end[0]], row[end[1]]};
    for (int side = 0; side < 2; ++side) {
      if (r[side] == kNone) continue;
      diagonal[r[side]] += weights[e];
      if (r[1 - side] == kNone) pulls.push_back({r[side], end[1 - side], weights[e]});
    }
    if (r[0] != kNone && r[1] != kNone) {
      entries.emplace_back(std::max(r[0], r[1]), std::min(r[0], r[1]), -weights[e]);
    }
  }
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    entries.emplace_back(static_cast<int>(i), static_cast<int>(i), diagonal[i]);
  }
  SparseMatrix matrix(static_cast<int>(moving.size()), static_cast<int>(moving.size()));
  matrix.setFromTriplets(entries.begin(), entries.end());
  ASSIGN_OR_RETURN(SpdSolver solver, SpdSolver::make(context, matrix));
  const std::size_t held_count = row.size() - moving.size();
  return ChartRelaxation(axes, std::move(moving), held_count, std::move(pulls), std::move(solver));
}

Result<Points3> ChartRelaxation::relax(Context& context, Points3 points) const {
  const Context::Stage stage(context, "relax");
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(moving_.size()), 2);
  for (const Pull& pull : pulls_) {
    b.row(pull.row) += pull.weight * project(axes_, points[pull.held]).transpose();
  }
  ASSIGN_OR_RETURN(const Eigen::MatrixXd x, solver_.solve(context, b));
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    const double u = x(static_cast<Eigen::Index>(i), 0);
    const double v = x(static_cast<Eigen::Index>(i), 1);
    const double r2 = u * u + v * v;
    points[moving_[i]] =
        ((2 * u * axes_[0] + 2 * v * axes_[1] + (1 - r2) * axes_[2]) / (1 + r2)).normalized();
  }
  return points;
}

}  // namespace moduli::spherical
