#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "core/picture/image.h"
#include "core/picture/vec3.h"

/// Surfaces as pictures:
///
///   Scene scene;
///   scene.points = points;
///   scene.faces = faces;
///   scene.paint = [](int face, const Vec3& barycentric) { return Color{205, 214, 224}; };
///   scene.lines.push_back({segments, {60, 66, 76}, 0.7});
///   const Image image = renderScene(scene, {.width = 640});
namespace moduli {

using CornerIndices = std::array<int, 3>;
using Segment = std::array<Vec3, 2>;

struct RenderOptions {
  int width = 480;  ///< Pixels; less than 1 is taken for 1.
  int height = 480;
  Vec3 view_from = {0.6, -1.0, 0.45};  ///< From the scene's centre towards the eye; not 0.
  Vec3 up = {0, 0, 1};                 ///< Not parallel to view_from.
  Color background = {255, 255, 255};
  Color surface = {205, 214, 224};
  int supersampling = 3;  ///< Samples per pixel and direction, 1 to 8.
  bool shaded = true;     ///< Otherwise colours are shown as they are.
};

/// Of the plane z = 0 seen from above, x to the right and y up, colours as they are.
RenderOptions planeView(int width, int height);

/// The colour of a point of a face before light falls on it. face: an index of the scene's faces.
/// barycentric: to single precision, not negative but for rounding, sum 1.
using Paint = std::function<Color(int face, const Vec3& barycentric)>;

/// Lines of one look, hidden by what lies more than two pixels before them.
struct LineSet {
  std::vector<Segment> segments;  ///< In the scene's coordinates.
  Color color = {60, 66, 76};
  double width = 1;  ///< Pixels.
};

struct Scene {
  std::span<const Vec3> points;
  std::span<const CornerIndices> faces;  ///< Of those at one depth the first is seen.
  Paint paint;                           ///< None: RenderOptions::surface.
  std::vector<LineSet> lines;            ///< Later ones over earlier ones.
};

/// Where a picture shows points of a scene: parallel projection, fitted with a margin of 4 % on
/// each side.
class Projection {
 public:
  /// Fits all points of faces and lines that can be drawn.
  Projection(const Scene& scene, const RenderOptions& options);

  /// False where there is nothing to draw, or no double holds its size.
  bool valid() const { return scale_ > 0; }
  /// Pixels per unit of length.
  double scale() const { return scale_; }
  /// In pixels: x to the right, y down from the upper left corner, z towards the eye.
  Vec3 operator()(const Vec3& point) const;

 private:
  Vec3 right_{}, down_{}, eye_{};
  Vec3 middle_{};  ///< In the directions above.
  double scale_ = 0;
  double half_width_ = 0, half_height_ = 0;
};

/// Draws triangles and lines in parallel projection, fitted to the image, with a depth buffer,
/// smooth shading on both sides and anti-aliasing. Points that are not finite and faces with
/// indices out of range are left out. paint is called once a visible sample. In bands: memory stays
/// within some 70 MB beside the image. O(bands faces + samples). Same input, same pixels.
Image renderScene(const Scene& scene, const RenderOptions& options = {});

/// The same for triangles alone. colors: one per point, or empty for the plain surface colour.
Image renderSurface(std::span<const Vec3> points, std::span<const CornerIndices> faces,
                    std::span<const Color> colors, const RenderOptions& options = {});

}  // namespace moduli
