#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/picture/shapes.h"

/// Charts: a frame with numbers along two of its sides, and what stands in it.
namespace moduli::cli {

/// A mark of a line's legend.
enum class ChartMark { kLine, kDots, kArrow };

/// Draws into a frame that shows the points (x, y) of a box; y up. Sizes are pixels.
class Chart {
 public:
  struct Tick {
    double place = 0;  ///< In units of the axis.
    std::string label;
  };

  /// title, subtitle: above the frame.
  Chart(int width, int height, const std::string& title, const std::string& subtitle);

  /// The frame's size.
  double frameWidth() const { return right_ - left_; }
  double frameHeight() const { return bottom_ - top_; }

  /// What the frame shows; low < high in both.
  void setBox(const std::array<double, 2>& low, const std::array<double, 2>& high);
  std::array<double, 2> place(const std::array<double, 2>& point) const;

  /// Ticks outside the frame, or lines across it, with labels; and what an axis is called: a letter
  /// where it is y.
  void addTicksX(const std::vector<Tick>& ticks, const std::string& name, bool across);
  void addTicksY(const std::vector<Tick>& ticks, const std::string& name, bool across);

  /// Points in units of the axes.
  void addLine(const Outline& points, const Color& color, double width);
  void addDot(const std::array<double, 2>& point, double radius, const SvgStyle& style);
  /// From a place into a direction, both in pixels, y down.
  void addArrow(const std::array<double, 2>& from, const std::array<double, 2>& along,
                const Color& color);
  /// A name in the row above the frame, from the left.
  void addLegend(const std::string& name, const Color& color, ChartMark mark);

  /// All of it, the frame last.
  std::vector<Shape> shapes() const;
  const std::vector<Words>& words() const { return words_; }

 private:
  void stroke(Outline outline, const Color& color, double width);

  double left_, top_, right_, bottom_;
  double legend_;  ///< Where the next name of the legend begins.
  std::array<double, 2> low_{0, 0}, high_{1, 1};
  std::vector<Shape> shapes_;
  std::vector<Words> words_;
};

/// At multiples of a nice step, about `count` of them, for axes that are not logarithmic. low <
/// high.
std::vector<Chart::Tick> evenTicks(double low, double high, int count);
/// At powers of ten, for an axis of decimal logarithms: "1e-5".
std::vector<Chart::Tick> decadeTicks(double low, double high, int count);

}  // namespace moduli::cli
