#include "client/cli/map_drawing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace moduli::cli {
namespace {

using namespace vec3;

using Kind = MapEdge::Kind;

std::vector<Vec3> triples(std::span<const double> numbers) {
  std::vector<Vec3> rows(numbers.size() / 3);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
  }
  return rows;
}

std::vector<Vec3> planePoints(const std::vector<double>& numbers) {
  std::vector<Vec3> rows(numbers.size() / 2);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = {numbers[2 * i], numbers[2 * i + 1], 0};
  return rows;
}

// Vertices without an image stand at 0.
std::vector<Vec3> spherePoints(const std::vector<double>& numbers) {
  std::vector<Vec3> rows = triples(numbers);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (Vec3& p : rows) p = dot(p, p) > 0.25 ? normalized(p) : Vec3{kNone, kNone, kNone};
  return rows;
}

bool inRange(const CornerIndices& face, std::size_t count) {
  return std::all_of(face.begin(), face.end(),
                     [=](int i) { return i >= 0 && static_cast<std::size_t>(i) < count; });
}

void takeFaces(const ParameterizedMesh& map, MapDrawing& drawing) {
  const std::size_t vertices = map.positions.size() / 3;
  for (std::size_t i = 0; i + 2 < map.faces.size(); i += 3) {
    const CornerIndices face = {map.faces[i], map.faces[i + 1], map.faces[i + 2]};
    if (!inRange(face, vertices)) continue;
    CornerIndices corners = {-1, -1, -1};
    if (drawing.on_sphere) {
      corners = face;
    } else if (i + 2 < map.corners.size()) {
      corners = {map.corners[i], map.corners[i + 1], map.corners[i + 2]};
    }
    const bool mapped = inRange(corners, drawing.points.size()) &&
                        std::all_of(corners.begin(), corners.end(), [&](int i_point) {
                          return finite(drawing.points[static_cast<std::size_t>(i_point)]);
                        });
    drawing.faces.push_back(face);
    drawing.corners.push_back(mapped ? corners : CornerIndices{-1, -1, -1});
  }
}

// Positive where the image keeps its orientation.
double orientation(const MapDrawing& drawing, const CornerIndices& corners) {
  const Vec3& a = drawing.points[corners[0]];
  const Vec3& b = drawing.points[corners[1]];
  const Vec3& c = drawing.points[corners[2]];
  if (drawing.on_sphere) return dot(a, cross(b - a, c - a));
  return cross(b - a, c - a)[2];
}

void judgeFaces(MapDrawing& drawing) {
  drawing.folded.assign(drawing.faces.size(), false);
  for (std::size_t f = 0; f < drawing.faces.size(); ++f) {
    const CornerIndices& corners = drawing.corners[f];
    if (corners[0] < 0) continue;
    drawing.folded[f] = !(orientation(drawing, corners) > 0);
    const Vec3& a = drawing.points[corners[0]];
    const Vec3 n = cross(drawing.points[corners[1]] - a, drawing.points[corners[2]] - a);
    drawing.image_area += std::sqrt(dot(n, n)) / 2;
    drawing.mapped.push_back(static_cast<int>(f));
  }
  std::stable_partition(drawing.mapped.begin(), drawing.mapped.end(),
                        [&](int f) { return drawing.folded[f]; });
}

using Pair = std::pair<int, int>;

Pair sorted(const std::array<int, 2>& ends) {
  return {std::min(ends[0], ends[1]), std::max(ends[0], ends[1])};
}

// Of one edge of the surface [begin, end): neighbours in the image become one edge.
template <typename Iterator>
void classify(Iterator begin, Iterator end, std::vector<MapEdge>& edges) {
  for (auto it = begin; it != end;) {
    auto same = it;
    while (same != end && sorted(same->points) == sorted(it->points)) ++same;
    MapEdge edge = *it;
    if (same - it == 1) edge.kind = end - begin == 1 ? Kind::kBoundary : Kind::kSeam;
    edges.push_back(edge);
    it = same;
  }
}

void findEdges(MapDrawing& drawing) {
  std::vector<MapEdge> sides;
  sides.reserve(3 * drawing.mapped.size());
  for (const int f : drawing.mapped) {
    for (int c = 0; c < 3; ++c) {
      const int d = (c + 1) % 3;
      sides.push_back({{drawing.faces[f][c], drawing.faces[f][d]},
                       {drawing.corners[f][c], drawing.corners[f][d]}});
    }
  }
  // Stable, so that the direction of an edge does not depend on the library.
  std::stable_sort(sides.begin(), sides.end(), [](const MapEdge& a, const MapEdge& b) {
    return std::pair(sorted(a.vertices), sorted(a.points)) <
           std::pair(sorted(b.vertices), sorted(b.points));
  });
  for (auto it = sides.begin(); it != sides.end();) {
    const auto end = std::find_if(it, sides.end(), [&](const MapEdge& other) {
      return sorted(other.vertices) != sorted(it->vertices);
    });
    classify(it, end, drawing.edges);
    it = end;
  }
}

}  // namespace

std::vector<double> extendToVertices(std::span<const double> rows, std::size_t columns,
                                     std::size_t vertices,
                                     const std::vector<CornerIndices>& faces) {
  const std::size_t known = std::min(vertices, rows.size() / columns);
  std::vector<double> values(rows.begin(),
                             rows.begin() + static_cast<std::ptrdiff_t>(known * columns));
  values.resize(vertices * columns, std::numeric_limits<double>::quiet_NaN());
  if (known == vertices) return values;
  // Waves of means from what is known, then smoothing.
  constexpr int kSweeps = 40;
  std::vector<bool> has(vertices, false);
  std::fill(has.begin(), has.begin() + static_cast<std::ptrdiff_t>(known), true);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    std::vector<double> sum((vertices - known) * columns, 0.0);
    std::vector<int> count(vertices - known, 0);
    for (const CornerIndices& face : faces) {
      for (int k = 0; k < 6; ++k) {
        const auto to = static_cast<std::size_t>(face[k % 3]);
        const auto from = static_cast<std::size_t>(face[(k % 3 + 1 + k / 3) % 3]);
        if (to < known || !has[from]) continue;
        ++count[to - known];
        for (std::size_t i = 0; i < columns; ++i) {
          sum[(to - known) * columns + i] += values[from * columns + i];
        }
      }
    }
    for (std::size_t v = known; v < vertices; ++v) {
      if (count[v - known] == 0) continue;
      has[v] = true;
      for (std::size_t i = 0; i < columns; ++i) {
        values[v * columns + i] = sum[(v - known) * columns + i] / count[v - known];
      }
    }
  }
  return values;
}

MapDrawing makeDrawing(const ParameterizedMesh& map, std::span<const double> space) {
  MapDrawing drawing;
  drawing.on_sphere = map.result.target() == v1::ParameterizationOptions::SPHERE;
  drawing.points = drawing.on_sphere ? spherePoints(map.positions) : planePoints(map.points);
  takeFaces(map, drawing);
  judgeFaces(drawing);
  findEdges(drawing);
  if (!space.empty()) {
    drawing.surface = triples(extendToVertices(space, 3, map.positions.size() / 3, drawing.faces));
  } else if (!drawing.on_sphere) {
    drawing.surface = triples(map.positions);
  }
  return drawing;
}

}  // namespace moduli::cli
