#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/mesh/connectivity.h"

namespace moduli {

/// Vertices spread evenly over a surface, and whom each vertex is nearest to.
struct VertexSamples {
  std::vector<Index> vertices;  ///< Each as far as can be from all before it.
  std::vector<Index> nearest;   ///< Per vertex of the surface the number of a sample.
};

/// Distances along the edges of a surface: never shorter than true ones, and some percent longer
/// where triangles are well shaped. For what only compares distances.
class EdgeGraph {
 public:
  /// lengths: per edge, >= 0. O(E).
  EdgeGraph(const Connectivity& surface, const std::vector<double>& lengths);

  Index vertexCount() const { return static_cast<Index>(begin_.size()) - 1; }

  /// Neighbours of a vertex with the lengths of the edges to them, in the order of the edges.
  std::span<const std::pair<Index, double>> neighbours(Index vertex) const;

  /// Per vertex to the nearest of the sources; infinite in other components. O(E log V).
  std::vector<double> distances(std::span<const Index> sources) const;

  /// The vertices at most this far from one, nearest first, with their distances. O(k log k).
  std::vector<std::pair<Index, double>> within(Index source, double radius) const;

  /// Each sample is the vertex farthest from all before it, the lowest of several. begin: those to
  /// start from, different vertices; if empty, the one farthest from vertex 0. count: at most the
  /// number of vertices. Connected surfaces. About O(E log V log count).
  VertexSamples farthestSamples(const std::vector<Index>& begin, Index count) const;

 private:
  std::vector<std::size_t> begin_;  ///< Per vertex its first neighbour; one more at the end.
  std::vector<std::pair<Index, double>> neighbours_;
};

}  // namespace moduli
