#include "core/picture/legend.h"

#include <algorithm>
#include <cmath>

namespace moduli {
namespace {

constexpr double kTitle = 22, kBar = 15, kRow = 20, kLabel = 11;
constexpr int kStrips = 128;
constexpr Color kFrame = {110, 118, 130}, kInk = {70, 76, 86};

Outline box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

}  // namespace

LegendDrawing makeLegend(const Legend& legend, int width, int height) {
  LegendDrawing drawing;
  const double top = kTitle;
  const double rows = kRow * static_cast<double>(legend.swatches.size());
  const double bottom = std::max(top + 1, height - 6 - (rows > 0 ? rows + 8 : 0));
  drawing.words.push_back({legend.title, 0, 12, 12, {26, 26, 26}, true, double(width)});
  // From the top down, each over the rest of the bar, so that no crack is left between strips.
  for (int k = 0; k < kStrips; ++k) {
    const double y = top + (bottom - top) * k / kStrips;
    const double place = 1 - (k + 0.5) / kStrips;
    drawing.shapes.push_back({{box(0.5, y, kBar, bottom)}, {.fill = legend.color(place)}});
  }
  drawing.shapes.push_back(
      {{box(0.5, top, kBar, bottom)}, {.stroke = kFrame, .stroke_width = 0.8}});
  for (const Legend::Tick& tick : legend.ticks) {
    const double y = bottom - std::clamp(tick.place, 0.0, 1.0) * (bottom - top);
    Shape mark = {{{{kBar, y}, {kBar + 4, y}}}, {.stroke = kFrame, .stroke_width = 0.8}, false};
    drawing.shapes.push_back(std::move(mark));
    drawing.words.push_back({tick.label, kBar + 8, y + 4, kLabel, kInk, false, width - kBar - 8});
  }
  double y = bottom + 12;
  for (const Legend::Swatch& swatch : legend.swatches) {
    drawing.shapes.push_back({{box(0.5, y, kBar, y + 12)}, {.fill = swatch.color}});
    drawing.words.push_back(
        {swatch.label, kBar + 8, y + 10, kLabel, kInk, false, width - kBar - 8});
    y += kRow;
  }
  return drawing;
}

NiceSpan niceSpan(double span) {
  if (!(span > 1e-300) || !(span < 1e300)) return {};
  const double power = std::pow(10, std::floor(std::log10(span)));
  // What is nearly a nice number is one.
  const double mantissa = span / power * (1 - 1e-9);
  for (const double nice : {1.0, 2.0, 5.0}) {
    if (mantissa <= nice) return {nice * power, nice == 2 ? 4 : 5};
  }
  return {10 * power, 5};
}

}  // namespace moduli
