#include "core/parameterize/layout_measures.h"

#include <algorithm>
#include <cmath>

#include "core/intrinsic/geometry.h"
#include "core/mesh/disjoint_sets.h"

namespace moduli {
namespace {

/// The faces that are returned.
struct Faces {
  const Connectivity& surface;
  const std::vector<double>& lengths;
  const std::vector<bool>& left_out;  ///< Or empty.

  bool counts(Index f) const { return left_out.empty() || !left_out[f]; }
};

double areaOf(const Faces& faces) {
  double area = 0;
  for (Index f = 0; f < faces.surface.faceCount(); ++f) {
    if (!faces.counts(f)) continue;
    const auto side = [&](Index c) { return faces.lengths[faces.surface.edge(3 * f + c)]; };
    area += triangleArea(Geometry::kEuclidean, {side(0), side(1), side(2)});
  }
  return area;
}

double seamLength(const Faces& faces, const std::vector<Index>& corner) {
  double length = 0;
  for (Index e = 0; e < faces.surface.edgeCount(); ++e) {
    const Index h = faces.surface.halfedge(e), twin = faces.surface.twin(h);
    if (twin == kNone || !faces.counts(h / 3) || !faces.counts(twin / 3)) continue;
    const bool whole = corner[h] == corner[Connectivity::next(twin)] &&
                       corner[Connectivity::next(h)] == corner[twin];
    if (!whole) length += faces.lengths[e];
  }
  return length;
}

Index countIslands(const Faces& faces, const std::vector<Index>& corner, Index points) {
  DisjointSets sets(points);
  std::vector<bool> used(points, false);
  for (Index h = 0; h < faces.surface.halfedgeCount(); ++h) {
    if (!faces.counts(h / 3)) continue;
    sets.join(corner[h], corner[Connectivity::next(h)]);
    used[corner[h]] = true;
  }
  Index islands = 0;
  for (Index i = 0; i < points; ++i) islands += used[i] && sets.root(i) == i ? 1 : 0;
  return islands;
}

LayoutMeasures measure(const Faces& faces, const Parameterization& map) {
  LayoutMeasures measures;
  for (Index f = 0; f < faces.surface.faceCount(); ++f) {
    measures.mapped_faces += faces.counts(f) ? 1 : 0;
  }
  if (!map.sphere.empty()) {
    measures.islands = 1;
    return measures;
  }
  measures.islands = countIslands(faces, map.corner, static_cast<Index>(map.points.size()));
  const double area = areaOf(faces);
  if (area > 0) measures.seam_length = seamLength(faces, map.corner) / std::sqrt(area);
  return measures;
}

}  // namespace

Result<LayoutMeasures> measureLayout(const Connectivity& surface,
                                     const std::vector<double>& lengths,
                                     const Parameterization& map,
                                     const std::vector<bool>& left_out) {
  if (!map.subdivision) return measure({surface, lengths, left_out}, map);
  const Subdivision& subdivision = *map.subdivision;
  const auto vertices = surface.vertexCount() + static_cast<Index>(subdivision.vertices.size());
  ASSIGN_OR_RETURN(const Connectivity pieces, Connectivity::fromFaces(vertices, subdivision.faces));
  std::vector<bool> left;
  if (!left_out.empty()) {
    for (const Index parent : subdivision.parent) left.push_back(left_out[parent]);
  }
  return measure({pieces, subdividedLengths(surface, lengths, subdivision, pieces), left}, map);
}

}  // namespace moduli
