#include "core/signature/mean_curvature.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "core/mesh/triangle_geometry.h"

namespace moduli {
namespace {

/// Sine of a dihedral angle that rounding cannot tell from a multiple of pi.
constexpr double kFlatSine = 1e-12;

std::array<Eigen::Vector3d, 3> corners(const TriangleMesh& mesh, Index f) {
  const auto& [a, b, c] = mesh.connectivity().face(f);
  return {mesh.positions()[a], mesh.positions()[b], mesh.positions()[c]};
}

/// Unit normals; zero vectors for faces without area.
std::vector<Eigen::Vector3d> properNormals(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> normals(mesh.faceCount(), Eigen::Vector3d::Zero());
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    const auto [a, b, c] = corners(mesh, f);
    if (triangleShape(a, b, c).relative_area <= kZeroRelativeArea) continue;
    normals[f] = (b - a).stableNormalized().cross((c - a).stableNormalized()).normalized();
  }
  return normals;
}

Index longestHalfedge(const TriangleMesh& mesh, Index f) {
  const auto corner = corners(mesh, f);
  Index best = 0;
  double longest = -1;
  for (Index c = 0; c < 3; ++c) {
    const double length = (corner[(c + 1) % 3] - corner[c]).stableNorm();
    if (length > longest) {
      longest = length;
      best = c;
    }
  }
  return 3 * f + best;
}

/// Gives faces without area the normal across their longest edge, through chains of such faces.
/// Where a chain ends in itself or at the boundary the normal stays zero.
void borrowNormals(const TriangleMesh& mesh, std::vector<Eigen::Vector3d>& normals) {
  const Connectivity& surface = mesh.connectivity();
  std::vector<Index> bare;
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    if (normals[f].isZero(0)) bare.push_back(f);
  }
  for (bool changed = true; changed && !bare.empty();) {
    changed = false;
    std::vector<Index> still_bare;
    for (const Index f : bare) {
      const Index twin = surface.twin(longestHalfedge(mesh, f));
      if (twin != kNone && !normals[Connectivity::faceOf(twin)].isZero(0)) {
        normals[f] = normals[Connectivity::faceOf(twin)];
        changed = true;
      } else {
        still_bare.push_back(f);
      }
    }
    bare = std::move(still_bare);
  }
}

/// Angle from one face's normal to the next one's about their common edge, in (-pi, pi].
double dihedralAngle(const Eigen::Vector3d& edge, const Eigen::Vector3d& left,
                     const Eigen::Vector3d& right) {
  if (left.isZero(0) || right.isZero(0)) return 0;
  const double sine = edge.stableNormalized().dot(left.cross(right));
  const double cosine = left.dot(right);
  if (cosine < 0 && std::abs(sine) < kFlatSine) return std::numbers::pi;
  return std::atan2(sine, cosine);
}

}  // namespace

std::vector<double> integratedMeanCurvature(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> normals = properNormals(mesh);
  borrowNormals(mesh, normals);

  const Connectivity& surface = mesh.connectivity();
  std::vector<double> curvature(mesh.vertexCount(), 0.0);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (surface.isBoundaryEdge(e)) continue;
    const Index h = surface.halfedge(e);
    const Index tail = surface.tail(h);
    const Index head = surface.head(h);
    const Eigen::Vector3d edge = mesh.positions()[head] - mesh.positions()[tail];
    const double angle = dihedralAngle(edge, normals[Connectivity::faceOf(h)],
                                       normals[Connectivity::faceOf(surface.twin(h))]);
    const double share = 0.25 * edge.stableNorm() * angle;
    curvature[tail] += share;
    curvature[head] += share;
  }
  return curvature;
}

}  // namespace moduli
