#include "client/cli/minimize_plane.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "client/cli/minimize_report.h"
#include "core/optimize/affine_normal.h"
#include "core/optimize/named_objectives.h"
#include "core/optimize/tangent_inverse.h"
#include "core/picture/level_sets.h"
#include "server/rpc/convert_optimize.h"

namespace moduli::cli {
namespace {

using Point = std::array<double, 2>;

constexpr double kMargin = 0.16;  ///< Around the path, on each side.
constexpr double kSample = 1;     ///< Pixels between values, unless there are too many.
constexpr double kMostSamples = 1e6;
constexpr double kArrows = 42;  ///< Pixels between arrows, and their length.
constexpr double kArrow = 22;
constexpr int kLevels = 15;
/// Shares of the values below the lowest and the highest level.
constexpr double kLowest = 0.003, kHighest = 0.97;
constexpr std::size_t kMostDots = 80;
constexpr Color kPath = {213, 94, 0}, kField = {142, 150, 163}, kEnd = {26, 26, 26};

struct Box {
  Point low, high;
};

/// The box of the points with a margin, widened to the frame's shape: x and y have one scale.
Box boxOf(const std::vector<Point>& points, double aspect) {
  Box box{points.front(), points.front()};
  for (const Point& point : points) {
    for (std::size_t c = 0; c < 2; ++c) {
      box.low[c] = std::min(box.low[c], point[c]);
      box.high[c] = std::max(box.high[c], point[c]);
    }
  }
  const double width = box.high[0] - box.low[0], height = box.high[1] - box.low[1];
  double half = 0.5 * std::max(width, height * aspect) * (1 + 2 * kMargin);
  const double size = std::max({std::abs(box.low[0]), std::abs(box.low[1]), 1e-300});
  if (!(half > 1e-9 * size)) half = 1;
  const Point middle{(box.low[0] + box.high[0]) / 2, (box.low[1] + box.high[1]) / 2};
  return {{middle[0] - half, middle[1] - half / aspect},
          {middle[0] + half, middle[1] + half / aspect}};
}

/// Where a place of a grid over the box is.
Point inBox(const Box& box, double i, double columns, double j, double rows) {
  return {box.low[0] + (box.high[0] - box.low[0]) * i / columns,
          box.low[1] + (box.high[1] - box.low[1]) * j / rows};
}

class Plane {
 public:
  Plane(Chart& chart, Objective& objective, v1::MinimizeOptions::Method method)
      : chart_(chart), objective_(objective), method_(method) {}

  void draw(const MinimizedFunction& function) {
    const Box box = boxOf(function.path, chart_.frameWidth() / chart_.frameHeight());
    chart_.setBox(box.low, box.high);
    chart_.addTicksX(evenTicks(box.low[0], box.high[0], 7), "x", false);
    chart_.addTicksY(evenTicks(box.low[1], box.high[1], 6), "y", false);
    addLevels(box);
    addField(box);
    addPath(function.path);
  }

 private:
  double valueAt(const Point& point) {
    const Status status = objective_.moveTo(context_, Eigen::Vector2d(point[0], point[1]));
    return status.ok() ? objective_.value() : std::numeric_limits<double>::infinity();
  }

  void addLevels(const Box& box) {
    GridValues grid;
    const double pixels = chart_.frameWidth() * chart_.frameHeight();
    const double sample = kSample * std::max(1.0, std::sqrt(pixels / kMostSamples));
    grid.columns = static_cast<int>(chart_.frameWidth() / sample) + 2;
    grid.rows = static_cast<int>(chart_.frameHeight() / sample) + 2;
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        grid.values.push_back(valueAt(inBox(box, i, grid.columns - 1, j, grid.rows - 1)));
      }
    }
    std::vector<double> sorted;
    for (const double value : grid.values) {
      if (std::isfinite(value)) sorted.push_back(value);
    }
    if (sorted.size() < 8) return;
    std::sort(sorted.begin(), sorted.end());
    const auto above = [&](double share) {
      const auto last = static_cast<double>(sorted.size() - 1);
      return sorted[static_cast<std::size_t>(share * last)] - sorted.front();
    };
    const double low = above(kLowest), high = above(kHighest);
    if (!(low > 0) || !(high > low)) return;
    for (int k = 0; k < kLevels; ++k) {
      const double share = static_cast<double>(k) / (kLevels - 1);
      const double level = sorted.front() + low * std::pow(high / low, share);
      addLevel(grid, box, level, sequentialColor(0.75 * share));
    }
    chart_.addLegend("level sets", sequentialColor(0.35), ChartMark::kLine);
  }

  void addLevel(const GridValues& grid, const Box& box, double level, const Color& color) {
    for (Outline& line : levelSet(grid, level)) {
      for (Point& point : line) {
        point = inBox(box, point[0], grid.columns - 1, point[1], grid.rows - 1);
      }
      chart_.addLine(line, color, 1.1);
    }
  }

  void addField(const Box& box) {
    const int columns = std::max(1, static_cast<int>(chart_.frameWidth() / kArrows));
    const int rows = std::max(1, static_cast<int>(chart_.frameHeight() / kArrows));
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) addArrow(inBox(box, i + 0.5, columns, j + 0.5, rows));
    }
    const bool affine = method_ == v1::MinimizeOptions::AFFINE_NORMAL;
    const bool newton = method_ == v1::MinimizeOptions::NEWTON;
    chart_.addLegend(affine   ? "affine normals"
                     : newton ? "Newton directions"
                              : "steepest descent",
                     kField, ChartMark::kArrow);
  }

  /// The middle of the arrow is at the point.
  void addArrow(const Point& point) {
    const auto direction = directionAt(Eigen::Vector2d(point[0], point[1]));
    if (!direction || !direction->allFinite()) return;
    const double length = direction->stableNorm();
    if (!(length > 0)) return;
    const Point along{-kArrow * (*direction)[0] / length, kArrow * (*direction)[1] / length};
    const Point at = chart_.place(point);
    chart_.addArrow({at[0] - along[0] / 2, at[1] - along[1] / 2}, along, kField);
  }

  /// What the method walks against; nothing where it has no direction of its own.
  std::optional<Eigen::VectorXd> directionAt(const Eigen::VectorXd& x) {
    if (!objective_.moveTo(context_, x).ok() || !std::isfinite(objective_.value())) return {};
    switch (method_) {
      case v1::MinimizeOptions::AFFINE_NORMAL: {
        AffineNormalOptions options;
        options.form = AffineForm::kBordered;
        const auto normal = affineNormal(context_, objective_, x, options);
        if (!normal.ok() || !normal->convex) return {};
        return normal->direction;
      }
      case v1::MinimizeOptions::NEWTON: {
        const Eigen::MatrixXd H = denseOf(objective_.hessian());
        const double determinant = H(0, 0) * H(1, 1) - H(0, 1) * H(1, 0);
        if (!(determinant > 0) || !(H(0, 0) > 0)) return {};
        const Eigen::VectorXd& g = objective_.gradient();
        return Eigen::Vector2d(H(1, 1) * g[0] - H(0, 1) * g[1], H(0, 0) * g[1] - H(1, 0) * g[0]);
      }
      default:
        return objective_.gradient();
    }
  }

  void addPath(const std::vector<Point>& path) {
    chart_.addLine(path, kPath, 2.2);
    if (path.size() <= kMostDots) {
      for (const Point& point : path) chart_.addDot(point, 3.2, {.fill = kPath});
    }
    const Color white = {255, 255, 255};
    chart_.addDot(path.front(), 5, {.fill = white, .stroke = kPath, .stroke_width = 2.2});
    chart_.addDot(path.back(), 4.6, {.fill = kEnd, .stroke = white, .stroke_width = 1.2});
    chart_.addLegend("path, from the ring to the disk", kPath, ChartMark::kDots);
  }

  Context context_;
  Chart& chart_;
  Objective& objective_;
  v1::MinimizeOptions::Method method_;
};

}  // namespace

Status drawPlane(Chart& chart, const v1::MinimizeRequest& request,
                 const MinimizedFunction& function) {
  if (function.path.empty()) return {Reason::kInternal, "there is no path to draw", ""};
  ASSIGN_OR_RETURN(const NamedObjective named,
                   makeObjective(request.test().name(), objectiveOptions(request)));
  Plane(chart, *named.objective, function.result.method()).draw(function);
  return {};
}

}  // namespace moduli::cli
