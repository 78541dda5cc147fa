#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/connectivity.h"

namespace moduli {

/// A surface in space: connectivity and one finite position per vertex. Immutable; safe to read
/// from several threads. Not necessarily connected (see prepareMesh for one component).
class TriangleMesh {
 public:
  /// Builds from a soup that is an oriented manifold without isolated vertices; otherwise fails as
  /// Connectivity::fromFaces does, or with kNonFiniteCoordinate. O(V + F).
  static Result<TriangleMesh> fromSoup(TriangleSoup soup);

  const Connectivity& connectivity() const { return connectivity_; }
  const std::vector<Eigen::Vector3d>& positions() const { return positions_; }

  Index vertexCount() const { return connectivity_.vertexCount(); }
  Index faceCount() const { return connectivity_.faceCount(); }

  /// Length of every edge, in model units.
  std::vector<double> edgeLengths() const;
  /// Area of every face, in squared model units.
  std::vector<double> faceAreas() const;
  double area() const;

 private:
  TriangleMesh(Connectivity connectivity, std::vector<Eigen::Vector3d> positions)
      : connectivity_(std::move(connectivity)), positions_(std::move(positions)) {}

  Connectivity connectivity_;
  std::vector<Eigen::Vector3d> positions_;
};

}  // namespace moduli
