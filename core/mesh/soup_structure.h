#pragma once

#include <vector>

#include "core/mesh/edge_groups.h"
#include "core/mesh/triangle_soup.h"

namespace moduli {

/// How the faces of any soup hang together, surface or not. Faces that repeat a vertex are left out
/// of everything (kNone).
///
/// A sheet is connected through edges with exactly two faces; a component through any edge; a fan
/// is the set of corners at a vertex that hang together through edges there. On a surface sheets
/// are components, and every vertex has one fan.
struct SoupStructure {
  EdgeGroups edges;
  /// Per halfedge the next one at its edge, in a ring: itself on the boundary, the opposite one at
  /// an edge with two faces.
  std::vector<Index> partner;

  Index sheets = 0;
  std::vector<Index> sheet;        ///< Per face; numbered by the lowest face of each sheet.
  std::vector<bool> against;       ///< Per face: runs against the lowest face of its sheet.
  std::vector<bool> one_sided;     ///< Per sheet: no choice of face directions agrees.
  std::vector<bool> inconsistent;  ///< Per sheet: the face directions disagree somewhere.

  Index components = 0;
  std::vector<Index> component;  ///< Per face; numbered by the lowest face of each component.

  Index fans = 0;
  std::vector<Index> fan;  ///< Per corner (3 f + c); numbered by the lowest corner of each fan.

  /// True if h runs along an edge with exactly two faces.
  bool isPaired(Index h) const { return partner[h] != h && partner[partner[h]] == h; }
};

/// faces: indices in [0, vertex_count), at most 2^31 / 3 of them. O(V + F), as groupEdges.
SoupStructure analyseSoup(Index vertex_count, const std::vector<Triangle>& faces);

/// One component after splitting its pinched vertices.
struct ComponentCounts {
  Index first_face = 0;
  Index faces = 0;
  Index vertices = 0;
  Index edges = 0;
  Index boundary_loops = 0;

  Index eulerCharacteristic() const { return vertices - edges + faces; }
  /// Of an orientable component whose edges have at most two faces.
  Index genus() const { return (2 - boundary_loops - eulerCharacteristic()) / 2; }
};

/// By component number. Where edges have more than two faces, `boundary_loops` counts the connected
/// pieces of the boundary. O(F).
std::vector<ComponentCounts> countComponents(const SoupStructure& structure);

}  // namespace moduli
