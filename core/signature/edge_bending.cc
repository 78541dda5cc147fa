#include "core/signature/edge_bending.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "core/mesh/triangle_geometry.h"

namespace moduli {
namespace {

using Positions = std::vector<Eigen::Vector3d>;

/// Sine of a dihedral angle that rounding cannot tell from a multiple of pi.
constexpr double kFlatSine = 1e-12;

std::array<Eigen::Vector3d, 3> corners(const Connectivity& surface, const Positions& positions,
                                       Index f) {
  const auto& [a, b, c] = surface.face(f);
  return {positions[a], positions[b], positions[c]};
}

/// Unit normals; zero vectors for faces without area.
std::vector<Eigen::Vector3d> properNormals(const Connectivity& surface,
                                           const Positions& positions) {
  std::vector<Eigen::Vector3d> normals(surface.faceCount(), Eigen::Vector3d::Zero());
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto [a, b, c] = corners(surface, positions, f);
    if (triangleShape(a, b, c).relative_area <= kZeroRelativeArea) continue;
    normals[f] = (b - a).stableNormalized().cross((c - a).stableNormalized()).normalized();
  }
  return normals;
}

Index longestHalfedge(const Connectivity& surface, const Positions& positions, Index f) {
  const auto corner = corners(surface, positions, f);
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
void borrowNormals(const Connectivity& surface, const Positions& positions,
                   std::vector<Eigen::Vector3d>& normals) {
  std::vector<Index> bare;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    if (normals[f].isZero(0)) bare.push_back(f);
  }
  for (bool changed = true; changed && !bare.empty();) {
    changed = false;
    std::vector<Index> still_bare;
    for (const Index f : bare) {
      const Index twin = surface.twin(longestHalfedge(surface, positions, f));
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

EdgeBending edgeBending(const Connectivity& surface, const Positions& positions) {
  EdgeBending bending{properNormals(surface, positions), {}};
  borrowNormals(surface, positions, bending.normals);
  bending.angles.assign(surface.edgeCount(), 0.0);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (surface.isBoundaryEdge(e)) continue;
    const Index h = surface.halfedge(e);
    const Eigen::Vector3d edge = positions[surface.head(h)] - positions[surface.tail(h)];
    bending.angles[e] = dihedralAngle(edge, bending.normals[Connectivity::faceOf(h)],
                                      bending.normals[Connectivity::faceOf(surface.twin(h))]);
  }
  return bending;
}

}  // namespace moduli
