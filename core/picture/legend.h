#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/picture/image.h"
#include "core/picture/shapes.h"

/// What the colours of a picture mean.
namespace moduli {

struct Legend {
  struct Tick {
    double place = 0;  ///< Along the bar, from 0 at its lower end to 1.
    std::string label;
  };
  struct Swatch {
    Color color;
    std::string label;
  };
  std::string title;                   ///< Above the bar; a word.
  std::function<Color(double)> color;  ///< At a place along the bar.
  std::vector<Tick> ticks;
  std::vector<Swatch> swatches;  ///< Below the bar, for what has a colour of its own.
};

struct LegendDrawing {
  std::vector<Shape> shapes;
  std::vector<Words> words;
};

/// An upright colour bar with ticks, within width x height pixels: for drawShapes and addShapes.
LegendDrawing makeLegend(const Legend& legend, int width, int height);

/// Where to put ticks on a range from `low` on: the least of 1, 2 and 5 times a power of ten that
/// is no less than `span`, and how many equal parts it has (4 or 5). span: positive and finite,
/// otherwise taken for 1.
struct NiceSpan {
  double span = 1;
  int parts = 5;
};
NiceSpan niceSpan(double span);

}  // namespace moduli
