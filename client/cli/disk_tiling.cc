#include "client/cli/disk_tiling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "client/cli/map_panels.h"

namespace moduli::cli {
namespace {

using Complex = std::complex<double>;
using Kind = MapEdge::Kind;

constexpr Color kDiskColor = {236, 238, 241};
constexpr Color kImageColor = {252, 252, 253};
constexpr Color kAxisColor = {90, 98, 112};
constexpr double kMargin = 0.97;
/// Copies farther from the middle are no pixel wide.
constexpr double kFarthest = 7;
constexpr std::size_t kMostTiles = 1000;
constexpr int kMostNeighbours = 300;
/// Outlines of copies are drawn to this, in pixels.
constexpr double kFinest = 0.35;
/// What a cut's two images differ by under its deck transformation, in the disk's coordinates.
constexpr double kSamePoint = 1e-6;

/// What a server says, less what is no translation of the disk.
std::vector<Su11> isometries(const google::protobuf::RepeatedPtrField<v1::DiskIsometry>& messages) {
  constexpr double kLargest = 1e6;
  std::vector<Su11> result;
  for (int n = 0; n < std::min(kMostNeighbours, messages.size()); ++n) {
    const Su11 g{{messages[n].a().re(), messages[n].a().im()},
                 {messages[n].b().re(), messages[n].b().im()}};
    const double size = std::abs(g.a);
    const bool sound = size < kLargest && std::abs(determinantDrift(g)) < 1e-6 * size * size &&
                       translationLength(g) > 0;
    if (sound) result.push_back(renormalized(g));
  }
  return result;
}

/// Hue in turns, saturation and lightness in [0, 1].
Color fromHsl(double hue, double saturation, double lightness) {
  const double chroma = (1 - std::abs(2 * lightness - 1)) * saturation;
  const auto channel = [&](double offset) {
    const double x = std::fmod(6 * (hue + offset), 6.0);
    const double ramp = std::clamp(2 - std::abs(x - 3), 0.0, 1.0);
    // The middle third of the wheel is high.
    return static_cast<std::uint8_t>(std::lround(255 * (lightness - chroma / 2 + chroma * ramp)));
  };
  return {channel(0.5), channel(1.0 / 6), channel(5.0 / 6)};
}

double hueOf(int neighbour) {
  // A deck transformation and its inverse stand side by side; the golden angle keeps hues apart.
  return std::fmod(0.58 + 0.618034 * (neighbour / 2), 1.0);
}
Color tileColor(int neighbour, int depth) {
  const double inverse_is_darker = neighbour % 2 == 0 ? 0 : -0.04;
  return fromHsl(hueOf(neighbour), 0.55, (depth % 2 == 1 ? 0.80 : 0.88) + inverse_is_darker);
}
Color cutColor(int neighbour) {
  return fromHsl(hueOf(neighbour), 0.75, 0.40);
}
Color geodesicColor(int number) {
  constexpr Color kColors[] = {{200, 16, 46}, {0, 92, 175},  {0, 122, 71},  {130, 40, 140},
                               {196, 98, 0},  {0, 128, 138}, {160, 0, 90},  {90, 80, 0},
                               {70, 70, 200}, {140, 60, 30}, {40, 110, 20}, {110, 110, 110}};
  return kColors[static_cast<std::size_t>(number) % std::size(kColors)];
}

/// From one end of the axis of g to the other.
std::vector<Complex> axisPoints(const Su11& g) {
  constexpr int kParts = 64;
  const auto [from, to] = axisEnds(g);
  // The point nearest to 0, and the direction there.
  const Complex middle = from + to;
  const double across = std::abs(middle) / 2;
  const double near = across > 0 ? (1 - std::sqrt(std::max(0.0, 1 - across * across))) / across : 0;
  const Complex foot = across > 0 ? near * middle / std::abs(middle) : Complex(0);
  const Su11 frame = translationTo(foot) * rotation(std::arg((to - from)));
  std::vector<Complex> points;
  for (int i = 0; i <= kParts; ++i) {
    const double way = 16.0 * i / kParts - 8;
    points.push_back(imageOf(frame, std::tanh(way / 2)));
  }
  return points;
}

/// The geodesic from a to b, both inside the disk, without b.
std::vector<Complex> geodesic(Complex a, Complex b) {
  constexpr double kStep = 0.1;
  const double length = hyperbolicDistance(a, b);
  const int parts = std::clamp(static_cast<int>(std::ceil(length / kStep)), 1, 200);
  if (parts == 1 || !std::isfinite(length)) return {a};
  const Su11 frame = edgeFrame(a, b);
  std::vector<Complex> points;
  for (int i = 0; i < parts; ++i)
    points.push_back(imageOf(frame, std::tanh(length * i / parts / 2)));
  return points;
}

/// Points of the disk found by their place.
class PointIndex {
 public:
  void add(Complex z, int number) { cells_[cell(z, 0, 0)].emplace_back(z, number); }
  /// The number of a point there; -1: none.
  int find(Complex z) const {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto found = cells_.find(cell(z, dx, dy));
        if (found == cells_.end()) continue;
        for (const auto& [point, number] : found->second) {
          if (std::abs(point - z) < kSamePoint) return number;
        }
      }
    }
    return -1;
  }

 private:
  static std::pair<std::int64_t, std::int64_t> cell(Complex z, int dx, int dy) {
    return {static_cast<std::int64_t>(std::floor(z.real() / kSamePoint)) + dx,
            static_cast<std::int64_t>(std::floor(z.imag() / kSamePoint)) + dy};
  }
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::pair<Complex, int>>> cells_;
};

/// From the disk to pixels.
class Frame {
 public:
  Frame(int width, int height)
      : x_(width / 2.0), y_(height / 2.0), scale_(DiskTiling::scale(width, height)) {}

  std::array<double, 2> operator()(Complex z) const {
    return {x_ + scale_ * z.real(), y_ - scale_ * z.imag()};
  }
  double scale() const { return scale_; }
  Outline circle() const { return circleOutline(x_, y_, scale_); }

 private:
  double x_, y_, scale_;
};

/// Leaves points out that are nearer to the one before than can be seen.
void append(Outline& outline, const std::array<double, 2>& p) {
  if (!outline.empty() &&
      std::hypot(p[0] - outline.back()[0], p[1] - outline.back()[1]) < kFinest) {
    return;
  }
  outline.push_back(p);
}

/// The geodesic from a to b in pixels.
Outline geodesicOutline(const Frame& frame, Complex a, Complex b) {
  Outline outline;
  for (const Complex z : geodesic(a, b)) outline.push_back(frame(z));
  outline.push_back(frame(b));
  return outline;
}

double sizeOf(const Outline& outline) {
  double left = std::numeric_limits<double>::infinity(), right = -left, top = left, bottom = -left;
  for (const auto& [x, y] : outline) {
    left = std::min(left, x);
    right = std::max(right, x);
    top = std::min(top, y);
    bottom = std::max(bottom, y);
  }
  return std::max(right - left, bottom - top);
}

}  // namespace

DiskTiling::DiskTiling(const MapDrawing& drawing, const ParameterizedMesh& map)
    : drawing_(drawing) {
  const v1::HyperbolicDomain& domain = map.result.hyperbolic();
  neighbours_ = isometries(domain.neighbours());
  generators_ = isometries(domain.generators());
  findSides();
  matchSides();
  findTiles();
  takeGeodesics(map);
}

double DiskTiling::scale(int width, int height) {
  return kMargin * std::min(width, height) / 2;
}

/// Edges with the image on one side balance at every point, so that a walk along them ends where it
/// began.
void DiskTiling::findSides() {
  std::unordered_map<int, std::vector<int>> next;
  for (std::size_t e = 0; e < drawing_.edges.size(); ++e) {
    const MapEdge& edge = drawing_.edges[e];
    if (edge.kind != Kind::kInner) next[edge.points[0]].push_back(static_cast<int>(e));
  }
  for (std::size_t e = 0; e < drawing_.edges.size(); ++e) {
    if (drawing_.edges[e].kind == Kind::kInner) continue;
    std::vector<Side> loop;
    for (int at = drawing_.edges[e].points[0]; !next[at].empty();) {
      const int taken = next[at].back();
      next[at].pop_back();
      const int to = drawing_.edges[taken].points[1];
      loop.push_back({at, to, -1, taken});
      at = to;
    }
    if (!loop.empty()) loops_.push_back(std::move(loop));
  }
}

/// A side lies before a neighbour that has one of its sides there, the other way round.
void DiskTiling::matchSides() {
  PointIndex index;
  std::map<std::pair<int, int>, bool> is_side;
  for (const std::vector<Side>& loop : loops_) {
    for (const Side& side : loop) {
      index.add(point(side.from), side.from);
      is_side[{side.from, side.to}] = true;
    }
  }
  for (std::vector<Side>& loop : loops_) {
    for (Side& side : loop) {
      for (std::size_t n = 0; n < neighbours_.size() && side.neighbour < 0; ++n) {
        const Su11 back = inverse(neighbours_[n]);
        const int from = index.find(imageOf(back, point(side.to)));
        if (from < 0) continue;
        const int to = index.find(imageOf(back, point(side.from)));
        if (to >= 0 && is_side.count({from, to}) > 0) side.neighbour = static_cast<int>(n);
      }
    }
  }
}

void DiskTiling::findTiles() {
  tiles_.push_back({});
  // By the place of 0, on the hyperboloid.
  std::vector<Complex> places = {0.0};
  const double least =
      std::accumulate(neighbours_.begin(), neighbours_.end(), 1.0,
                      [](double x, const Su11& g) { return std::min(x, translationLength(g)); });
  for (std::size_t i = 0; i < tiles_.size() && tiles_.size() < kMostTiles; ++i) {
    for (std::size_t n = 0; n < neighbours_.size(); ++n) {
      const Su11 place = renormalized(tiles_[i].place * neighbours_[n]);
      if (displacement(place) > kFarthest) continue;
      const Complex w = 2.0 * place.a * place.b;
      const bool known = std::any_of(places.begin(), places.end(), [&](Complex other) {
        return std::abs(other - w) < least / 4;
      });
      if (known) continue;
      places.push_back(w);
      tiles_.push_back(
          {place, i == 0 ? static_cast<int>(n) : tiles_[i].first, tiles_[i].depth + 1});
    }
  }
}

void DiskTiling::takeGeodesics(const ParameterizedMesh& map) {
  const auto row = [&](std::int32_t i) { return &map.geodesics[7 * static_cast<std::size_t>(i)]; };
  for (const v1::ClosedGeodesic& message : map.result.hyperbolic().geodesics()) {
    Geodesic geodesic;
    const std::int32_t first = message.first_point(), end = first + message.points();
    for (std::int32_t i = first; i < end; ++i) {
      const double* p = row(i);
      const double* q = row(i + 1 < end ? i + 1 : first);
      geodesic.in_space.push_back({Vec3{p[0], p[1], p[2]}, Vec3{q[0], q[1], q[2]}});
      geodesic.in_disk.push_back({Complex(p[3], p[4]), Complex(p[5], p[6])});
    }
    geodesics_.push_back(std::move(geodesic));
  }
}

std::vector<LineSet> DiskTiling::surfaceLines(double pixel) const {
  std::map<int, LineSet> cuts;
  for (const std::vector<Side>& loop : loops_) {
    for (const Side& side : loop) {
      if (side.neighbour < 0) continue;
      LineSet& lines = cuts[side.neighbour / 2];
      lines.color = cutColor(side.neighbour);
      lines.width = kSeamWidth * pixel;
      const std::array<int, 2>& ends = drawing_.edges[side.edge].vertices;
      lines.segments.push_back({drawing_.surface[ends[0]], drawing_.surface[ends[1]]});
    }
  }
  std::vector<LineSet> all;
  for (auto& [pair, lines] : cuts) all.push_back(std::move(lines));
  for (int i = 0; i < geodesicCount(); ++i) {
    all.push_back({geodesics_[i].in_space, geodesicColor(i), 2.6 * pixel});
  }
  return all;
}

std::vector<Shape> DiskTiling::shapes(int width, int height, bool edges) const {
  const Frame frame(width, height);
  std::vector<Shape> shapes = {{{frame.circle()}, {.fill = kDiskColor}}};
  for (auto tile = tiles_.rbegin(); tile != tiles_.rend(); ++tile) {
    Shape shape;
    for (const std::vector<Side>& loop : loops_) {
      Outline outline;
      for (const Side& side : loop) {
        for (const Complex z : geodesic(point(side.from), point(side.to))) {
          append(outline, frame(imageOf(tile->place, z)));
        }
      }
      shape.outlines.push_back(std::move(outline));
    }
    if (shape.outlines.empty() || sizeOf(shape.outlines.front()) < 2 * kFinest) continue;
    const Color color = tile->depth == 0 ? kImageColor : tileColor(tile->first, tile->depth);
    const bool wide = sizeOf(shape.outlines.front()) > 12;
    shape.style = {.fill = color,
                   .stroke = wide ? Color{255, 255, 255} : color,
                   .stroke_width = wide ? 0.6 : 0.3};
    shapes.push_back(std::move(shape));
  }
  if (edges) {
    Shape inner{{}, {.stroke = kEdgeColor, .stroke_width = 0.35, .opacity = 0.7}, false};
    for (const MapEdge& edge : drawing_.edges) {
      if (edge.kind != Kind::kInner) continue;
      inner.outlines.push_back(
          geodesicOutline(frame, point(edge.points[0]), point(edge.points[1])));
    }
    shapes.push_back(std::move(inner));
  }
  for (const Su11& g : generators_) {
    Outline line;
    for (const Complex z : axisPoints(g)) line.push_back(frame(z));
    shapes.push_back(
        {{std::move(line)}, {.stroke = kAxisColor, .stroke_width = 0.9, .opacity = 0.75}, false});
  }
  std::map<int, Shape> cuts;
  for (const std::vector<Side>& loop : loops_) {
    for (const Side& side : loop) {
      Shape& cut = cuts[side.neighbour < 0 ? -1 : side.neighbour / 2];
      cut.outlines.push_back(geodesicOutline(frame, point(side.from), point(side.to)));
    }
  }
  for (auto& [pair, cut] : cuts) {
    cut.closed = false;
    cut.style = {.stroke = pair < 0 ? kBoundaryColor : cutColor(2 * pair),
                 .stroke_width = kBoundaryWidth};
    shapes.push_back(std::move(cut));
  }
  for (int i = 0; i < geodesicCount(); ++i) {
    Shape line{{}, {.stroke = geodesicColor(i), .stroke_width = 2}, false};
    for (const auto& [from, to] : geodesics_[i].in_disk) {
      line.outlines.push_back(geodesicOutline(frame, from, to));
    }
    shapes.push_back(std::move(line));
  }
  shapes.push_back({{frame.circle()}, {.stroke = kBoundaryColor, .stroke_width = 1}});
  return shapes;
}

}  // namespace moduli::cli
