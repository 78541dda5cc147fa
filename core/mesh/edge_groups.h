#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/mesh/triangle_soup.h"

namespace moduli {

/// The halfedges of any triangles, grouped by the two vertices they join, whatever the direction.
/// Halfedge 3 f + c runs in face f from corner c to corner (c + 1) % 3.
struct EdgeGroups {
  std::vector<Index> halfedges;  ///< Group after group; ascending within each.
  std::vector<Index> first;      ///< Group k starts at first[k] and ends before first[k + 1].

  std::size_t count() const { return first.size() - 1; }
  std::span<const Index> group(std::size_t k) const {
    return {halfedges.data() + first[k], static_cast<std::size_t>(first[k + 1] - first[k])};
  }
};

/// Groups by (lower vertex, higher vertex), ascending. Faces that repeat a vertex are left out.
/// faces: indices in [0, vertex_count), at most 2^31 / 3 faces. O(V + F), but O(d log d) at a
/// vertex of degree d.
EdgeGroups groupEdges(Index vertex_count, const std::vector<Triangle>& faces);

/// True if two corners are the same vertex.
inline bool repeatsVertex(const Triangle& face) {
  return face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
}

}  // namespace moduli
