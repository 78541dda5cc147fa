#include "core/intrinsic/intrinsic_surface.h"

#include <algorithm>
#include <limits>

#include "core/topology/surface_topology.h"

namespace moduli {

IntrinsicSurface forgetPositions(const TriangleMesh& mesh) {
  return {mesh.connectivity(), mesh.edgeLengths(), Geometry::kEuclidean};
}

double surfaceArea(const IntrinsicSurface& surface) {
  double area = 0;
  for (Index f = 0; f < surface.connectivity.faceCount(); ++f) {
    area += triangleArea(surface.geometry, surface.sides(f));
  }
  return area;
}

Inspection inspectSurface(const IntrinsicSurface& surface) {
  const SurfaceTopology topology = computeTopology(surface.connectivity);
  Inspection inspection;
  inspection.valid = true;
  SurfaceCounts& counts = inspection.counts;
  counts.vertices = surface.connectivity.vertexCount();
  counts.faces = surface.connectivity.faceCount();
  counts.components = topology.components;
  counts.boundary_loops = static_cast<Index>(topology.boundary_loops.size());
  counts.euler_characteristic = topology.euler_characteristic;
  counts.orientable = true;
  counts.genus = topology.genus;
  counts.area = std::min(surfaceArea(surface), std::numeric_limits<double>::max());
  return inspection;
}

}  // namespace moduli
