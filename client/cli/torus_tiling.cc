#include "client/cli/torus_tiling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace moduli::cli {
namespace {

using namespace vec3;

constexpr double kMargin = 0.35;  // Around the image, in roots of a cell's area.
constexpr int kMostCopies = 200;
constexpr std::size_t kMostFaces = 1500000;  // Of all copies.

// A polygon less what lies beyond a line: axis 0 or 1, side 1 where coordinates above are out.
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, int axis, double sign, double limit) {
  std::vector<Vec3> part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& p = polygon[i];
    const Vec3& q = polygon[(i + 1) % polygon.size()];
    const double dp = sign * (limit - p[axis]), dq = sign * (limit - q[axis]);
    if (dp >= 0) part.push_back(p);
    if ((dp >= 0) != (dq >= 0)) part.push_back(p + (dp / (dp - dq)) * (q - p));
  }
  return part;
}

std::vector<Vec3> clipped(std::vector<Vec3> polygon, const std::array<Vec3, 2>& window) {
  for (int axis = 0; axis < 2 && !polygon.empty(); ++axis) {
    polygon = clipped(polygon, axis, -1, window[0][axis]);
    polygon = clipped(polygon, axis, 1, window[1][axis]);
  }
  return polygon;
}

std::optional<Segment> clipped(const Segment& segment, const std::array<Vec3, 2>& window) {
  double from = 0, to = 1;
  const Vec3 way = segment[1] - segment[0];
  for (int axis = 0; axis < 2; ++axis) {
    const double low = window[0][axis] - segment[0][axis];
    const double high = window[1][axis] - segment[0][axis];
    if (way[axis] == 0) {
      if (low > 0 || high < 0) return std::nullopt;
      continue;
    }
    const double s = low / way[axis], t = high / way[axis];
    from = std::max(from, std::min(s, t));
    to = std::min(to, std::max(s, t));
  }
  if (from > to) return std::nullopt;
  return Segment{segment[0] + from * way, segment[0] + to * way};
}

}  // namespace

TorusTiling::TorusTiling(const MapDrawing& drawing, const v1::TorusDomain& torus)
    : drawing_(&drawing) {
  if (torus.generators_size() != 2 || drawing.mapped.empty()) return;
  const Vec3 a = {torus.generators(0).re(), torus.generators(0).im(), 0};
  const Vec3 b = {torus.generators(1).re(), torus.generators(1).im(), 0};
  const double cell = a[0] * b[1] - a[1] * b[0];
  if (!finite(a) || !finite(b) || !(cell > 0) || !(a[0] > 0) || a[1] != 0) return;
  const double far = std::numeric_limits<double>::infinity();
  box_ = {Vec3{far, far, 0}, Vec3{-far, -far, 0}};
  for (const int f : drawing.mapped) {
    for (const int i : drawing.corners[f]) {
      for (int axis = 0; axis < 2; ++axis) {
        box_[0][axis] = std::min(box_[0][axis], drawing.points[i][axis]);
        box_[1][axis] = std::max(box_[1][axis], drawing.points[i][axis]);
      }
    }
  }
  const double margin = kMargin * std::sqrt(cell);
  window_ = {box_[0] - Vec3{margin, margin, 0}, box_[1] + Vec3{margin, margin, 0}};
  findShifts(a, b);
  if (shifts_.empty()) return;
  parallelogram_ = {Vec3{}, a, a + b, b};
  addPieces();
}

void TorusTiling::findShifts(const Vec3& a, const Vec3& b) {
  const double rows = std::ceil((window_[1][1] - box_[0][1]) / b[1]);
  const double columns = std::ceil((window_[1][0] - box_[0][0]) / a[0]);
  if (!(rows * columns < kMostCopies)) return;
  for (int n = -static_cast<int>(rows); n <= static_cast<int>(rows); ++n) {
    const double moved = n * b[0];
    const int first = static_cast<int>(std::ceil((window_[0][0] - box_[1][0] - moved) / a[0]));
    const int last = static_cast<int>(std::floor((window_[1][0] - box_[0][0] - moved) / a[0]));
    for (int m = first; m <= last; ++m) {
      const Vec3 shift = double(m) * a + double(n) * b;
      const bool seen =
          box_[0][1] + shift[1] < window_[1][1] && box_[1][1] + shift[1] > window_[0][1];
      if (seen && (m != 0 || n != 0)) shifts_.push_back(shift);
    }
  }
  if (shifts_.size() * drawing_->mapped.size() > kMostFaces) shifts_.clear();
}

void TorusTiling::addPieces() {
  for (std::size_t s = 0; s < shifts_.size(); ++s) {
    for (const int f : drawing_->mapped) {
      std::vector<Vec3> polygon;
      for (const int i : drawing_->corners[f]) polygon.push_back(drawing_->points[i] + shifts_[s]);
      polygon = clipped(std::move(polygon), window_);
      if (polygon.size() < 3) continue;
      const int first = static_cast<int>(points_.size());
      for (const Vec3& p : polygon) points_.push_back(p);
      for (int k = 1; k + 1 < static_cast<int>(polygon.size()); ++k) {
        pieces_.push_back({{first, first + k, first + k + 1}, static_cast<int>(s)});
      }
    }
  }
}

std::vector<Segment> TorusTiling::outlines() const {
  std::vector<Segment> segments;
  for (const Vec3& shift : shifts_) {
    for (const MapEdge& edge : drawing_->edges) {
      if (edge.kind == MapEdge::Kind::kInner) continue;
      const auto part = clipped(Segment{drawing_->points[edge.points[0]] + shift,
                                        drawing_->points[edge.points[1]] + shift},
                                window_);
      if (part) segments.push_back(*part);
    }
  }
  return segments;
}

Color paleColor(const Color& color) {
  const auto pale = [](std::uint8_t channel) {
    return static_cast<std::uint8_t>(255 - (255 - channel) * 2 / 5);
  };
  return {pale(color.red), pale(color.green), pale(color.blue)};
}

}  // namespace moduli::cli
