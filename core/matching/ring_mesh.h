#pragma once

#include <vector>

#include "core/base/status.h"
#include "core/mesh/connectivity.h"

/// A closed triangle mesh that can be thinned vertex by vertex, and put together again.
namespace moduli {

/// Kept as rings: per vertex its neighbours counter-clockwise, so that its faces are the vertex
/// with any two neighbours that follow each other. Only what is glued where is known; it is the
/// same for spheres and for surfaces with handles. Not safe to change from several threads.
class RingMesh {
 public:
  /// A half-edge collapse: `removed` went into its neighbour `kept`.
  struct Collapse {
    Index removed = kNone, kept = kNone;
  };

  /// Fails with kUnsupportedTopology where the surface is not closed, a vertex has fewer
  /// than three neighbours, or two edges join the same vertices. O(V + F).
  static Result<RingMesh> make(const Connectivity& surface);

  /// The neighbours of a vertex, counter-clockwise from any one. Of a removed vertex: those it had.
  const std::vector<Index>& ring(Index v) const { return rings_[v]; }
  bool isPresent(Index v) const { return present_[v] != 0; }
  /// How many vertices are present.
  Index vertexCount() const { return count_; }

  /// Whether the mesh stays one, without doubled edges, when `removed` goes into its neighbour
  /// `kept`: the two have two neighbours in common, and these keep three. O(degree).
  bool canCollapse(Index removed, Index kept) const;

  /// The two are neighbours and canCollapse is true. O(degree) times the degrees of the ring.
  void collapse(Index removed, Index kept);

  /// Undoes the last collapse. Precondition: there is one.
  Collapse restore();

 private:
  RingMesh() = default;

  std::vector<std::vector<Index>> rings_;
  std::vector<char> present_;
  std::vector<Collapse> removed_;
  Index count_ = 0;
};

}  // namespace moduli
