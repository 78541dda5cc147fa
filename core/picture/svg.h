#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/picture/image.h"

/// Vector pictures:
///
///   Svg svg(200, 100);
///   SvgPath path;
///   path.moveTo(10, 10).lineTo(90, 10).lineTo(50, 80).close();
///   svg.path(path, {.fill = Color{205, 214, 224}});
///   const std::string file = svg.finish();
namespace moduli {

/// The outline of a shape. Coordinates are rounded to hundredths of a pixel.
class SvgPath {
 public:
  SvgPath& moveTo(double x, double y) { return point('M', x, y); }
  SvgPath& lineTo(double x, double y) { return point('L', x, y); }
  SvgPath& close();
  bool empty() const { return data_.empty(); }
  const std::string& data() const { return data_; }

 private:
  SvgPath& point(char command, double x, double y);

  std::string data_;
};

struct SvgStyle {
  std::optional<Color> fill = {};
  std::optional<Color> stroke = {};
  double stroke_width = 1;  ///< Pixels.
  double opacity = 1;
};

/// An SVG file while it is written. Lengths are pixels, y points down. Texts are escaped; they have
/// to be UTF-8 without control characters (isPrintableUtf8). Numbers that are not finite are
/// written as 0. Not thread-safe.
class Svg {
 public:
  /// On a white ground.
  Svg(int width, int height);

  void path(const SvgPath& path, const SvgStyle& style);
  void circle(double x, double y, double radius, const SvgStyle& style);
  /// A circle that is lit from the upper left and gets darker towards its rim.
  void shadeBall(double x, double y, double radius);
  /// Raster, embedded. png: bytes of a file.
  void image(std::string_view png, double x, double y, double width, double height);
  /// Starts at x on the base line y; cut off at about max_width.
  void text(std::string_view text, double x, double y, double size, const Color& color, bool bold,
            double max_width);
  /// What follows is seen inside the path only (nonzero rule) until endClip().
  void beginClip(const SvgPath& path);
  void endClip();

  std::string finish() &&;

 private:
  std::string text_;
  int names_ = 0;
};

/// As of RFC 4648, with padding, without line breaks.
std::string base64(std::string_view bytes);

}  // namespace moduli
