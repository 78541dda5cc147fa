#include "tests/client/small_maps.h"

#include <cmath>
#include <numbers>

namespace moduli {
namespace {

using std::numbers::pi;

void addFace(ParameterizedMesh& map, int a, int b, int c) {
  map.faces.insert(map.faces.end(), {a, b, c});
}

// The image of a vertex is (x, y).
void mapByPlace(ParameterizedMesh& map) {
  for (std::size_t v = 0; v < map.positions.size(); v += 3) {
    map.points.insert(map.points.end(), {map.positions[v], map.positions[v + 1]});
  }
  map.corners = map.faces;
}

void tear(ParameterizedMesh& map) {
  std::vector<double> points;
  for (std::size_t k = 0; k < map.corners.size(); ++k) {
    const auto v = static_cast<std::size_t>(map.corners[k]);
    points.insert(points.end(), {map.points[2 * v], map.points[2 * v + 1]});
    map.corners[k] = static_cast<std::int32_t>(k);
  }
  map.points = points;
}

}  // namespace

ParameterizedMesh gridMap(int n, bool torn) {
  ParameterizedMesh map;
  map.result.set_target(v1::ParameterizationOptions::FLAT);
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double x = double(i) / n, y = double(j) / n;
      map.positions.insert(map.positions.end(), {x, y, x / 2});
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, b = a + n + 1;
      addFace(map, a, b, b + 1);
      addFace(map, a, b + 1, a + 1);
    }
  }
  mapByPlace(map);
  if (torn) tear(map);
  return map;
}

ParameterizedMesh diskMap(int n) {
  ParameterizedMesh map;
  map.result.set_target(v1::ParameterizationOptions::DISK);
  map.positions = {0, 0, 0};
  for (int r = 1; r <= n; ++r) {
    for (int k = 0; k < 6 * r; ++k) {
      const double angle = pi * k / (3 * r), radius = double(r) / n;
      map.positions.insert(map.positions.end(),
                           {radius * std::cos(angle), radius * std::sin(angle), 0});
    }
  }
  // Ring r starts behind the center and the 6 (1 + ... + (r - 1)) vertices of those inside.
  const auto at = [](int r, int k) { return r == 0 ? 0 : 1 + 3 * r * (r - 1) + k % (6 * r); };
  for (int r = 1; r <= n; ++r) {
    for (int s = 0; s < 6; ++s) {
      for (int k = 0; k < r; ++k) {
        addFace(map, at(r, s * r + k), at(r, s * r + k + 1), at(r - 1, s * (r - 1) + k));
        if (k == r - 1) continue;
        addFace(map, at(r, s * r + k + 1), at(r - 1, s * (r - 1) + k + 1),
                at(r - 1, s * (r - 1) + k));
      }
    }
  }
  mapByPlace(map);
  return map;
}

ParameterizedMesh ballMap(int n) {
  ParameterizedMesh map;
  map.result.set_target(v1::ParameterizationOptions::SPHERE);
  map.positions = {0, 0, 1};
  for (int i = 1; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      const double polar = pi * i / n, angle = pi * j / n;
      map.positions.insert(
          map.positions.end(),
          {std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar)});
    }
  }
  map.positions.insert(map.positions.end(), {0, 0, -1});
  const int last = 1 + 2 * n * (n - 1);
  const auto at = [=](int i, int j) {
    if (i == 0) return 0;
    return i == n ? last : 1 + 2 * n * (i - 1) + j % (2 * n);
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      if (i < n - 1) addFace(map, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      if (i > 0) addFace(map, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  map.corners.assign(map.faces.size(), -1);
  return map;
}

}  // namespace moduli
