#pragma once

#include <array>
#include <span>

#include "core/picture/image.h"

namespace moduli {

using Vec3 = std::array<double, 3>;
using CornerIndices = std::array<int, 3>;

struct RenderOptions {
  int width = 480;
  int height = 480;
  Vec3 view_from = {0.6, -1.0, 0.45};  ///< From the scene's centre towards the eye; not 0.
  Vec3 up = {0, 0, 1};                 ///< Not parallel to view_from.
  Color background = {255, 255, 255};
  Color surface = {205, 214, 224};
  int supersampling = 3;  ///< Samples per pixel and direction, 1 to 8.
};

/// Draws triangles in parallel projection, fitted to the image, with a depth buffer and smooth
/// shading on both sides. colors: one per point, or empty for the plain surface colour.
/// Points that are not finite and faces with indices out of range are left out.
/// O(faces + pixels). Same input, same pixels.
Image renderSurface(std::span<const Vec3> points, std::span<const CornerIndices> faces,
                    std::span<const Color> colors, const RenderOptions& options = {});

}  // namespace moduli
