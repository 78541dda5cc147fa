#pragma once

#include <array>
#include <complex>
#include <map>
#include <string>
#include <utility>
#include <vector>

/// A textured OBJ file for tests to look into: read plainly, apart from what the program itself
/// reads and writes.
namespace moduli {

struct Obj {
  std::vector<std::string> vertices;  ///< The "v" lines as they stand.
  std::vector<std::array<double, 3>> positions;
  std::vector<std::complex<double>> points;
  std::vector<std::array<int, 3>> faces;    ///< Vertices, counted from 0.
  std::vector<std::array<int, 3>> corners;  ///< Points, counted from 0; -1 where a corner has none.

  /// Fails the running test on anything but "v", "vt" and triangles.
  static Obj parse(const std::string& text);

  /// Sum of the angles in the plane around every vertex.
  std::vector<double> angleSums() const;
  /// Twice the signed area of a face in the plane.
  double doubledArea(std::size_t f) const;

  using Edge = std::pair<int, int>;
  /// For every edge (lower vertex first) its lengths in the plane, one for each face at it.
  std::map<Edge, std::vector<double>> edgeLengths() const;
  double spaceLength(const Edge& edge) const;
};

}  // namespace moduli
