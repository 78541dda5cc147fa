#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/spherical/surface_point.h"
#include "server/service/subject.h"

/// From maps between prepared surfaces back to the numbering of the files.
namespace moduli {

/// Per vertex of a file a point of another one, as ArrayChunk's IMAGE_FACES and IMAGE_WEIGHTS.
struct InputPoints {
  std::vector<std::int32_t> faces;  ///< kNone for vertices of no face that was mapped.
  std::vector<std::array<double, 3>> weights;
  Index without_image = 0;
  Index beside_hole = 0;  ///< Images in filled holes, put to the nearest point of the faces around.
};

/// images: per vertex of the prepared surface of `from` a point of that of `to`. A vertex that
/// repair has split has the image of the lowest of its parts. Both are meshes. O(V + F + vertices
/// in filled holes times faces around them).
InputPoints inputPoints(const Subject& from, const Subject& to,
                        const std::vector<SurfacePoint>& images);

}  // namespace moduli
