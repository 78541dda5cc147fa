#include "core/parameterize/overlaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <queue>

#include "core/parameterize/layout.h"
#include "core/spherical/exact_sign.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Corners = std::array<Complex, 3>;

struct Box {
  double left = std::numeric_limits<double>::infinity(), low = left;
  double right = -left, high = -left;

  void add(Complex point) {
    left = std::min(left, point.real());
    right = std::max(right, point.real());
    low = std::min(low, point.imag());
    high = std::max(high, point.imag());
  }
  void add(const Box& box) {
    add(Complex(box.left, box.low));
    add(Complex(box.right, box.high));
  }
  /// Boxes that touch hold nothing that overlaps.
  bool meets(const Box& box) const {
    return left < box.right && box.left < right && low < box.high && box.low < high;
  }
};

/// Whether one side of a has all of b on the other side of its line.
bool isBeside(const Corners& a, const Corners& b) {
  for (int c = 0; c < 3; ++c) {
    const auto outside = [&](Complex p) {
      return spherical::orientationSign(a[c], a[(c + 1) % 3], p) <= 0;
    };
    if (outside(b[0]) && outside(b[1]) && outside(b[2])) return true;
  }
  return false;
}

/// Triangles in a tree of boxes.
class TriangleTree {
 public:
  TriangleTree(const std::vector<Complex>& points, const std::vector<Index>& corner) {
    const std::size_t count = corner.size() / 3;
    for (std::size_t f = 0; f < count; ++f) {
      Corners at = {points[corner[3 * f]], points[corner[3 * f + 1]], points[corner[3 * f + 2]]};
      const int sign = spherical::orientationSign(at[0], at[1], at[2]);
      if (sign < 0) std::swap(at[1], at[2]);
      corners_.push_back(at);
      Box box;
      for (const Complex& point : at) box.add(point);
      boxes_.push_back(box);
      if (sign != 0) order_.push_back(static_cast<Index>(f));
    }
    if (!order_.empty()) build(0, order_.size());
  }

  const std::vector<Index>& faces() const { return order_; }

  /// Calls `found` with every later face that overlaps this one.
  template <typename Found>
  void overlapping(Index face, const Found& found) const {
    std::vector<std::size_t> open = {0};
    while (!open.empty()) {
      const Node& node = nodes_[open.back()];
      const std::size_t self = open.back();
      open.pop_back();
      if (!node.box.meets(boxes_[face])) continue;
      if (node.second > 0) {
        open.push_back(self + 1);
        open.push_back(node.second);
        continue;
      }
      for (std::size_t n = node.begin; n < node.end; ++n) {
        const Index other = order_[n];
        if (other <= face || !boxes_[other].meets(boxes_[face])) continue;
        const Corners &a = corners_[face], &b = corners_[other];
        if (!isBeside(a, b) && !isBeside(b, a)) found(other);
      }
    }
  }

 private:
  struct Node {
    Box box;
    std::size_t begin = 0, end = 0;  ///< Of order_.
    std::size_t second = 0;          ///< The other child; the first one follows its parent.
  };

  void build(std::size_t begin, std::size_t end) {
    constexpr std::size_t kLeaf = 4;
    const std::size_t self = nodes_.size();
    Node node{{}, begin, end};
    for (std::size_t n = begin; n < end; ++n) node.box.add(boxes_[order_[n]]);
    nodes_.push_back(node);
    if (end - begin <= kLeaf) return;
    const bool wide = node.box.right - node.box.left > node.box.high - node.box.low;
    const auto middle = [&](Index f) {
      const Box& box = boxes_[f];
      return wide ? box.left + box.right : box.low + box.high;
    };
    const std::size_t half = begin + (end - begin) / 2;
    const auto at = [&](std::size_t n) { return order_.begin() + static_cast<std::ptrdiff_t>(n); };
    std::nth_element(at(begin), at(half), at(end),
                     [&](Index a, Index b) { return middle(a) < middle(b); });
    build(begin, half);
    nodes_[self].second = nodes_.size();
    build(half, end);
  }

  std::vector<Corners> corners_;  ///< Counter-clockwise.
  std::vector<Box> boxes_;
  std::vector<Index> order_;  ///< Faces with area.
  std::vector<Node> nodes_;
};

/// Grows islands that do not lie on themselves.
class IslandGrower {
 public:
  IslandGrower(const Connectivity& surface, const std::vector<Complex>& points,
               const std::vector<Index>& corner, const std::vector<std::pair<Index, Index>>& pairs)
      : surface_(surface),
        points_(points),
        corner_(corner),
        partners_(surface.faceCount()),
        island_(surface.faceCount(), kNone) {
    for (const auto& [a, b] : pairs) {
      partners_[a].push_back(b);
      partners_[b].push_back(a);
    }
  }

  /// Per face.
  std::vector<Index> run(const std::vector<Index>& before) {
    const Index count = before.empty() ? 0 : 1 + *std::max_element(before.begin(), before.end());
    std::vector<std::vector<Index>> parts(count);
    for (Index f = 0; f < surface_.faceCount(); ++f) parts[before[f]].push_back(f);
    std::reverse(parts.begin(), parts.end());
    while (!parts.empty()) {
      const std::vector<Index> part = std::move(parts.back());
      parts.pop_back();
      grow(part);
      ++islands_;
      for (std::vector<Index>& rest : restOf(part)) parts.push_back(std::move(rest));
    }
    return std::move(island_);
  }

 private:
  Complex middle(Index f) const {
    return (points_[corner_[3 * f]] + points_[corner_[3 * f + 1]] + points_[corner_[3 * f + 2]]) /
           3.0;
  }

  Index seedOf(const std::vector<Index>& part) const {
    Complex mean = 0;
    for (const Index f : part) mean += middle(f) / static_cast<double>(part.size());
    return *std::min_element(part.begin(), part.end(), [&](Index a, Index b) {
      return std::norm(middle(a) - mean) < std::norm(middle(b) - mean);
    });
  }

  /// Breadth first, past faces that would cover one of the island's.
  void grow(const std::vector<Index>& part) {
    std::queue<Index> queue;
    const auto take = [&](Index f) {
      if (island_[f] != kNone) return;
      for (const Index other : partners_[f]) {
        if (island_[other] == islands_) return;
      }
      island_[f] = islands_;
      queue.push(f);
    };
    take(seedOf(part));
    while (!queue.empty()) {
      const Index f = queue.front();
      queue.pop();
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        if (isSewn(surface_, corner_, h)) take(Connectivity::faceOf(surface_.twin(h)));
      }
    }
  }

  /// Connected pieces of what no island has taken.
  std::vector<std::vector<Index>> restOf(const std::vector<Index>& part) const {
    std::vector<std::vector<Index>> pieces;
    std::vector<bool> waiting(surface_.faceCount(), false);
    for (const Index f : part) waiting[f] = island_[f] == kNone;
    for (const Index start : part) {
      if (!waiting[start]) continue;
      waiting[start] = false;
      std::vector<Index> piece = {start};
      for (std::size_t n = 0; n < piece.size(); ++n) {
        for (Index h = 3 * piece[n]; h < 3 * piece[n] + 3; ++h) {
          if (!isSewn(surface_, corner_, h)) continue;
          const Index beside = Connectivity::faceOf(surface_.twin(h));
          if (!waiting[beside]) continue;
          waiting[beside] = false;
          piece.push_back(beside);
        }
      }
      pieces.push_back(std::move(piece));
    }
    return pieces;
  }

  const Connectivity& surface_;
  const std::vector<Complex>& points_;
  const std::vector<Index>& corner_;
  std::vector<std::vector<Index>> partners_;
  std::vector<Index> island_;
  Index islands_ = 0;
};

}  // namespace

std::vector<std::pair<Index, Index>> findOverlaps(const std::vector<Complex>& points,
                                                  const std::vector<Index>& corner,
                                                  std::size_t most) {
  const TriangleTree tree(points, corner);
  std::vector<Index> faces = tree.faces();
  std::sort(faces.begin(), faces.end());
  std::vector<std::pair<Index, Index>> pairs;
  for (const Index f : faces) {
    if (pairs.size() >= most) break;
    const auto first = static_cast<std::ptrdiff_t>(pairs.size());
    tree.overlapping(f, [&](Index other) { pairs.emplace_back(f, other); });
    std::sort(pairs.begin() + first, pairs.end());
  }
  if (pairs.size() > most) pairs.resize(most);
  return pairs;
}

std::int64_t countOverlaps(const std::vector<Complex>& points, const std::vector<Index>& corner) {
  const TriangleTree tree(points, corner);
  std::int64_t count = 0;
  for (const Index f : tree.faces()) tree.overlapping(f, [&](Index) { ++count; });
  return count;
}

std::vector<Index> islandsOf(const Connectivity& surface, const std::vector<Index>& corner) {
  std::vector<Index> twin(surface.halfedgeCount());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    twin[h] = isSewn(surface, corner, h) ? surface.twin(h) : kNone;
  }
  return piecesOf(twin);
}

Index cutOverlaps(const Connectivity& surface, std::vector<Complex>& points,
                  std::vector<Index>& corner, double margin, double grid) {
  constexpr auto kAll = std::numeric_limits<std::size_t>::max();
  std::vector<Index> island = islandsOf(surface, corner);
  // Sides that touched may overlap by a rounding error once they are moved: then once more, which
  // ends because every round cuts an island.
  for (auto pairs = findOverlaps(points, corner, kAll); !pairs.empty();
       pairs = findOverlaps(points, corner, kAll)) {
    island = IslandGrower(surface, points, corner, pairs).run(island);
    packIslands(surface, island, margin, points, corner, grid);
  }
  return island.empty() ? 0 : 1 + *std::max_element(island.begin(), island.end());
}

}  // namespace moduli
