#include "core/picture/precision_recall.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "core/base/text.h"
#include "core/picture/svg.h"

namespace moduli {
namespace {

constexpr double kLeft = 56, kTop = 64, kBottom = 52, kLegend = 168, kRow = 20;
constexpr Color kInk = {38, 44, 54}, kFaint = {225, 229, 234}, kAxis = {110, 118, 130};

// After Okabe and Ito, without their yellow, which is too light for lines on white.
constexpr std::array<Color, 7> kColors = {{{0, 114, 178},
                                           {213, 94, 0},
                                           {0, 158, 115},
                                           {204, 121, 167},
                                           {86, 180, 233},
                                           {230, 159, 0},
                                           {60, 60, 60}}};

Status invalid(std::string message) {
  return {Reason::kInvalidOption, std::move(message)};
}

Status checkCurve(const PrecisionRecallCurve& curve) {
  if (!isPrintableUtf8(curve.name)) return invalid("a curve's name cannot be printed");
  if (curve.precision.size() < 2) return invalid(curve.name + ": a curve needs two points");
  for (const double value : curve.precision) {
    if (!(value >= 0 && value <= 1)) {
      return invalid(curve.name + ": precision is " + shortestDouble(value) +
                     ", not within 0 to 1");
    }
  }
  return {};
}

Status check(std::span<const PrecisionRecallCurve> curves, const PrecisionRecallOptions& options) {
  if (curves.empty()) return invalid("there is no curve to draw");
  for (const PrecisionRecallCurve& curve : curves) RETURN_IF_ERROR(checkCurve(curve));
  if (!isPrintableUtf8(options.title)) return invalid("the title cannot be printed");
  const double least = std::max(240.0, kRow * static_cast<double>(curves.size()) + 90);
  if (options.width < 320 || options.height < least) {
    return invalid("the picture needs 320 by " + shortestDouble(least) + " pixels");
  }
  return {};
}

class Plot {
 public:
  explicit Plot(const PrecisionRecallOptions& options)
      : svg_(options.width, options.height),
        width_(options.width - kLeft - kLegend),
        height_(options.height - kTop - kBottom) {
    svg_.text(options.title, kLeft, 26, 15, kInk, true, options.width - kLeft - 10);
    drawGrid();
  }

  void draw(const PrecisionRecallCurve& curve, std::size_t number) {
    const Color color = kColors[number % kColors.size()];
    const std::size_t last = curve.precision.size() - 1;
    SvgPath line;
    for (std::size_t j = 0; j <= last; ++j) {
      const double x = xOf(static_cast<double>(j) / static_cast<double>(last));
      const double y = yOf(curve.precision[j]);
      j == 0 ? line.moveTo(x, y) : line.lineTo(x, y);
    }
    svg_.path(line, {.stroke = color, .stroke_width = 2});
    // About ten marks, also of a curve of many points.
    const std::size_t step = std::max<std::size_t>(1, last / 10);
    for (std::size_t j = 0; j <= last; j += step) {
      mark(xOf(static_cast<double>(j) / static_cast<double>(last)), yOf(curve.precision[j]),
           number);
    }
    legend(curve.name, number);
  }

  std::string finish() && { return std::move(svg_).finish(); }

 private:
  double xOf(double recall) const { return kLeft + recall * width_; }
  double yOf(double precision) const { return kTop + (1 - precision) * height_; }

  void line(double x1, double y1, double x2, double y2, const Color& color) {
    SvgPath path;
    path.moveTo(x1, y1).lineTo(x2, y2);
    svg_.path(path, {.stroke = color});
  }

  void drawGrid() {
    constexpr std::array<const char*, 6> kTicks = {"0", "0.2", "0.4", "0.6", "0.8", "1"};
    constexpr double kSize = 12;
    for (std::size_t i = 0; i < kTicks.size(); ++i) {
      const double value = static_cast<double>(i) / 5;
      line(xOf(0), yOf(value), xOf(1), yOf(value), kFaint);
      line(xOf(value), yOf(0), xOf(value), yOf(1), kFaint);
      // A digit is 0.64 sizes wide, a point half of that.
      const double text_width = (kTicks[i][1] == '\0' ? 0.64 : 1.6) * kSize;
      svg_.text(kTicks[i], xOf(0) - 8 - text_width, yOf(value) + 4, kSize, kInk, false, 60);
      svg_.text(kTicks[i], xOf(value) - text_width / 2, yOf(0) + 18, kSize, kInk, false, 60);
    }
    line(xOf(0), yOf(0), xOf(1), yOf(0), kAxis);
    line(xOf(0), yOf(0), xOf(0), yOf(1), kAxis);
    svg_.text("Recall", xOf(0.5) - 20, yOf(0) + 40, 13, kInk, false, 120);
    svg_.text("Precision", 14, kTop - 14, 13, kInk, false, 120);
  }

  // A disk, square, diamond or triangle.
  void mark(double x, double y, std::size_t number) {
    const SvgStyle style = {.fill = kColors[number % kColors.size()]};
    constexpr double r = 3.6;
    SvgPath path;
    switch (number % 4) {
      case 0:
        svg_.circle(x, y, r, style);
        return;
      case 1:
        path.moveTo(x - r, y - r).lineTo(x + r, y - r).lineTo(x + r, y + r).lineTo(x - r, y + r);
        break;
      case 2:
        path.moveTo(x, y - 1.4 * r).lineTo(x + 1.4 * r, y).lineTo(x, y + 1.4 * r);
        path.lineTo(x - 1.4 * r, y);
        break;
      default:
        path.moveTo(x, y - 1.3 * r).lineTo(x + 1.2 * r, y + r).lineTo(x - 1.2 * r, y + r);
    }
    svg_.path(path.close(), style);
  }

  void legend(const std::string& name, std::size_t number) {
    const double x = xOf(1) + 18, y = kTop + 8 + kRow * static_cast<double>(number);
    SvgPath sample;
    sample.moveTo(x, y).lineTo(x + 24, y);
    svg_.path(sample, {.stroke = kColors[number % kColors.size()], .stroke_width = 2});
    mark(x + 12, y, number);
    svg_.text(name, x + 32, y + 4, 12, kInk, false, kLegend - 54);
  }

  Svg svg_;
  double width_, height_;
};

}  // namespace

Result<std::string> drawPrecisionRecall(std::span<const PrecisionRecallCurve> curves,
                                        const PrecisionRecallOptions& options) {
  RETURN_IF_ERROR(check(curves, options));
  Plot plot(options);
  for (std::size_t i = 0; i < curves.size(); ++i) plot.draw(curves[i], i);
  return std::move(plot).finish();
}

}  // namespace moduli
