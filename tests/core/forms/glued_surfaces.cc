#include "tests/core/forms/glued_surfaces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/mesh/disjoint_sets.h"
#include "core/mesh/double_cover.h"

namespace moduli {
namespace {

using Point = std::complex<double>;
using PlaneTriangle = std::array<Point, 3>;
using Gluing = std::vector<std::pair<GluedSide, GluedSide>>;

Point onCircle(double turn) {
  return std::polar(1.0, 2 * std::numbers::pi * turn);
}

/// PSL(2, 7): matrices modulo 7 of determinant 1, up to sign.
class KleinGroup {
 public:
  using Element = std::array<int, 4>;

  static Element normal(Element m) {
    Element opposite{};
    for (int k = 0; k < 4; ++k) {
      m[k] = (m[k] % 7 + 7) % 7;
      opposite[k] = (7 - m[k]) % 7;
    }
    return std::min(m, opposite);
  }
  static Element multiply(const Element& a, const Element& b) {
    return normal({a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2],
                   a[2] * b[1] + a[3] * b[3]});
  }
  static int order(const Element& a) {
    int n = 1;
    for (Element power = a; power != normal({1, 0, 0, 1}); power = multiply(power, a)) ++n;
    return n;
  }
  static std::set<Element> elements() {
    std::set<Element> all;
    for (int a = 0; a < 7; ++a) {
      for (int b = 0; b < 7; ++b) {
        for (int c = 0; c < 7; ++c) {
          for (int d = 0; d < 7; ++d) {
            if ((a * d - b * c + 49) % 7 == 1) all.insert(normal({a, b, c, d}));
          }
        }
      }
    }
    return all;
  }
};

}  // namespace

MetricSurface glueTriangles(const std::vector<PlaneTriangle>& triangles, const Gluing& gluing) {
  const auto count = static_cast<Index>(triangles.size());
  std::vector<Index> twin(3 * count, kNone);
  DisjointSets classes(3 * count);
  const auto halfedge = [](const GluedSide& side) { return 3 * side.first + side.second; };
  for (const auto& [a, b] : gluing) {
    const Index h = halfedge(a);
    const Index k = halfedge(b);
    twin[h] = k;
    twin[k] = h;
    classes.join(h, Connectivity::next(k));
    classes.join(k, Connectivity::next(h));
  }
  std::map<Index, Index> vertices;
  std::vector<Triangle> faces(count);
  std::vector<double> lengths(3 * count);
  for (Index h = 0; h < 3 * count; ++h) {
    const auto next = static_cast<Index>(vertices.size());
    faces[h / 3][h % 3] = vertices.try_emplace(classes.root(h), next).first->second;
    const PlaneTriangle& triangle = triangles[h / 3];
    lengths[h] = std::abs(triangle[(h + 1) % 3] - triangle[h % 3]);
  }
  return fromHalfedges(static_cast<Index>(vertices.size()), std::move(faces), std::move(twin),
                       lengths);
}

MetricSurface squareTiledL() {
  const std::array<Point, 3> corner{Point(0, 0), {1, 0}, {0, 1}};
  const std::array<Index, 3> right{1, 0, 2};
  const std::array<Index, 3> above{2, 1, 0};
  std::vector<PlaneTriangle> triangles;
  Gluing gluing;
  for (Index s = 0; s < 3; ++s) {
    const Point o = corner[s];
    triangles.push_back({o, o + 1.0, o + Point(1, 1)});
    triangles.push_back({o, o + Point(1, 1), o + Point(0, 1)});
    gluing.push_back({{2 * s, 2}, {2 * s + 1, 0}});
    gluing.push_back({{2 * s, 1}, {2 * right[s] + 1, 2}});
    gluing.push_back({{2 * s + 1, 1}, {2 * above[s], 0}});
  }
  return glueTriangles(triangles, gluing);
}

MetricSurface gluedPolygon(int sides) {
  std::vector<PlaneTriangle> triangles;
  Gluing gluing;
  for (Index k = 0; k < sides; ++k) {
    triangles.push_back({0, onCircle(1.0 * k / sides), onCircle((k + 1.0) / sides)});
    gluing.push_back({{k, 2}, {(k + 1) % sides, 0}});
    if (2 * k < sides) gluing.push_back({{k, 1}, {k + sides / 2, 1}});
  }
  return glueTriangles(triangles, gluing);
}

MetricSurface hexagonCover() {
  // Hexagons 0 and 1 are the two sheets of the front, 2 and 3 those of the back.
  std::vector<PlaneTriangle> triangles;
  Gluing gluing;
  for (Index hexagon = 0; hexagon < 4; ++hexagon) {
    for (Index k = 0; k < 6; ++k) {
      triangles.push_back({0, onCircle(k / 6.0), onCircle((k + 1) / 6.0)});
      gluing.push_back({{6 * hexagon + k, 2}, {6 * hexagon + (k + 1) % 6, 0}});
    }
  }
  for (Index k = 0; k < 6; ++k) {
    for (Index sheet = 0; sheet < 2; ++sheet) {
      // Sheets change across every second side: once around each corner.
      const Index other = k % 2 == 0 ? sheet : 1 - sheet;
      gluing.push_back({{6 * sheet + k, 1}, {6 * (2 + other) + 5 - k, 1}});
    }
  }
  return glueTriangles(triangles, gluing);
}

MetricSurface octahedronCover() {
  // Corners x, -x, y, -y, z, -z; an odd number of the cut edges at each of them.
  const std::vector<std::array<int, 3>> faces{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                              {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const std::set<std::pair<int, int>> cuts{{0, 4}, {1, 2}, {3, 5}};
  std::map<std::pair<int, int>, GluedSide> side;
  for (Index f = 0; f < 8; ++f) {
    for (Index c = 0; c < 3; ++c) side[{faces[f][c], faces[f][(c + 1) % 3]}] = {f, c};
  }
  const std::vector<PlaneTriangle> triangles(16, {0, 1, onCircle(1.0 / 6)});
  Gluing gluing;
  for (const auto& [ends, here] : side) {
    if (ends.first > ends.second) continue;
    const GluedSide there = side[{ends.second, ends.first}];
    for (Index sheet = 0; sheet < 2; ++sheet) {
      const Index other = cuts.contains(ends) ? 1 - sheet : sheet;
      gluing.push_back(
          {{8 * sheet + here.first, here.second}, {8 * other + there.first, there.second}});
    }
  }
  return glueTriangles(triangles, gluing);
}

MetricSurface kleinQuartic() {
  using Element = KleinGroup::Element;
  const std::set<Element> elements = KleinGroup::elements();
  // s turns a face, t crosses an edge, their product turns around a vertex.
  Element s{}, t{};
  for (const Element& a : elements) {
    if (KleinGroup::order(a) != 3) continue;
    for (const Element& b : elements) {
      if (KleinGroup::order(b) != 2 || KleinGroup::order(KleinGroup::multiply(a, b)) != 7) continue;
      s = a;
      t = b;
    }
  }
  std::map<Element, GluedSide> side;
  Index count = 0;
  for (Element g : elements) {
    if (side.contains(g)) continue;
    for (Index c = 0; c < 3; ++c) {
      side[g] = {count, c};
      g = KleinGroup::multiply(g, s);
    }
    ++count;
  }
  Gluing gluing;
  for (const auto& [g, here] : side) {
    const GluedSide there = side[KleinGroup::multiply(g, t)];
    if (here < there) gluing.push_back({here, there});
  }
  return glueTriangles(std::vector<PlaneTriangle>(count, {0, 1, onCircle(1.0 / 6)}), gluing);
}

MetricSurface plate(int nx, int ny, const std::set<std::pair<int, int>>& holes) {
  std::vector<Eigen::Vector3d> positions;
  std::map<std::pair<int, int>, Index> vertex;
  std::vector<Triangle> faces;
  const auto corner = [&](int i, int j) {
    const auto [place, fresh] = vertex.try_emplace({i, j}, static_cast<Index>(positions.size()));
    if (fresh) positions.emplace_back(i, j, 0);
    return place->second;
  };
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < ny; ++j) {
      if (holes.contains({i, j})) continue;
      const std::array<Index, 4> ring{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1),
                                      corner(i, j + 1)};
      const auto centre = static_cast<Index>(positions.size());
      positions.emplace_back(i + 0.5, j + 0.5, 0);
      for (int k = 0; k < 4; ++k) faces.push_back({ring[k], ring[(k + 1) % 4], centre});
    }
  }
  return fromPositions(positions, std::move(faces));
}

MetricSurface squareFrame(int half, int m) {
  std::set<std::pair<int, int>> holes;
  for (int i = half - m; i < half + m; ++i) {
    for (int j = half - m; j < half + m; ++j) holes.insert({i, j});
  }
  return plate(2 * half, 2 * half, holes);
}

MetricSurface doubled(const MetricSurface& bordered) {
  auto cover = doubleCover(bordered.surface);
  std::vector<double> lengths;
  for (const Index e : cover->edge) lengths.push_back(bordered.lengths[e]);
  return {std::move(cover->connectivity), std::move(lengths)};
}

}  // namespace moduli
