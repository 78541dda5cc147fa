#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/picture/image.h"
#include "core/picture/svg.h"

/// Drawings in outlines, for rasters and vector files alike:
///
///   std::vector<Shape> shapes = {{{{{10, 10}, {90, 10}, {50, 80}}}, {.fill = Color{205, 214,
///   224}}}}; const Result<Image> image = drawShapes(shapes, 100, 90);
namespace moduli {

/// Points in pixels, x to the right, y down.
using Outline = std::vector<std::array<double, 2>>;

struct Shape {
  std::vector<Outline> outlines;  ///< Filled by the nonzero rule; each stroked.
  SvgStyle style;
  bool closed = true;  ///< Each outline ends where it begins.
};

/// A line of text: starts at x on the base line y; cut off at about max_width.
struct Words {
  std::string text;  ///< UTF-8 without control characters.
  double x = 0, y = 0;
  double size = 12;  ///< Pixels.
  Color color = {26, 26, 26};
  bool bold = false;
  double max_width = 1e4;
};

/// Later shapes over earlier ones, words over all of them, on white, with anti-aliasing and round
/// joins. Points that are not finite end an outline. Fails with kInternal if the library refuses.
Result<Image> drawShapes(const std::vector<Shape>& shapes, int width, int height,
                         const std::vector<Words>& words = {});

/// The same in an SVG, moved by (x, y).
void addShapes(Svg& svg, const std::vector<Shape>& shapes, double x, double y,
               const std::vector<Words>& words = {});

/// A circle as an outline.
Outline circleOutline(double x, double y, double radius);

}  // namespace moduli
