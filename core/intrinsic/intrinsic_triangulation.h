#pragma once

#include <cstddef>
#include <vector>

#include "core/mesh/connectivity.h"

namespace moduli {

/// A Δ-complex whose edges carry half chords (geometry.h) and can be flipped.
///
/// Halfedges are those of Connectivity: h = 3 f + c runs in face f from corner c to the next. A
/// flip keeps faces, vertices and the flipped halfedge's number, moves the four edges around it
/// within the two faces, and is remembered: undoTo() restores every bit. Boundary edges never flip.
/// One thread at a time. About 50 bytes per face.
class IntrinsicTriangulation {
 public:
  /// half_chords: per edge of `surface`, > 0.
  IntrinsicTriangulation(const Connectivity& surface, const std::vector<double>& half_chords);

  Index vertexCount() const { return vertex_count_; }
  Index faceCount() const { return static_cast<Index>(tail_.size() / 3); }
  Index halfedgeCount() const { return static_cast<Index>(tail_.size()); }

  Index tail(Index h) const { return tail_[h]; }
  Index head(Index h) const { return tail_[Connectivity::next(h)]; }
  /// kNone on the boundary.
  Index twin(Index h) const { return twin_[h]; }
  double halfChord(Index h) const { return half_chord_[h]; }
  const std::vector<double>& halfChords() const { return half_chord_; }

  /// Changes all half chords without a flip; per halfedge, equal on twins. Not remembered.
  void setHalfChords(std::vector<double> half_chords);

  /// Whether two different faces meet along h.
  bool canFlip(Index h) const;

  /// The other diagonal of the quadrilateral around h by Ptolemy's relation
  /// (x_ik x_jl + x_jk x_il) / x_ij, exact for decorated ideal triangulations (Penner 1987). h must
  /// be flippable.
  double ptolemyDiagonal(Index h) const;

  /// Replaces h, from i to j with k on its left and l on its right, by the edge from l to k with
  /// the given half chord. h must be flippable. O(1).
  void flip(Index h, double half_chord);

  /// One remembered flip.
  struct Flip {
    Index halfedge = 0;
    double half_chord = 0;  ///< Of the edge that was replaced.
  };
  /// All flips so far that are not undone, in order.
  const std::vector<Flip>& history() const { return history_; }
  /// Undoes the latest flips until `count` of them are left.
  void undoTo(std::size_t count);

  /// The complex as it stands. O(F).
  Connectivity connectivity() const;
  /// Half chords per edge of connectivity().
  std::vector<double> edgeHalfChords() const;

 private:
  struct Surrounding;
  void rearrange(Index h, const Surrounding& ring, double half_chord);
  void setTails(Index h, Index tail, Index head, Index apex);
  void undoLast();
  void glue(Index h, Index twin);

  Index vertex_count_;
  std::vector<Index> tail_, twin_;
  std::vector<double> half_chord_;
  std::vector<Flip> history_;
};

}  // namespace moduli
