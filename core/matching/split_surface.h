#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/spherical/surface_point.h"

namespace moduli {

/// A surface some of whose faces are split, so that given points are vertices, no edge inside joins
/// two vertices of the boundary, and every face has a corner off the boundary.
///
/// Vertices keep their numbers, the new ones follow; edges of the boundary are split at given
/// points alone. Refers to nothing; safe to read from several threads.
class SplitSurface {
 public:
  /// points: of the surface, wherever in their faces. Fails as TriangleMesh::fromSoup does (two
  /// points so near that a face between them has no area). O(V + points F).
  static Result<SplitSurface> make(const TriangleMesh& mesh,
                                   const std::vector<SurfacePoint>& points = {});

  const TriangleMesh& mesh() const { return *mesh_; }
  /// Per point given the vertex that it is.
  const std::vector<Index>& vertices() const { return vertices_; }

  /// A point of the split surface on the one before. Weights of 0 stay 0: what is on an edge of
  /// the boundary is there on both. O(1).
  SurfacePoint before(const SurfacePoint& point) const;

  /// The other way. O(parts of the face).
  SurfacePoint after(const SurfacePoint& point) const;

 private:
  /// A face, and where its corners are in the face that it is part of.
  struct Part {
    Triangle face;
    Index whole = 0;
    std::array<std::array<double, 3>, 3> corners = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  };

  SplitSurface() = default;
  void splitChords(const TriangleMesh& mesh);
  void addPart(const Part& part, std::array<Index, 3> middles);
  void collectParts();
  Index insert(const SurfacePoint& point);
  void splitEdge(Index tail, Index head, double t, Index vertex);
  std::array<double, 3> weightsIn(const Part& part, const std::array<double, 3>& point) const;

  std::vector<Part> parts_;
  std::vector<std::vector<Index>> parts_of_;  ///< Per face before; empty where it is whole.
  std::vector<Eigen::Vector3d> positions_;
  std::vector<Index> vertices_;
  std::optional<TriangleMesh> mesh_;
};

}  // namespace moduli
