#pragma once

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/mesh/triangle_soup.h"

/// Small surfaces by hand, for tests: what a reader or a sample would only make harder to see.
namespace moduli::shapes {

inline TriangleSoup tetrahedron() {
  return {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
          {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
}

inline TriangleSoup octahedron() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

inline TriangleSoup icosahedron() {
  const double t = std::numbers::phi;
  return {{{-1, t, 0},
           {1, t, 0},
           {-1, -t, 0},
           {1, -t, 0},
           {0, -1, t},
           {0, 1, t},
           {0, -1, -t},
           {0, 1, -t},
           {t, 0, -1},
           {t, 0, 1},
           {-t, 0, -1},
           {-t, 0, 1}},
          {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
           {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
           {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
}

/// m x n quads on a torus of revolution, each cut in two; m, n >= 3. Oriented outwards.
inline TriangleSoup torusGrid(Index m, Index n) {
  TriangleSoup soup;
  for (Index i = 0; i < m; ++i) {
    for (Index j = 0; j < n; ++j) {
      const double u = 2 * std::numbers::pi * i / m;
      const double v = 2 * std::numbers::pi * j / n;
      const double r = 2 + std::cos(v);
      soup.vertices.emplace_back(r * std::cos(u), r * std::sin(u), std::sin(v));
      const Index a = i * n + j;
      const Index b = (i + 1) % m * n + j;
      const Index c = (i + 1) % m * n + (j + 1) % n;
      const Index d = i * n + (j + 1) % n;
      soup.faces.push_back({a, b, c});
      soup.faces.push_back({a, c, d});
    }
  }
  return soup;
}

/// (m + 1) x (n + 1) points of a flat rectangle; where keep(i, j) is false the square is left out.
template <typename Keep>
TriangleSoup plate(Index m, Index n, Keep keep) {
  TriangleSoup soup;
  std::vector<Index> number((m + 1) * (n + 1), kNone);
  const auto vertex = [&](Index i, Index j) {
    Index& at = number[i * (n + 1) + j];
    if (at == kNone) {
      at = static_cast<Index>(soup.vertices.size());
      soup.vertices.emplace_back(i, j, 0);
    }
    return at;
  };
  for (Index i = 0; i < m; ++i) {
    for (Index j = 0; j < n; ++j) {
      if (!keep(i, j)) continue;
      const Index a = vertex(i, j);
      const Index b = vertex(i + 1, j);
      const Index c = vertex(i + 1, j + 1);
      const Index d = vertex(i, j + 1);
      soup.faces.push_back({a, b, c});
      soup.faces.push_back({a, c, d});
    }
  }
  return soup;
}

inline TriangleSoup disk() {
  return plate(3, 3, [](Index, Index) { return true; });
}
inline TriangleSoup annulus() {
  return plate(3, 3, [](Index i, Index j) { return i != 1 || j != 1; });
}
inline TriangleSoup pants() {
  return plate(5, 3, [](Index i, Index j) { return j != 1 || (i != 1 && i != 3); });
}

/// A strip of n >= 3 quads with a half twist: not orientable, one boundary loop.
inline TriangleSoup moebiusStrip(Index n) {
  TriangleSoup soup;
  for (Index i = 0; i < n; ++i) {
    const double u = 2 * std::numbers::pi * i / n;
    for (const double s : {-0.5, 0.5}) {
      const double r = 2 + s * std::cos(u / 2);
      soup.vertices.emplace_back(r * std::cos(u), r * std::sin(u), s * std::sin(u / 2));
    }
    const bool last = i + 1 == n;
    const Index next = last ? 0 : 2 * i + 2;
    const Index low = last ? next + 1 : next;
    const Index high = last ? next : next + 1;
    soup.faces.push_back({2 * i, low, high});
    soup.faces.push_back({2 * i, high, 2 * i + 1});
  }
  return soup;
}

/// Three triangles at the edge (0, 1).
inline TriangleSoup threeAtAnEdge() {
  return {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
          {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
}

/// Two triangles that share vertex 0 only.
inline TriangleSoup bowTie() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}};
}

/// A second soup beside the first one, moved by `offset`.
inline TriangleSoup together(TriangleSoup a, const TriangleSoup& b,
                             const Eigen::Vector3d& offset = {10, 0, 0}) {
  const auto base = static_cast<Index>(a.vertices.size());
  for (const Eigen::Vector3d& p : b.vertices) a.vertices.push_back(p + offset);
  for (const Triangle& f : b.faces) a.faces.push_back({f[0] + base, f[1] + base, f[2] + base});
  return a;
}

/// A closed surface of genus g: g torus grids chained by removing one face of each neighbour and
/// gluing the rims. The corners meet vertex by vertex, so positions are not to be looked at.
inline TriangleSoup chainOfTori(Index genus) {
  TriangleSoup chain = torusGrid(6, 6);
  for (Index k = 1; k < genus; ++k) {
    // Face 0 of the fresh torus meets a face of the last one, far from where that was joined.
    const TriangleSoup fresh = torusGrid(6, 6);
    const auto base = static_cast<Index>(chain.vertices.size());
    const std::size_t last_face = chain.faces.size() - 30;
    const Triangle rim = chain.faces[last_face];
    chain.faces.erase(chain.faces.begin() + static_cast<std::ptrdiff_t>(last_face));
    const Triangle hole = fresh.faces[0];
    std::vector<Index> number(fresh.vertices.size(), kNone);
    for (int c = 0; c < 3; ++c) number[hole[c]] = rim[(3 - c) % 3];
    Index next = base;
    for (std::size_t v = 0; v < fresh.vertices.size(); ++v) {
      if (number[v] != kNone) continue;
      number[v] = next++;
      chain.vertices.push_back(fresh.vertices[v] + Eigen::Vector3d(10.0 * k, 0, 0));
    }
    for (std::size_t f = 1; f < fresh.faces.size(); ++f) {
      const Triangle& face = fresh.faces[f];
      chain.faces.push_back({number[face[0]], number[face[1]], number[face[2]]});
    }
  }
  return chain;
}

}  // namespace moduli::shapes
