#include "client/cli/chart.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "client/cli/output.h"
#include "core/picture/legend.h"

namespace moduli::cli {
namespace {

constexpr double kLeft = 76, kRight = 22, kTop = 82, kBottom = 56;
constexpr double kLabel = 12, kTick = 5;
constexpr Color kInk = {38, 44, 54}, kFaint = {225, 229, 234}, kAxis = {110, 118, 130};

/// A digit is 0.6 sizes wide, a point half of that.
double widthOf(const std::string& text, double size) {
  double width = 0;
  for (const char c : text) width += c == '.' ? 0.3 : c == '-' ? 0.4 : 0.6;
  return width * size;
}

}  // namespace

Chart::Chart(int width, int height, const std::string& title, const std::string& subtitle)
    : left_(kLeft),
      top_(kTop),
      right_(std::max(kLeft + 1, width - kRight)),
      bottom_(std::max(kTop + 1, height - kBottom)),
      legend_(kLeft) {
  words_.push_back({title, left_, 26, 16, kInk, true, right_ - left_});
  words_.push_back({subtitle, left_, 46, 12.5, kAxis, false, right_ - left_});
}

void Chart::setBox(const std::array<double, 2>& low, const std::array<double, 2>& high) {
  low_ = low;
  high_ = high;
}

std::array<double, 2> Chart::place(const std::array<double, 2>& point) const {
  return {left_ + (point[0] - low_[0]) / (high_[0] - low_[0]) * frameWidth(),
          bottom_ - (point[1] - low_[1]) / (high_[1] - low_[1]) * frameHeight()};
}

void Chart::addTicksX(const std::vector<Tick>& ticks, const std::string& name, bool across) {
  for (const Tick& tick : ticks) {
    const double x = place({tick.place, low_[1]})[0];
    if (across) stroke({{x, bottom_}, {x, top_}}, kFaint, 1);
    stroke({{x, bottom_}, {x, bottom_ + kTick}}, kAxis, 1);
    words_.push_back({tick.label, x - widthOf(tick.label, kLabel) / 2, bottom_ + 19, kLabel, kInk});
  }
  words_.push_back({name, (left_ + right_ - widthOf(name, 13)) / 2, bottom_ + 41, 13, kInk});
}

void Chart::addTicksY(const std::vector<Tick>& ticks, const std::string& name, bool across) {
  for (const Tick& tick : ticks) {
    const double y = place({low_[0], tick.place})[1];
    if (across) stroke({{left_, y}, {right_, y}}, kFaint, 1);
    stroke({{left_ - kTick, y}, {left_, y}}, kAxis, 1);
    words_.push_back({tick.label, left_ - 9 - widthOf(tick.label, kLabel), y + 4, kLabel, kInk});
  }
  words_.push_back({name, 16, (top_ + bottom_) / 2 + 4, 13, kInk, false, left_ - 40});
}

void Chart::stroke(Outline outline, const Color& color, double width) {
  Shape shape;
  shape.outlines.push_back(std::move(outline));
  shape.style.stroke = color;
  shape.style.stroke_width = width;
  shape.closed = false;
  shapes_.push_back(std::move(shape));
}

void Chart::addLine(const Outline& points, const Color& color, double width) {
  Outline outline;
  for (const auto& point : points) outline.push_back(place(point));
  stroke(std::move(outline), color, width);
}

void Chart::addDot(const std::array<double, 2>& point, double radius, const SvgStyle& style) {
  const auto at = place(point);
  shapes_.push_back({{circleOutline(at[0], at[1], radius)}, style});
}

void Chart::addArrow(const std::array<double, 2>& from, const std::array<double, 2>& along,
                     const Color& color) {
  const std::array<double, 2> tip{from[0] + along[0], from[1] + along[1]};
  stroke({from, tip}, color, 1);
  const double length = std::hypot(along[0], along[1]);
  if (!(length > 0)) return;
  const double x = 4.5 * along[0] / length, y = 4.5 * along[1] / length;
  stroke({{tip[0] - x - 0.5 * y, tip[1] - y + 0.5 * x},
          tip,
          {tip[0] - x + 0.5 * y, tip[1] - y - 0.5 * x}},
         color, 1);
}

void Chart::addLegend(const std::string& name, const Color& color, ChartMark mark) {
  const double y = top_ - 16;
  if (mark == ChartMark::kArrow) {
    addArrow({legend_, y}, {22, 0}, color);
  } else {
    stroke({{legend_, y}, {legend_ + 24, y}}, color, mark == ChartMark::kDots ? 2 : 1.2);
  }
  if (mark == ChartMark::kDots) {
    shapes_.push_back({{circleOutline(legend_ + 12, y, 3.2)}, {.fill = color}});
  }
  words_.push_back({name, legend_ + 30, y + 4, 12, kInk});
  legend_ += 30 + widthOf(name, 12) + 24;
}

std::vector<Shape> Chart::shapes() const {
  std::vector<Shape> all = shapes_;
  Shape frame;
  frame.outlines = {{{left_, top_}, {right_, top_}, {right_, bottom_}, {left_, bottom_}}};
  frame.style.stroke = kAxis;
  all.push_back(std::move(frame));
  return all;
}

std::vector<Chart::Tick> evenTicks(double low, double high, int count) {
  const double step = niceSpan((high - low) / count).span;
  std::vector<Chart::Tick> ticks;
  for (double k = std::ceil(low / step); k * step <= high && ticks.size() < 64; ++k) {
    ticks.push_back({k * step, brief(k == 0 ? 0 : k * step)});
  }
  return ticks;
}

std::vector<Chart::Tick> decadeTicks(double low, double high, int count) {
  const double step = std::max(1.0, std::ceil((high - low) / count));
  std::vector<Chart::Tick> ticks;
  for (double k = std::ceil(low / step); k * step <= high; ++k) {
    const int power = static_cast<int>(k * step);
    ticks.push_back({k * step, power == 0 ? "1" : "1e" + std::to_string(power)});
  }
  return ticks;
}

}  // namespace moduli::cli
