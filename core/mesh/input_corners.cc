#include "core/mesh/input_corners.h"

namespace moduli {
namespace {

// Repair turns a face by swapping its last two corners, and moves a corner only to a vertex at the
// same place. Where both corners are at one place they were not welded and kept their vertices.
bool isTurned(const TriangleSoup& soup, const PreparedMesh& prepared, Index f) {
  const Triangle& before = soup.faces[prepared.input_face[f]];
  const Triangle& after = prepared.mesh.connectivity().face(f);
  const Eigen::Vector3d& second = soup.vertices[before[1]];
  if (second == soup.vertices[before[2]]) return prepared.input_vertex[after[1]] != before[1];
  return prepared.mesh.positions()[after[1]] != second;
}

}  // namespace

std::vector<Index> inputCorners(const TriangleSoup& soup, const PreparedMesh& prepared) {
  const Index faces = prepared.mesh.faceCount();
  std::vector<Index> corners(3 * static_cast<std::size_t>(faces), kNone);
  for (Index f = 0; f < faces; ++f) {
    const Index g = prepared.input_face[f];
    if (g == kNone) continue;
    const bool turned = isTurned(soup, prepared, f);
    corners[3 * f] = 3 * g;
    corners[3 * f + 1] = 3 * g + (turned ? 2 : 1);
    corners[3 * f + 2] = 3 * g + (turned ? 1 : 2);
  }
  return corners;
}

VertexPlaces findVertexPlaces(const TriangleSoup& soup, const PreparedMesh& prepared,
                              const std::vector<Index>& corners) {
  VertexPlaces places;
  places.place.assign(soup.vertices.size(), kNone);
  places.used.assign(soup.vertices.size(), false);
  for (const Triangle& face : soup.faces) {
    for (const Index v : face) places.used[v] = true;
  }
  for (Index h = 0; h < static_cast<Index>(corners.size()); ++h) {
    if (corners[h] == kNone) continue;
    Index& place = places.place[soup.faces[corners[h] / 3][corners[h] % 3]];
    const Index here = prepared.mesh.connectivity().tail(h);
    place = place == kNone || place == here ? here : VertexPlaces::kSeveral;
  }
  return places;
}

}  // namespace moduli
