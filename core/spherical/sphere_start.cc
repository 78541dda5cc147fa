#include "core/spherical/sphere_start.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <utility>

#include "core/forms/cotan.h"
#include "core/linalg/spd_solver.h"
#include "core/spherical/plane_lift.h"
#include "core/topology/surface_topology.h"

namespace moduli::spherical {
namespace {

/// Stiffness of unit weights with the rows of three vertices replaced by those of the identity, and
/// what the three, held at the corners of a triangle, pull at the others.
struct TutteSystem {
  SparseMatrix matrix;
  Eigen::MatrixXd right;
};

TutteSystem tutteSystem(const Connectivity& surface, const Triangle& held) {
  const Index count = surface.vertexCount();
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, 2);
  std::vector<bool> is_held(count, false);
  for (int c = 0; c < 3; ++c) {
    is_held[held[c]] = true;
    // Counter-clockwise: the other faces, inside, run clockwise, and the lift turns them over.
    const double angle = 2 * std::numbers::pi * c / 3;
    right.row(held[c]) << std::cos(angle), std::sin(angle);
  }
  std::vector<double> diagonal(count, 0.0);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    const Index a = std::max(surface.tail(h), surface.head(h));
    const Index b = std::min(surface.tail(h), surface.head(h));
    if (a == b) continue;
    if (!is_held[a]) diagonal[a] += 1;
    if (!is_held[b]) diagonal[b] += 1;
    if (!is_held[a] && !is_held[b]) entries.emplace_back(a, b, -1.0);
    if (is_held[a] && !is_held[b]) right.row(b) += right.row(a);
    if (is_held[b] && !is_held[a]) right.row(a) += right.row(b);
  }
  for (Index v = 0; v < count; ++v) entries.emplace_back(v, v, is_held[v] ? 1.0 : diagonal[v]);
  TutteSystem system{SparseMatrix(count, count), std::move(right)};
  system.matrix.setFromTriplets(entries.begin(), entries.end());
  return system;
}

}  // namespace

Status checkSphere(const Connectivity& surface) {
  const SurfaceTopology topology = computeTopology(surface);
  if (topology.components == 1 && topology.genus == 0 && topology.boundary_loops.empty()) {
    return {};
  }
  return {Reason::kUnsupportedTopology,
          "the map to the sphere needs a closed connected surface of genus 0, not genus " +
              std::to_string(topology.genus) + " with " +
              std::to_string(topology.boundary_loops.size()) + " boundary loops in " +
              std::to_string(topology.components) + " component(s)"};
}

Points3 gaussMap(const Connectivity& surface, const std::vector<Eigen::Vector3d>& positions) {
  Points3 normals(surface.vertexCount(), Eigen::Vector3d::Zero());
  for (const auto& [a, b, c] : surface.faces()) {
    const Eigen::Vector3d normal = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    for (const Index v : {a, b, c}) normals[v] += normal;
  }
  for (Eigen::Vector3d& normal : normals) normal /= normal.stableNorm();
  return normals;
}

Result<Points3> tutteMap(Context& context, const Connectivity& surface,
                         const std::vector<double>& areas, Index pole) {
  const TutteSystem system = tutteSystem(surface, surface.face(pole));
  ASSIGN_OR_RETURN(const SpdSolver solver, SpdSolver::make(context, system.matrix));
  ASSIGN_OR_RETURN(const Eigen::MatrixXd x, solver.solve(context, system.right));
  PlanePoints z(surface.vertexCount());
  for (Index v = 0; v < surface.vertexCount(); ++v) z[v] = {x(v, 0), x(v, 1)};
  ASSIGN_OR_RETURN(MobiusCentering centered,
                   centerByMobius(context, balancedLift(z, areas), areas));
  return std::move(centered.points);
}

}  // namespace moduli::spherical
