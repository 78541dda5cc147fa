#pragma once

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/connectivity.h"
#include "core/mesh/disjoint_sets.h"
#include "core/mesh/double_cover.h"
#include "core/topology/homology.h"
#include "core/topology/surface_topology.h"
#include "core/topology/tree_cotree.h"
#include "tests/core/mesh/shapes.h"
#include "tests/core/testing.h"

/// Surfaces of every kind that topology must cope with, and what its tests ask of walks on them.
namespace moduli::surfaces {

inline Connectivity connect(const TriangleSoup& soup) {
  auto surface = Connectivity::fromFaces(static_cast<Index>(soup.vertices.size()), soup.faces);
  EXPECT_OK(surface);
  return *std::move(surface);
}

inline Connectivity doubled(const TriangleSoup& soup) {
  auto cover = doubleCover(connect(soup));
  EXPECT_OK(cover);
  return std::move(cover->connectivity);
}

/// The torus of one vertex and two faces.
inline Connectivity smallestTorus() {
  auto surface = Connectivity::fromGluing(1, {{0, 0, 0}, {0, 0, 0}}, {4, 5, 3, 2, 0, 1});
  EXPECT_OK(surface);
  return *std::move(surface);
}

/// A polygon cut into a fan of triangles from its first corner. sides: at least 3 letters,
/// counter-clockwise; x is glued to -x, 0 is left free.
inline Connectivity gluedPolygon(const std::vector<int>& sides) {
  const auto n = static_cast<Index>(sides.size());
  const Index faces = n - 2;
  const auto halfedgeOfSide = [&](Index i) {
    return i == 0 ? 0 : i == n - 1 ? 3 * faces - 1 : 3 * (i - 1) + 1;
  };
  std::vector<Index> twin(3 * faces, kNone);
  for (Index f = 0; f + 1 < faces; ++f) {
    twin[3 * f + 2] = 3 * (f + 1);
    twin[3 * (f + 1)] = 3 * f + 2;
  }
  DisjointSets corners(n);
  for (Index i = 0; i < n; ++i) {
    const auto other = std::find(sides.begin(), sides.end(), -sides[i]);
    if (sides[i] == 0 || other == sides.end()) continue;
    const auto k = static_cast<Index>(other - sides.begin());
    twin[halfedgeOfSide(i)] = halfedgeOfSide(k);
    corners.join(i, (k + 1) % n);
    corners.join((i + 1) % n, k);
  }
  std::vector<Index> number(n, kNone);
  Index vertices = 0;
  for (Index i = 0; i < n; ++i) {
    if (corners.root(i) == i) number[i] = vertices++;
  }
  const auto vertex = [&](Index i) { return number[corners.root(i)]; };
  std::vector<Triangle> triangles;
  for (Index f = 0; f < faces; ++f) triangles.push_back({vertex(0), vertex(f + 1), vertex(f + 2)});
  auto surface = Connectivity::fromGluing(vertices, std::move(triangles), std::move(twin));
  EXPECT_OK(surface);
  return *std::move(surface);
}

/// Letters 1 .. `letters` once with either sign and `free` zeros, in random order.
inline std::vector<int> randomSides(int letters, int free, std::mt19937& random) {
  std::vector<int> sides(free, 0);
  for (int x = 1; x <= letters; ++x) sides.insert(sides.end(), {x, -x});
  std::shuffle(sides.begin(), sides.end(), random);
  return sides;
}

/// x_1 .. x_2g x_1^-1 .. x_2g^-1: genus g with one corner.
inline std::vector<int> oppositeSides(int genus) {
  std::vector<int> sides;
  for (int x = 1; x <= 2 * genus; ++x) sides.push_back(x);
  for (int x = 1; x <= 2 * genus; ++x) sides.push_back(-x);
  return sides;
}

/// Leaves out `count` faces that have no vertex in common.
inline TriangleSoup withHoles(TriangleSoup soup, int count) {
  std::vector<bool> touched(soup.vertices.size(), false);
  std::vector<Triangle> kept;
  for (const Triangle& face : soup.faces) {
    const bool apart = !touched[face[0]] && !touched[face[1]] && !touched[face[2]];
    if (count == 0 || !apart) {
      kept.push_back(face);
      continue;
    }
    for (const Index v : face) touched[v] = true;
    --count;
  }
  EXPECT_EQ(count, 0);
  soup.faces = std::move(kept);
  return soup;
}

/// The same surface with its vertices, faces and the corners of its faces in another order.
inline Connectivity renumbered(const Connectivity& surface, std::mt19937& random) {
  std::vector<Index> vertex(surface.vertexCount());
  std::vector<Index> face(surface.faceCount());
  std::iota(vertex.begin(), vertex.end(), 0);
  std::iota(face.begin(), face.end(), 0);
  std::shuffle(vertex.begin(), vertex.end(), random);
  std::shuffle(face.begin(), face.end(), random);
  std::vector<Index> turn(surface.faceCount());
  for (Index& t : turn) t = static_cast<Index>(random() % 3);
  const auto moved = [&](Index h) {
    const Index f = Connectivity::faceOf(h);
    return 3 * face[f] + (h % 3 + turn[f]) % 3;
  };
  std::vector<Triangle> triangles(surface.faceCount());
  std::vector<Index> twin(surface.halfedgeCount(), kNone);
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    triangles[moved(h) / 3][moved(h) % 3] = vertex[surface.tail(h)];
    if (surface.twin(h) != kNone) twin[moved(h)] = moved(surface.twin(h));
  }
  auto result =
      Connectivity::fromGluing(surface.vertexCount(), std::move(triangles), std::move(twin));
  EXPECT_OK(result);
  return *std::move(result);
}

struct Named {
  std::string name;
  Connectivity surface;
};

inline std::vector<Named> closed() {
  std::vector<Named> list = {{"tetrahedron", connect(shapes::tetrahedron())},
                             {"octahedron", connect(shapes::octahedron())},
                             {"icosahedron", connect(shapes::icosahedron())},
                             {"doubled disk", doubled(shapes::disk())},
                             {"doubled triangle", doubled({{{}, {}, {}}, {{0, 1, 2}}})},
                             {"torus 3 x 3", connect(shapes::torusGrid(3, 3))},
                             {"torus 9 x 5", connect(shapes::torusGrid(9, 5))},
                             {"doubled annulus", doubled(shapes::annulus())},
                             {"doubled pants", doubled(shapes::pants())},
                             {"smallest torus", smallestTorus()}};
  std::mt19937 random(1);
  for (int g = 2; g <= 6; ++g) {
    list.push_back({"chain of " + std::to_string(g), connect(shapes::chainOfTori(g))});
    list.push_back(
        {"renumbered chain of " + std::to_string(g), renumbered(list.back().surface, random)});
    list.push_back({"opposite sides " + std::to_string(g), gluedPolygon(oppositeSides(g))});
    list.push_back({"doubled torus with holes " + std::to_string(g),
                    doubled(withHoles(shapes::torusGrid(6, 6), g - 1))});
  }
  for (int k = 0; k < 40; ++k) {
    list.push_back(
        {"random gluing " + std::to_string(k), gluedPolygon(randomSides(2 + k / 4, 0, random))});
  }
  return list;
}

inline std::vector<Named> bordered() {
  std::vector<Named> list = {
      {"triangle", connect({{{}, {}, {}}, {{0, 1, 2}}})},
      {"disk", connect(shapes::disk())},
      {"annulus", connect(shapes::annulus())},
      {"pants", connect(shapes::pants())},
      {"icosahedron with holes 3", connect(withHoles(shapes::icosahedron(), 3))}};
  std::mt19937 random(2);
  for (int holes = 1; holes <= 4; ++holes) {
    const std::string with = " with holes " + std::to_string(holes);
    for (int g = 1; g <= 3; ++g) {
      list.push_back({"chain of " + std::to_string(g) + with,
                      connect(withHoles(shapes::chainOfTori(g), holes))});
      list.push_back({"renumbered chain of " + std::to_string(g) + with,
                      renumbered(list.back().surface, random)});
    }
  }
  for (int k = 0; k < 60; ++k) {
    list.push_back({"random gluing " + std::to_string(k),
                    gluedPolygon(randomSides(1 + k / 6, 1 + k % 4, random))});
  }
  return list;
}

inline Index genusOf(const Connectivity& surface) {
  return computeTopology(surface).genus;
}

inline Index loopCount(const Connectivity& surface) {
  return static_cast<Index>(computeTopology(surface).boundary_loops.size());
}

inline Index startOf(const Connectivity& surface, const Step& step) {
  const Index h = surface.halfedge(step.edge);
  return step.sign > 0 ? surface.tail(h) : surface.head(h);
}

inline Index endOf(const Connectivity& surface, const Step& step) {
  return startOf(surface, {step.edge, -step.sign});
}

/// That each step starts where the last one ended and does not take it back.
inline void expectPath(const Connectivity& surface, const Walk& walk) {
  for (std::size_t i = 1; i < walk.size(); ++i) {
    ASSERT_EQ(startOf(surface, walk[i]), endOf(surface, walk[i - 1])) << "step " << i;
    ASSERT_FALSE(walk[i].edge == walk[i - 1].edge && walk[i].sign == -walk[i - 1].sign)
        << "step " << i;
  }
}

/// Entry (i, k) is the period of cochain i on walk k.
inline IntegerMatrix periods(const std::vector<Cochain>& cochains, const std::vector<Walk>& walks) {
  IntegerMatrix result(cochains.size(), walks.size());
  for (std::size_t i = 0; i < cochains.size(); ++i) {
    for (std::size_t k = 0; k < walks.size(); ++k) {
      result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          integrate(cochains[i], walks[k]);
    }
  }
  return result;
}

inline IntegerMatrix identity(std::size_t n) {
  return IntegerMatrix::Identity(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
}

inline TreeCotree treesOf(const Connectivity& surface) {
  auto trees = computeTreeCotree(surface);
  EXPECT_OK(trees);
  return *std::move(trees);
}

inline TreeCotree relativeTreesOf(const Connectivity& surface) {
  auto trees = computeRelativeTreeCotree(surface);
  EXPECT_OK(trees);
  return *std::move(trees);
}

/// Closed and bordered ones.
inline std::vector<Named> allSurfaces() {
  std::vector<Named> list = surfaces::closed();
  for (Named& named : surfaces::bordered()) list.push_back(std::move(named));
  return list;
}

}  // namespace moduli::surfaces
