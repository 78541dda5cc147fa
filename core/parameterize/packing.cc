#include "core/parameterize/packing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "core/parameterize/layout.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// Widths of the box that are tried, over the root of all rectangles' area.
constexpr double kNarrowest = 0.9, kWidest = 1.7, kWidthStep = 0.05;

/// The upper rim of what has been placed, as steps from left to right.
class Skyline {
 public:
  explicit Skyline(double width) : width_(width), steps_{{0, 0}} {}

  /// Puts a rectangle, no wider than the box, where its top comes lowest, the leftmost of several.
  Complex place(Complex size) {
    std::size_t best = 0;
    double low = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < steps_.size() && fits(steps_[n].x, size); ++n) {
      const double y = restsAt(n, size.real());
      if (y >= low) continue;
      low = y;
      best = n;
    }
    const Complex corner(steps_[best].x, low);
    cover(best, size.real(), low + size.imag());
    return corner;
  }

 private:
  struct Step {
    double x, y;  ///< From x to the next step's, or to the width.
  };

  /// The first step always fits, whatever rounding makes of the width.
  bool fits(double x, Complex size) const { return x == 0 || x + size.real() <= width_; }

  double restsAt(std::size_t n, double width) const {
    double y = 0;
    for (std::size_t m = n; m < steps_.size() && (m == n || steps_[m].x < steps_[n].x + width);
         ++m) {
      y = std::max(y, steps_[m].y);
    }
    return y;
  }

  void cover(std::size_t n, double width, double top) {
    const double left = steps_[n].x, right = left + width;
    double beyond = steps_[n].y;
    auto end = steps_.begin() + static_cast<std::ptrdiff_t>(n);
    const auto begin = end;
    while (end != steps_.end() && end->x < right) beyond = (end++)->y;
    const bool reaches = end == steps_.end() ? right >= width_ : end->x <= right;
    const auto next = steps_.erase(begin, end);
    const auto placed = steps_.insert(next, Step{left, top});
    if (!reaches) steps_.insert(placed + 1, Step{right, beyond});
  }

  double width_;
  std::vector<Step> steps_;
};

struct Packing {
  std::vector<Complex> corners;
  double side = std::numeric_limits<double>::infinity();  ///< Of the square around all.
};

Packing packInto(double width, const std::vector<Complex>& sizes,
                 const std::vector<std::size_t>& order) {
  Packing packing{std::vector<Complex>(sizes.size()), 0};
  Skyline skyline(width);
  for (const std::size_t n : order) {
    packing.corners[n] = skyline.place(sizes[n]);
    const Complex far = packing.corners[n] + sizes[n];
    packing.side = std::max({packing.side, far.real(), far.imag()});
  }
  return packing;
}

}  // namespace

std::vector<Complex> packRectangles(const std::vector<Complex>& sizes, double gap) {
  // With the gap to the right and above.
  std::vector<Complex> wide;
  double area = 0, widest = 0;
  for (const Complex& size : sizes) {
    wide.push_back(size + Complex(gap, gap));
    area += wide.back().real() * wide.back().imag();
    widest = std::max(widest, wide.back().real());
  }
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return wide[a].imag() > wide[b].imag(); });
  Packing best;
  for (double factor = kNarrowest; factor < kWidest; factor += kWidthStep) {
    Packing packing = packInto(std::max(widest, factor * std::sqrt(area)), wide, order);
    if (packing.side < best.side) best = std::move(packing);
  }
  return best.corners;
}

void packIslands(const Connectivity& surface, const std::vector<Index>& island, double margin,
                 std::vector<Complex>& points, std::vector<Index>& corner, double grid) {
  if (island.empty()) return;
  std::vector<Eigen::AlignedBox2d> boxes(1 + *std::max_element(island.begin(), island.end()));
  double area = 0;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const Complex from = points[corner[h]], to = points[corner[Connectivity::next(h)]];
    boxes[island[Connectivity::faceOf(h)]].extend(Eigen::Vector2d(from.real(), from.imag()));
    area += std::imag(std::conj(from) * to) / 2;
  }
  double gap = margin * std::sqrt(std::abs(area));
  if (grid > 0) {
    gap = grid * std::max(1.0, std::ceil(gap / grid));
    for (Eigen::AlignedBox2d& box : boxes) {
      box = {grid * (box.min() / grid).array().floor().matrix(),
             grid * (box.max() / grid).array().ceil().matrix()};
    }
  }
  std::vector<Complex> shifts;
  for (const Eigen::AlignedBox2d& box : boxes) {
    shifts.emplace_back(box.sizes().x(), box.sizes().y());
  }
  shifts = packRectangles(shifts, gap);
  for (std::size_t n = 0; n < boxes.size(); ++n) {
    shifts[n] -= Complex(boxes[n].min().x(), boxes[n].min().y());
  }
  std::vector<Complex> placed(surface.halfedgeCount());
  std::vector<bool> seam(surface.edgeCount());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const Index own = island[Connectivity::faceOf(h)];
    placed[h] = points[corner[h]] + shifts[own];
    seam[surface.edge(h)] =
        !isSewn(surface, corner, h) || island[Connectivity::faceOf(surface.twin(h))] != own;
  }
  PlanarLayout layout = sewCorners(surface, seam, placed);
  points = std::move(layout.points);
  corner = std::move(layout.corner);
}

}  // namespace moduli
