#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/cli/map_drawing.h"
#include "client/cpp/parameterized_mesh.h"
#include "core/base/status.h"

/// Maps to the plane as other programs take them: with textures on the unit square, and with
/// vertices that have one texture point each.
namespace moduli::cli {

/// Where the unit square of a texture lies in the plane: (u, v) is at scale (u - u0, v - v0).
struct TextureLayout {
  double scale = 1;
  double u0 = 0, v0 = 0;

  double s(double u) const { return scale * (u - u0); }
  double t(double v) const { return scale * (v - v0); }
};

/// The largest scale, the same in both directions, for which the points of mapped faces are in the
/// unit square; from its lower left corner on. As it is, where there is no such point, or no extent
/// that a double can divide by. O(F).
TextureLayout fitUnitSquare(const ParameterizedMesh& mesh);

/// Vertices split where their corners have different points.
struct SplitVertices {
  std::vector<std::int32_t> vertex;  ///< Row of the positions; its own number, for the first V.
  std::vector<std::int32_t> point;   ///< Row of the points; -1 where there is none.
  std::vector<std::int32_t> corner;  ///< 3 per face: which of these it has there.
};

/// The vertices of a mesh come first, in their order, each with the point of its first corner;
/// others follow. A corner that is not mapped has the vertex without a point. O(F) and O(log) of
/// what is split.
SplitVertices splitVertices(const ParameterizedMesh& mesh);

/// A picture of the unit square of a map to the plane, as the pictures of maps have it (Pattern):
/// the bytes of a PNG file, `side` pixels wide and high. Fails as encodePng does. O(side^2 + F log
/// F).
Result<std::string> checkerTexture(const ParameterizedMesh& mesh, const TextureLayout& layout,
                                   int side = 1024);

}  // namespace moduli::cli
