#include "client/cli/minimize_picture.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "client/cli/chart.h"
#include "client/cli/minimize_plane.h"
#include "client/cli/minimize_report.h"
#include "client/cli/output.h"
#include "core/picture/shapes.h"
#include "core/picture/svg.h"
#include "server/rpc/convert_optimize.h"

namespace moduli::cli {
namespace {

constexpr Color kGradient = {0, 114, 178}, kValue = {213, 94, 0};
/// Marks of a line are told apart up to so many.
constexpr std::size_t kMostMarks = 60;
/// Of values: differences below it mean nothing.
constexpr double kRounding = 1e-15;

std::string subtitleOf(const v1::MinimizeRequest& request, const v1::Minimization& result) {
  const bool exact = request.options().line_search() == v1::MinimizeOptions::EXACT;
  return methodWord(result.method()) + ", " + (exact ? "exact" : "backtracking") +
         " line search: " + counted(result.iterations(), "iteration", "iterations") + ", " +
         counted(result.evaluations(), "evaluation", "evaluations") + ", " +
         reasonWords(result.reason());
}

/// Decimal logarithms against the iterations of numbers above `least`, beyond rounding of them.
Outline logarithms(const std::vector<MinimizedStep>& trace, double (*of)(const MinimizedStep&),
                   double least) {
  Outline points;
  for (const MinimizedStep& step : trace) {
    const double number = of(step) - least;
    if (number > kRounding * std::abs(least) && std::isfinite(number)) {
      points.push_back({static_cast<double>(step.iteration), std::log10(number)});
    }
  }
  return points;
}

void addCurve(Chart& chart, const Outline& points, const Color& color, const std::string& name) {
  if (points.empty()) return;
  chart.addLine(points, color, 2);
  const std::size_t every = points.size() / kMostMarks + 1;
  for (std::size_t i = 0; i < points.size(); i += every) {
    chart.addDot(points[i], 3.2, {.fill = color});
  }
  chart.addLegend(name, color, ChartMark::kDots);
}

/// The norm of the gradient and the value above its least against the iterations.
void addCurves(Chart& chart, const std::vector<MinimizedStep>& trace) {
  double least = trace.empty() ? 0 : trace.front().value;
  for (const MinimizedStep& step : trace) least = std::min(least, step.value);
  const Outline gradient = logarithms(
      trace, [](const MinimizedStep& step) { return step.gradient_norm; }, 0);
  const Outline value = logarithms(
      trace, [](const MinimizedStep& step) { return step.value; }, least);
  double low = 0, high = 0;
  bool any = false;
  for (const Outline* line : {&gradient, &value}) {
    for (const auto& point : *line) {
      low = any ? std::min(low, point[1]) : point[1];
      high = any ? std::max(high, point[1]) : point[1];
      any = true;
    }
  }
  const double last = trace.empty() ? 1 : std::max(1, trace.back().iteration);
  const double margin = 0.02 * last;
  low = std::floor(low - 0.2);
  high = std::ceil(high + 0.2);
  chart.setBox({-margin, low}, {last + margin, high});
  std::vector<Chart::Tick> iterations = evenTicks(0, last, 8);
  std::erase_if(iterations,
                [](const Chart::Tick& tick) { return tick.place != std::floor(tick.place); });
  chart.addTicksX(iterations, "iteration", true);
  chart.addTicksY(decadeTicks(low, high, 10), "", true);
  addCurve(chart, gradient, kGradient, "norm of the gradient");
  addCurve(chart, value, kValue, "value above the least one");
}

}  // namespace

bool drawsPlane(const v1::MinimizeRequest& request) {
  return request.has_test() && objectiveOptions(request).dimension == 2;
}

Result<std::string> drawMinimization(const MinimizePicture& picture) {
  const auto& [request, function, title, format, size] = picture;
  Chart chart(size.width, size.height, safe(title), subtitleOf(request, function.result));
  if (drawsPlane(request)) {
    RETURN_IF_ERROR(drawPlane(chart, request, function));
  } else {
    addCurves(chart, function.trace);
  }
  if (format == PictureFormat::kSvg) {
    Svg svg(size.width, size.height);
    addShapes(svg, chart.shapes(), 0, 0, chart.words());
    return std::move(svg).finish();
  }
  ASSIGN_OR_RETURN(const Image image,
                   drawShapes(chart.shapes(), size.width, size.height, chart.words()));
  return encodePng(image);
}

}  // namespace moduli::cli
