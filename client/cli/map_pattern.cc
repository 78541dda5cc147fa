#include "client/cli/map_pattern.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

namespace moduli::cli {
namespace {

using std::numbers::pi;

using Options = v1::ParameterizationOptions;

constexpr int kSectors = 24;
constexpr double kAngle = 2 * pi / kSectors;
constexpr long long kLeastRows = 9;  // Of rings a disk of 0.095 is left, at poles 10.8 degrees.
constexpr long long kMostRows = 60;
constexpr double kLargestShare = 0.04;  // Of the surface in one cell; the mean is about 0.004.
constexpr int kMostCuts = 8;
constexpr long long kMostColumns = 280;
constexpr int kSubdivision = 8;  // Parts of a curved side.

// Restrained colours of equal lightness; x and y in [-1, 1].
Color tint(double x, double y) {
  constexpr double kCorners[4][3] = {
      {74, 102, 146}, {62, 134, 140}, {132, 98, 142}, {178, 128, 84}};
  const double u = (std::clamp(x, -1.0, 1.0) + 1) / 2, v = (std::clamp(y, -1.0, 1.0) + 1) / 2;
  const double weights[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
  std::array<std::uint8_t, 3> channels{};
  for (int k = 0; k < 3; ++k) {
    double sum = 0;
    for (int i = 0; i < 4; ++i) sum += weights[i] * kCorners[i][k];
    channels[k] = static_cast<std::uint8_t>(std::lround(sum));
  }
  return {channels[0], channels[1], channels[2]};
}

// Beyond all cells, where a point is not finite or far outside.
long long cellOf(double coordinate) {
  constexpr double kFar = 1e15;
  if (!(std::abs(coordinate) < kFar)) return std::numeric_limits<long long>::max() / 16;
  return static_cast<long long>(std::floor(coordinate));
}

struct Box {
  double low[2] = {0, 0}, size[2] = {0, 0};
};

Box boxOf(const MapDrawing& drawing) {
  Box box;
  double high[2] = {0, 0};
  bool any = false;
  for (const int f : drawing.mapped) {
    for (const int i : drawing.corners[f]) {
      for (int k = 0; k < 2; ++k) {
        const double x = drawing.points[i][k];
        box.low[k] = any ? std::min(box.low[k], x) : x;
        high[k] = any ? std::max(high[k], x) : x;
      }
      any = true;
    }
  }
  for (int k = 0; k < 2; ++k) box.size[k] = high[k] - box.low[k];
  return box;
}

double areaOf(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n =
      vec3::cross({b[0] - a[0], b[1] - a[1], b[2] - a[2]}, {c[0] - a[0], c[1] - a[1], c[2] - a[2]});
  return std::sqrt(vec3::dot(n, n)) / 2;
}

long long power3(int exponent) {
  return exponent == 0 ? 1 : 3 * power3(exponent - 1);
}

}  // namespace

Pattern::Pattern(const MapDrawing& drawing, Options::Target target) : kind_(Kind::kSquares) {
  if (drawing.on_sphere) {
    kind_ = Kind::kParallels;
  } else if (target == Options::DISK || target == Options::CIRCLE_DOMAIN) {
    kind_ = Kind::kRings;
  } else if (target == Options::QUADS) {
    unitSquares(drawing);
    return;
  } else {
    fitSquares(drawing, target == Options::RECTANGLE);
  }
  if (kind_ != Kind::kSquares) {
    side_ = kAngle;
    columns_ = kSectors;
    rows_ = kLeastRows;
  }
  std::vector<Piece> pieces = piecesOf(drawing);
  double total = 0;
  for (const Piece& piece : pieces) total += piece.area;
  if (!std::isfinite(total)) return;
  if (kind_ != Kind::kSquares) addRows(pieces, kLargestShare * total);
  cut(std::move(pieces), kLargestShare * total);
}

// Faces count where their middle is.
std::vector<Pattern::Piece> Pattern::piecesOf(const MapDrawing& drawing) const {
  std::vector<Piece> pieces;
  if (drawing.surface.empty()) return pieces;
  for (const int f : drawing.mapped) {
    const CornerIndices& face = drawing.faces[f];
    const CornerIndices& corners = drawing.corners[f];
    Vec3 middle{};
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) middle[axis] += drawing.points[corners[k]][axis] / 3;
    }
    const double area =
        areaOf(drawing.surface[face[0]], drawing.surface[face[1]], drawing.surface[face[2]]);
    if (std::isfinite(area)) pieces.push_back({cellCoordinates(middle), area});
  }
  return pieces;
}

// Goes on towards the centre or the poles until little of the surface is left there.
void Pattern::addRows(const std::vector<Piece>& pieces, double largest) {
  std::vector<double> beyond(kMostRows + 1, 0.0);  // Area that so many rows do not reach.
  for (const Piece& piece : pieces) {
    const double row = std::abs(piece.place[1]);
    for (long long r = kLeastRows; r <= kMostRows && !(row < static_cast<double>(r)); ++r) {
      beyond[static_cast<std::size_t>(r)] += piece.area;
    }
  }
  while (rows_ < kMostRows && beyond[static_cast<std::size_t>(rows_)] > largest) ++rows_;
}

void Pattern::cut(std::vector<Piece> pieces, double largest) {
  for (int level = 0; level < kMostCuts && !pieces.empty(); ++level) {
    std::map<Index, double> areas;
    for (const Piece& piece : pieces) areas[indexAt(piece.place, level)] += piece.area;
    for (const auto& [index, area] : areas) {
      if (area > largest && isCell(index)) cut_.insert(index);
    }
    std::erase_if(pieces,
                  [&](const Piece& piece) { return !cut_.contains(indexAt(piece.place, level)); });
  }
}

// About 16 x 16 cells; a rectangle has whole ones from bottom to top.
void Pattern::fitSquares(const MapDrawing& drawing, bool height_is_whole) {
  const Box box = boxOf(drawing);
  const double longest = std::max(box.size[0], box.size[1]);
  double side = std::sqrt(drawing.image_area) / 16;
  if (!std::isfinite(side) || !std::isfinite(longest) || !(longest > 0)) return;
  side = std::clamp(side, longest / kMostColumns, longest);
  if (height_is_whole && box.size[1] > 0) {
    side = box.size[1] / std::max(1.0, std::round(box.size[1] / side));
    side = std::max(side, longest / kMostColumns);
  }
  side_ = side;
  origin_ = {box.low[0], box.low[1]};
  const auto cells = [side](double length) {
    // Not one more for the rounding of a size that is whole.
    return std::max(1LL, static_cast<long long>(std::ceil(length / side - 1e-9)));
  };
  columns_ = cells(box.size[0]);
  rows_ = cells(box.size[1]);
}

// Lines go on across cuts, so that blocks of an odd number of squares would not.
void Pattern::unitSquares(const MapDrawing& drawing) {
  const Box box = boxOf(drawing);
  const double longest = std::max(box.size[0], box.size[1]);
  if (!std::isfinite(longest) || !(longest > 0)) return;
  side_ = std::max(1.0, std::ceil(longest / static_cast<double>(kMostColumns - 2)));
  for (int k = 0; k < 2; ++k) origin_[k] = side_ * std::floor(box.low[k] / side_);
  const auto cells = [&](int k) {
    const double end = std::ceil((box.low[k] + box.size[k] - origin_[k]) / side_);
    return std::max(1LL, static_cast<long long>(end));
  };
  columns_ = cells(0);
  rows_ = cells(1);
}

std::array<double, 2> Pattern::cellCoordinates(const Vec3& point) const {
  if (kind_ == Kind::kSquares) {
    return {(point[0] - origin_[0]) / side_, (point[1] - origin_[1]) / side_};
  }
  const double angle = std::atan2(point[1], point[0]);
  const double turn = angle < 0 ? angle + 2 * pi : angle;
  const double radius = std::hypot(point[0], point[1]);
  if (kind_ == Kind::kRings) {
    // What lies on the rim belongs to the outermost ring, whatever the rounding.
    return {turn / side_, std::max(0.0, -std::log(radius) / side_)};
  }
  return {turn / side_, std::asinh(point[2] / radius) / side_};
}

Vec3 Pattern::pointAt(double x, double y) const {
  if (kind_ == Kind::kSquares) return {origin_[0] + x * side_, origin_[1] + y * side_, 0};
  const double radius = kind_ == Kind::kRings ? std::exp(-y * side_) : 1 / std::cosh(y * side_);
  const double height = kind_ == Kind::kRings ? 0 : std::tanh(y * side_);
  return {radius * std::cos(x * side_), radius * std::sin(x * side_), height};
}

Pattern::Index Pattern::indexAt(const std::array<double, 2>& place, int level) const {
  const auto parts = static_cast<double>(power3(level));
  Index index{cellOf(place[0] * parts), cellOf(place[1] * parts), level};
  // A whole turn, by rounding, is none.
  if (kind_ != Kind::kSquares) index.i %= columns_ * power3(level);
  return index;
}

bool Pattern::isCell(const Index& index) const {
  const long long parts = power3(index.level);
  const long long first = kind_ == Kind::kParallels ? -rows_ * parts : 0;
  return index.i >= 0 && index.i < columns_ * parts && index.j >= first && index.j < rows_ * parts;
}

// Cells cut in 3 x 3 keep the parity of their middle, so that the board goes on across sizes.
Color Pattern::colorOf(const Index& index) const {
  if (!isCell(index) || (index.i + index.j) % 2 == 0) return kPatternLight;
  const auto parts = static_cast<double>(power3(index.level));
  const double u = (static_cast<double>(index.i) + 0.5) / parts;
  const double v = (static_cast<double>(index.j) + 0.5) / parts;
  if (kind_ == Kind::kSquares) {
    return tint(2 * u / static_cast<double>(columns_) - 1, 2 * v / static_cast<double>(rows_) - 1);
  }
  const double radius = kind_ == Kind::kRings ? std::exp(-v * side_) : 1;
  return tint(radius * std::cos(u * side_), radius * std::sin(u * side_));
}

Color Pattern::at(const Vec3& point) const {
  const std::array<double, 2> place = cellCoordinates(point);
  Index index = indexAt(place, 0);
  while (cut_.contains(index)) index = indexAt(place, index.level + 1);
  return colorOf(index);
}

void Pattern::addDarkCells(const Index& index, std::vector<Cell>& cells) const {
  if (cut_.contains(index)) {
    for (int k = 0; k < 9; ++k) {
      addDarkCells({3 * index.i + k % 3, 3 * index.j + k / 3, index.level + 1}, cells);
    }
    return;
  }
  Cell cell{{}, colorOf(index)};
  if (cell.color == kPatternLight) return;
  const int parts = kind_ == Kind::kSquares ? 1 : std::max(1, kSubdivision >> index.level);
  const double size = 1 / static_cast<double>(power3(index.level));
  constexpr double kCorners[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
  for (int side = 0; side < 4; ++side) {
    for (int k = 0; k < parts; ++k) {
      const double t = static_cast<double>(k) / parts;
      const double x = (1 - t) * kCorners[side][0] + t * kCorners[side + 1][0];
      const double y = (1 - t) * kCorners[side][1] + t * kCorners[side + 1][1];
      cell.outline.push_back(pointAt((static_cast<double>(index.i) + x) * size,
                                     (static_cast<double>(index.j) + y) * size));
    }
  }
  cells.push_back(std::move(cell));
}

std::vector<Pattern::Cell> Pattern::darkCells() const {
  std::vector<Cell> cells;
  for (long long j = kind_ == Kind::kParallels ? -rows_ : 0; j < rows_; ++j) {
    for (long long i = 0; i < columns_; ++i) addDarkCells({i, j, 0}, cells);
  }
  return cells;
}

FieldColors::FieldColors(std::vector<double> values) : values_(std::move(values)) {
  std::vector<double> finite;
  std::copy_if(values_.begin(), values_.end(), std::back_inserter(finite),
               [](double x) { return std::isfinite(x); });
  if (finite.empty()) return;
  std::sort(finite.begin(), finite.end());
  const std::size_t out = finite.size() / 50;
  low_ = finite[out];
  high_ = finite[finite.size() - 1 - out];
  if (low_ < 0 && high_ > 0) {
    high_ = std::max(high_, -low_);
    low_ = -high_;
  }
}

Color FieldColors::at(const CornerIndices& face, const Vec3& weights) const {
  double value = 0;
  for (int k = 0; k < 3; ++k) {
    const auto v = static_cast<std::size_t>(face[k]);
    value += v < values_.size() ? weights[k] * values_[v] : std::nan("");
  }
  if (!std::isfinite(value)) return kUnmappedColor;
  if (low_ < 0 && high_ > 0) return divergingColor(value / high_);
  const double range = high_ - low_;
  return sequentialColor(range > 0 ? (value - low_) / range : 0.5);
}

}  // namespace moduli::cli
