#pragma once

#include <vector>

#include "core/base/status.h"
#include "core/mesh/triangle_soup.h"

namespace moduli {

/// An oriented 2-manifold triangle complex, with or without boundary, keyed by halfedges.
///
/// Halfedge h = 3 f + c runs in face f from corner c to corner (c + 1) % 3. A Δ-complex is allowed:
/// two faces may share several edges, and an edge may be a loop. Vertices without faces are not.
/// Immutable and compact: about 60 bytes per face. Safe to read from several threads.
class Connectivity {
 public:
  /// Glues faces along directed edges that occur once in each direction.
  /// Fails with kEmpty, kIndexOutOfRange, kDegenerateFace (a face repeats a vertex),
  /// kNonManifoldEdge, kInconsistentOrientation, kNonManifoldVertex (several fans at a vertex, or a
  /// vertex without faces), naming the element. O(V + F).
  static Result<Connectivity> fromFaces(Index vertex_count, std::vector<Triangle> faces);

  /// Takes the gluing as given. twin[h] is the opposite halfedge or kNone on the boundary; it must
  /// be an involution without fixed points that matches end vertices. Fails with kInvalidOption
  /// naming the halfedge, or kNonManifoldVertex. O(V + F).
  static Result<Connectivity> fromGluing(Index vertex_count, std::vector<Triangle> faces,
                                         std::vector<Index> twin);

  Index vertexCount() const { return static_cast<Index>(outgoing_.size()); }
  Index faceCount() const { return static_cast<Index>(faces_.size()); }
  Index edgeCount() const { return static_cast<Index>(edge_halfedge_.size()); }
  Index halfedgeCount() const { return 3 * faceCount(); }

  const std::vector<Triangle>& faces() const { return faces_; }
  const Triangle& face(Index f) const { return faces_[f]; }

  static Index faceOf(Index h) { return h / 3; }
  static Index next(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static Index previous(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }
  Index tail(Index h) const { return faces_[h / 3][h % 3]; }
  Index head(Index h) const { return tail(next(h)); }
  /// The opposite halfedge, kNone on the boundary.
  Index twin(Index h) const { return twin_[h]; }

  /// The edge of a halfedge. Edges are numbered by their lowest halfedge, ascending.
  Index edge(Index h) const { return edge_[h]; }
  /// The lowest halfedge of an edge; it gives the edge its direction.
  Index halfedge(Index e) const { return edge_halfedge_[e]; }
  /// +1 if h runs along its edge's direction, -1 against it.
  int sign(Index h) const { return edge_halfedge_[edge_[h]] == h ? 1 : -1; }
  bool isBoundaryEdge(Index e) const { return twin_[edge_halfedge_[e]] == kNone; }

  /// A halfedge that starts at v; at a boundary vertex the one that itself lies on the boundary, so
  /// that turning counter-clockwise by twin(previous(h)) meets every face at v.
  Index outgoing(Index v) const { return outgoing_[v]; }
  bool isBoundaryVertex(Index v) const { return twin_[outgoing_[v]] == kNone; }
  /// The next outgoing halfedge counter-clockwise around tail(h); kNone past the last one.
  Index rotate(Index h) const { return twin_[previous(h)]; }

  Index eulerCharacteristic() const { return vertexCount() - edgeCount() + faceCount(); }

 private:
  Connectivity() = default;
  Status finish(Index vertex_count);

  std::vector<Triangle> faces_;
  std::vector<Index> twin_;
  std::vector<Index> edge_;
  std::vector<Index> edge_halfedge_;
  std::vector<Index> outgoing_;
};

}  // namespace moduli
