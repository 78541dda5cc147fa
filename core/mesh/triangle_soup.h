#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace moduli {

/// Vertices, faces, edges and halfedges are counted from 0 in 32 bits.
using Index = std::int32_t;
inline constexpr Index kNone = -1;

using Triangle = std::array<Index, 3>;

/// What a file says, before anyone has judged it: any coordinates, any in-range indices.
/// Polygons are already fans from their first corner, in file order.
struct TriangleSoup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Triangle> faces;
};

}  // namespace moduli
