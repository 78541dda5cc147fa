#include "core/topology/surface_topology.h"

#include <utility>

namespace moduli {
namespace {

void labelComponents(const Connectivity& surface, SurfaceTopology& topology) {
  topology.component.assign(surface.faceCount(), kNone);
  std::vector<Index> open;
  for (Index seed = 0; seed < surface.faceCount(); ++seed) {
    if (topology.component[seed] != kNone) continue;
    topology.component[seed] = topology.components;
    open.push_back(seed);
    while (!open.empty()) {
      const Index f = open.back();
      open.pop_back();
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        if (surface.twin(h) == kNone) continue;
        const Index neighbour = Connectivity::faceOf(surface.twin(h));
        if (topology.component[neighbour] != kNone) continue;
        topology.component[neighbour] = topology.components;
        open.push_back(neighbour);
      }
    }
    ++topology.components;
  }
}

// At a boundary vertex outgoing() is the one boundary halfedge that leaves it.
std::vector<std::vector<Index>> traceBoundary(const Connectivity& surface) {
  std::vector<std::vector<Index>> loops;
  std::vector<bool> traced(surface.halfedgeCount(), false);
  for (Index start = 0; start < surface.halfedgeCount(); ++start) {
    if (surface.twin(start) != kNone || traced[start]) continue;
    std::vector<Index> loop;
    for (Index h = start; !traced[h]; h = surface.outgoing(surface.head(h))) {
      traced[h] = true;
      loop.push_back(h);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace

SurfaceTopology computeTopology(const Connectivity& surface) {
  SurfaceTopology topology;
  labelComponents(surface, topology);
  topology.boundary_loops = traceBoundary(surface);
  topology.euler_characteristic = surface.eulerCharacteristic();
  const auto loops = static_cast<Index>(topology.boundary_loops.size());
  topology.genus = (2 * topology.components - loops - topology.euler_characteristic) / 2;
  return topology;
}

}  // namespace moduli
