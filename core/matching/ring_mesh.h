#pragma once

#include <vector>

#include "core/base/status.h"
#include "core/mesh/connectivity.h"

/// A closed triangle mesh that can be thinned vertex by vertex, and put together again.
namespace moduli {

/// Kept as rings: per vertex its neighbours counter-clockwise, so that its faces are the vertex
/// with any two neighbours that follow each other. Only what is glued where is known; it is the
/// same for spheres and for surfaces with handles. Not safe to change from several threads.
///
/// A disk is kept as a sphere: one more vertex, the pole, is joined to all of its boundary, the
/// rim. Of its faces (those of the cap) nothing is asked. The disk's own faces must not have all
/// three corners on the rim, and no edge inside may join two vertices of the rim; collapses keep it
/// that way.
class RingMesh {
 public:
  /// A half-edge collapse: `removed` went into its neighbour `kept`.
  struct Collapse {
    Index removed = kNone, kept = kNone;
  };

  /// Fails with kUnsupportedTopology where the surface is not closed, a vertex has fewer
  /// than three neighbours, or two edges join the same vertices. pole: of a disk; an edge inside
  /// between two vertices of the rim is kUnsupportedTopology, too. O(V + F).
  static Result<RingMesh> make(const Connectivity& surface, Index pole = kNone);

  /// kNone for closed surfaces.
  Index pole() const { return pole_; }
  /// Whether a vertex is on the boundary of a disk.
  bool isRim(Index v) const { return pole_ != kNone && is_rim_[v] != 0; }
  /// Whether a face is not the surface's own.
  bool isCap(Index a, Index b, Index c) const {
    return pole_ != kNone && (a == pole_ || b == pole_ || c == pole_);
  }

  /// From now on a vertex cannot be removed.
  void hold(Index v) { held_[v] = 1; }
  bool isHeld(Index v) const { return held_[v] != 0; }

  /// The neighbours of a vertex, counter-clockwise from any one. Of a removed vertex: those it had.
  const std::vector<Index>& ring(Index v) const { return rings_[v]; }
  bool isPresent(Index v) const { return present_[v] != 0; }
  /// How many vertices are present.
  Index vertexCount() const { return count_; }

  /// Whether the mesh stays one, without doubled edges, when `removed` goes into its neighbour
  /// `kept`: the two have two neighbours in common, and these keep three. A vertex of the rim goes
  /// along the rim alone, and the pole and what is held do not go. O(degree).
  bool canCollapse(Index removed, Index kept) const;

  /// The two are neighbours and canCollapse is true. O(degree) times the degrees of the ring.
  void collapse(Index removed, Index kept);

  /// Those that are not undone, in their order.
  const std::vector<Collapse>& collapses() const { return removed_; }

  /// Undoes the last collapse. Precondition: there is one.
  Collapse restore();

 private:
  RingMesh() = default;

  bool keepsDisk(Index removed, Index kept) const;

  std::vector<std::vector<Index>> rings_;
  std::vector<char> present_, held_, is_rim_;
  std::vector<Collapse> removed_;
  Index count_ = 0, pole_ = kNone;
};

/// Undoes up to `most` collapses, for as long as the vertices that come back are in no ring of each
/// other: their images can be found side by side. In the order of coming back; none where most is
/// not positive or nothing is left. O(degree) each.
std::vector<RingMesh::Collapse> restoreSeparated(RingMesh& mesh, Index most);

/// Vertices that are present in sets without an edge in one set, greedily in the order given: what
/// moves a vertex by its ring alone may move a set side by side. O(V).
std::vector<std::vector<Index>> separatedSets(const RingMesh& mesh,
                                              const std::vector<Index>& vertices);

}  // namespace moduli
