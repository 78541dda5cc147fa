#include "core/picture/shapes.h"

#include <cmath>
#include <numbers>

namespace moduli {

void addShapes(Svg& svg, const std::vector<Shape>& shapes, double x, double y,
               const std::vector<Words>& words) {
  for (const Shape& shape : shapes) {
    SvgPath path;
    for (const Outline& outline : shape.outlines) {
      bool begun = false;
      for (const auto& [px, py] : outline) {
        if (!std::isfinite(px) || !std::isfinite(py)) break;
        begun ? path.lineTo(x + px, y + py) : path.moveTo(x + px, y + py);
        begun = true;
      }
      if (begun && shape.closed) path.close();
    }
    if (!path.empty()) svg.path(path, shape.style);
  }
  for (const Words& w : words) {
    svg.text(w.text, x + w.x, y + w.y, w.size, w.color, w.bold, w.max_width);
  }
}

Outline circleOutline(double x, double y, double radius) {
  constexpr int kParts = 360;
  Outline outline;
  for (int i = 0; i < kParts; ++i) {
    const double angle = 2 * std::numbers::pi * i / kParts;
    outline.push_back({x + radius * std::cos(angle), y + radius * std::sin(angle)});
  }
  return outline;
}

}  // namespace moduli
