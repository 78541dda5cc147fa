#include "core/picture/raster.h"

#include <algorithm>

namespace moduli {
namespace {

// Twice the signed area of a, b, q. Exactly the opposite number for b, a, q, so that a sample on a
// common edge is in one of its faces at least.
double doubledArea(const Vec3& a, const Vec3& b, const Vec3& q) {
  if (b[0] < a[0] || (b[0] == a[0] && b[1] < a[1])) return -doubledArea(b, a, q);
  return (b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]);
}

}  // namespace

Raster::Raster(int width, int first_row, int rows)
    : width_(width),
      first_row_(first_row),
      rows_(rows),
      samples_(static_cast<std::size_t>(width) * rows) {}

Raster::Range Raster::clip(double low, double high, int first, int last) {
  // As doubles: what lies far outside has no int.
  const double from = std::max<double>(first, std::floor(low));
  const double to = std::min<double>(last, std::ceil(high));
  if (!(from <= to)) return {0, -1};
  return {static_cast<int>(from), static_cast<int>(to)};
}

void Raster::drawTriangle(int face, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double area = doubledArea(a, b, c);
  if (area == 0 || !std::isfinite(area)) return;
  const Range xs = columns(std::min({a[0], b[0], c[0]}), std::max({a[0], b[0], c[0]}));
  const Range ys = rows(std::min({a[1], b[1], c[1]}), std::max({a[1], b[1], c[1]}));
  for (int y = ys.first; y <= ys.last; ++y) {
    Sample* row = &samples_[static_cast<std::size_t>(y - first_row_) * width_];
    for (int x = xs.first; x <= xs.last; ++x) {
      const Vec3 q = {x + 0.5, y + 0.5, 0};
      const double u = doubledArea(b, c, q) / area;
      const double v = doubledArea(c, a, q) / area;
      const double w = doubledArea(a, b, q) / area;
      if (u < 0 || v < 0 || w < 0) continue;
      const auto depth = static_cast<float>(u * a[2] + v * b[2] + w * c[2]);
      if (depth <= row[x].depth) continue;
      row[x] = {depth, face, static_cast<float>(v), static_cast<float>(w)};
    }
  }
}

void Raster::drawLine(int set, const Vec3& a, const Vec3& b, double width, double lift) {
  const double radius = width / 2;
  const double dx = b[0] - a[0], dy = b[1] - a[1];
  const double squared = dx * dx + dy * dy;
  if (!std::isfinite(squared)) return;
  const Range xs = columns(std::min(a[0], b[0]) - radius, std::max(a[0], b[0]) + radius);
  const Range ys = rows(std::min(a[1], b[1]) - radius, std::max(a[1], b[1]) + radius);
  for (int y = ys.first; y <= ys.last; ++y) {
    Sample* row = &samples_[static_cast<std::size_t>(y - first_row_) * width_];
    for (int x = xs.first; x <= xs.last; ++x) {
      const double px = x + 0.5 - a[0], py = y + 0.5 - a[1];
      const double t = squared > 0 ? std::clamp((px * dx + py * dy) / squared, 0.0, 1.0) : 0;
      const double ex = px - t * dx, ey = py - t * dy;
      if (ex * ex + ey * ey > radius * radius) continue;
      const auto depth = static_cast<float>(a[2] + t * (b[2] - a[2]) + lift);
      if (depth < row[x].depth) continue;
      row[x] = {depth, Sample::ofLine(set), 0, 0};
    }
  }
}

}  // namespace moduli
