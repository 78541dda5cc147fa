#include "core/matching/border_places.h"

#include <utility>

#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// Weights below are none.
constexpr double kNothing = 1e-12;

}  // namespace

std::optional<BorderPoint> borderPointAt(const Connectivity& surface, const SurfacePoint& point) {
  for (int c = 0; c < 3; ++c) {
    const Index v = surface.face(point.face)[c];
    if (point.barycentric[c] >= 1 - kNothing && surface.isBoundaryVertex(v)) {
      return BorderPoint{surface.outgoing(v), 0};
    }
  }
  for (int c = 0; c < 3; ++c) {
    const Index h = 3 * point.face + c;
    const double tail = point.barycentric[c], head = point.barycentric[(c + 1) % 3];
    if (surface.twin(h) != kNone || point.barycentric[(c + 2) % 3] > kNothing) continue;
    return BorderPoint{h, head / (tail + head)};
  }
  return {};
}

BorderPlaces::BorderPlaces(const TriangleMesh& mesh)
    : loops_(computeTopology(mesh.connectivity()).boundary_loops),
      loop_(mesh.connectivity().halfedgeCount(), kNone),
      number_(loop_),
      starts_(loop_.size(), 0.0),
      edges_(loop_.size(), 0.0) {
  const std::vector<double> edges = mesh.edgeLengths();
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    double length = 0;
    for (std::size_t n = 0; n < loops_[i].size(); ++n) {
      const Index h = loops_[i][n];
      loop_[h] = static_cast<Index>(i);
      number_[h] = static_cast<Index>(n);
      starts_[h] = length;
      edges_[h] = edges[mesh.connectivity().edge(h)];
      length += edges_[h];
    }
    lengths_.push_back(length);
  }
}

double BorderPlaces::shareAt(const BorderPoint& point) const {
  const double along = starts_[point.halfedge] + point.t * edges_[point.halfedge];
  const double share = along / lengths_[loop_[point.halfedge]];
  return share < 1 ? share : 0;
}

}  // namespace moduli
