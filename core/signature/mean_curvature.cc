#include "core/signature/mean_curvature.h"

#include "core/signature/edge_bending.h"

namespace moduli {

std::vector<double> integratedMeanCurvature(const TriangleMesh& mesh) {
  const Connectivity& surface = mesh.connectivity();
  const EdgeBending bending = edgeBending(surface, mesh.positions());
  std::vector<double> curvature(mesh.vertexCount(), 0.0);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (surface.isBoundaryEdge(e)) continue;
    const Index tail = surface.tail(surface.halfedge(e));
    const Index head = surface.head(surface.halfedge(e));
    const Eigen::Vector3d edge = mesh.positions()[head] - mesh.positions()[tail];
    const double share = 0.25 * edge.stableNorm() * bending.angles[e];
    curvature[tail] += share;
    curvature[head] += share;
  }
  return curvature;
}

}  // namespace moduli
