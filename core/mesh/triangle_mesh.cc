#include "core/mesh/triangle_mesh.h"

#include <numeric>
#include <string>
#include <utility>

#include "core/mesh/triangle_geometry.h"

namespace moduli {

Result<TriangleMesh> TriangleMesh::fromSoup(TriangleSoup soup) {
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    if (soup.vertices[v].allFinite()) continue;
    return Status(Reason::kNonFiniteCoordinate,
                  "vertex " + std::to_string(v) + " has a coordinate that is no finite number");
  }
  ASSIGN_OR_RETURN(
      Connectivity connectivity,
      Connectivity::fromFaces(static_cast<Index>(soup.vertices.size()), std::move(soup.faces)));
  return TriangleMesh(std::move(connectivity), std::move(soup.vertices));
}

std::vector<double> TriangleMesh::edgeLengths() const {
  std::vector<double> lengths(connectivity_.edgeCount());
  for (Index e = 0; e < connectivity_.edgeCount(); ++e) {
    const Index h = connectivity_.halfedge(e);
    const Eigen::Vector3d d = positions_[connectivity_.head(h)] - positions_[connectivity_.tail(h)];
    lengths[e] = d.stableNorm();
  }
  return lengths;
}

std::vector<double> TriangleMesh::faceAreas() const {
  std::vector<double> areas(faceCount());
  for (Index f = 0; f < faceCount(); ++f) {
    const Triangle& face = connectivity_.face(f);
    areas[f] = triangleShape(positions_[face[0]], positions_[face[1]], positions_[face[2]]).area;
  }
  return areas;
}

double TriangleMesh::area() const {
  const std::vector<double> areas = faceAreas();
  return std::accumulate(areas.begin(), areas.end(), 0.0);
}

}  // namespace moduli
