#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/parameterize/overlaps.h"
#include "core/parameterize/parameterization.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/parameterize/layout_checks.h"
#include "tests/core/testing.h"

/// Surfaces for the targets in the plane, and what all of their maps are held to.
namespace moduli {

inline MetricSurface planeSample(const std::string& kind,
                                 const std::map<std::string, double>& parameters) {
  const auto soup = makeSample(kind, parameters);
  EXPECT_OK(soup);
  return fromPositions(soup->vertices, soup->faces);
}

inline MetricSurface surfaceOfFile(const std::string& path) {
  Context context;
  const auto soup = readMeshFile(context, path);
  EXPECT_OK(soup);
  return fromPositions(soup->vertices, soup->faces);
}

/// The faces that a map is of.
inline Connectivity facesOfMap(const MetricSurface& given, const Parameterization& map) {
  if (!map.subdivision) return given.surface;
  const auto vertices =
      given.surface.vertexCount() + static_cast<Index>(map.subdivision->vertices.size());
  auto faces = Connectivity::fromFaces(vertices, map.subdivision->faces);
  EXPECT_OK(faces);
  return *std::move(faces);
}

/// The area of the faces of an image.
inline double imageArea(const PlanarFaces& faces) {
  double area = 0;
  for (Index f = 0; f < faces.surface.faceCount(); ++f) area += faces.doubledArea(f) / 2;
  return area;
}

/// Faces the right way up of which none lies on another.
inline void expectFlatSheets(const PlanarFaces& faces, const Parameterization& map) {
  ASSERT_TRUE(faces.namesAllCorners());
  EXPECT_EQ(map.certificate.quality.flipped_faces, 0);
  EXPECT_EQ(countOverlaps(map.points, map.corner), 0);
  const std::vector<Index> islands = islandsOf(faces.surface, map.corner);
  EXPECT_EQ(*map.certificate.islands, 1 + *std::max_element(islands.begin(), islands.end()));
}

/// The surface of unit cubes at whole places, each square cut into 2 n^2 triangles.
inline MetricSurface surfaceOfCubes(const std::set<std::array<int, 3>>& cubes, int n) {
  std::map<std::array<int, 3>, Index> number;
  std::vector<Eigen::Vector3d> positions;
  const auto at = [&](const std::array<int, 3>& p) {
    const auto [place, fresh] = number.try_emplace(p, static_cast<Index>(positions.size()));
    if (fresh) positions.emplace_back(p[0] / (1.0 * n), p[1] / (1.0 * n), p[2] / (1.0 * n));
    return place->second;
  };
  std::vector<Triangle> faces;
  for (const std::array<int, 3>& cube : cubes) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        std::array<int, 3> beside = cube;
        beside[axis] += side == 1 ? 1 : -1;
        if (cubes.count(beside) > 0) continue;
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int i = 0; i < n; ++i) {
          for (int j = 0; j < n; ++j) {
            const auto corner = [&](int di, int dj) {
              std::array<int, 3> p = {n * cube[0], n * cube[1], n * cube[2]};
              p[axis] += n * side;
              p[u] += i + di;
              p[v] += j + dj;
              return at(p);
            };
            const Index a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
            if (side == 1) {
              faces.push_back({a, b, c});
              faces.push_back({a, c, d});
            } else {
              faces.push_back({a, c, b});
              faces.push_back({a, d, c});
            }
          }
        }
      }
    }
  }
  return fromPositions(positions, std::move(faces));
}

/// 2 pi (or, on the boundary, pi) less the angles of the given faces around each vertex.
inline std::vector<double> curvaturesOf(const MetricSurface& given) {
  const Connectivity& surface = given.surface;
  constexpr double kHalfTurn = 3.14159265358979323846;
  std::vector<double> result(surface.vertexCount());
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    result[v] = surface.isBoundaryVertex(v) ? kHalfTurn : 2 * kHalfTurn;
  }
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const auto side = [&](Index g) { return given.lengths[surface.edge(g)]; };
    const double a = side(h), b = side(Connectivity::previous(h)), c = side(Connectivity::next(h));
    result[surface.tail(h)] -=
        std::acos(std::clamp((a * a + b * b - c * c) / (2 * a * b), -1., 1.));
  }
  return result;
}

}  // namespace moduli
