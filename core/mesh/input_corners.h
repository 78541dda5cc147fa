#pragma once

#include <vector>

#include "core/mesh/prepare.h"

namespace moduli {

/// For each halfedge of prepared.mesh the corner 3 g + d of `soup` (corner d of its face g) that it
/// starts at; kNone in faces that fill holes. Repair may have turned a face around, welded its
/// vertices or split them: corners follow through all of it, where vertices would not.
/// soup: what prepareMesh made `prepared` of. O(F).
std::vector<Index> inputCorners(const TriangleSoup& soup, const PreparedMesh& prepared);

/// Where the vertices of an input stand in a prepared mesh.
struct VertexPlaces {
  static constexpr Index kSeveral = -2;

  /// Per input vertex the one of the prepared mesh; kNone where none of its faces is in the mesh,
  /// kSeveral where repair has split it there.
  std::vector<Index> place;
  std::vector<bool> used;  ///< Per input vertex: a face of the input has it.
};

/// corners: of inputCorners. O(V + F).
VertexPlaces findVertexPlaces(const TriangleSoup& soup, const PreparedMesh& prepared,
                              const std::vector<Index>& corners);

}  // namespace moduli
