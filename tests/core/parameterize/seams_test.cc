#include "core/parameterize/seams.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <vector>

#include "core/intrinsic/angles.h"
#include "core/parameterize/layout.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/parameterize/plane_targets.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

double lengthOf(const MetricSurface& metric, const std::vector<bool>& seam) {
  double length = 0;
  for (Index e = 0; e < metric.surface.edgeCount(); ++e) {
    if (seam[e] && !metric.surface.isBoundaryEdge(e)) length += metric.lengths[e];
  }
  return length;
}

/// The Euler characteristics of the pieces that seams leave: 1 for a disk.
std::vector<Index> pieces(const Connectivity& surface, const std::vector<bool>& seam) {
  std::vector<Index> twin(surface.halfedgeCount());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    twin[h] = seam[surface.edge(h)] ? kNone : surface.twin(h);
  }
  const std::vector<Index> piece = piecesOf(twin);
  const PlanarLayout cut =
      sewCorners(surface, seam, std::vector<std::complex<double>>(surface.halfedgeCount(), 0.0));
  std::vector<Index> characteristic(1 + *std::max_element(piece.begin(), piece.end()), 0);
  std::set<Index> counted;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    Index& own = characteristic[piece[Connectivity::faceOf(h)]];
    if (counted.insert(cut.corner[h]).second) ++own;
    if (twin[h] == kNone || h < twin[h]) --own;
  }
  for (const Index p : piece) ++characteristic[p];
  return characteristic;
}

/// A torus R x R of unit cells cut along one diagonal each, vertex x + n y at (x, y).
MetricSurface squareTorus(int n) {
  return scale(flatTorus({0, 1}, n, n, 0, 1), n);
}

std::vector<bool> flags(Index count, const std::vector<Index>& set) {
  std::vector<bool> result(count, false);
  for (const Index i : set) result[i] = true;
  return result;
}

/// Different ones, at random.
std::vector<Index> someVertices(const MetricSurface& metric, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Index> chosen;
  while (static_cast<int>(chosen.size()) < count) {
    const auto v = static_cast<Index>(uniform(random) * metric.surface.vertexCount());
    if (std::find(chosen.begin(), chosen.end(), v) == chosen.end()) chosen.push_back(v);
  }
  return chosen;
}

/// Shortest ways along edges, by relaxing every edge until nothing changes.
std::vector<double> waysFrom(const MetricSurface& metric, Index source) {
  std::vector<double> way(metric.surface.vertexCount(), 1e300);
  way[source] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (Index h = 0; h < metric.surface.halfedgeCount(); ++h) {
      const Index a = metric.surface.tail(h), b = metric.surface.head(h);
      const double length = metric.lengths[metric.surface.edge(h)];
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
        if (way[from] + length < way[to] * (1 - 1e-15)) {
          way[to] = way[from] + length;
          changed = true;
        }
      }
    }
  }
  return way;
}

/// Of the complete graph on some vertices by their shortest ways: the least spanning tree.
double leastTree(const MetricSurface& metric, const std::vector<Index>& vertices) {
  std::vector<double> nearest(vertices.size(), 1e300);
  std::vector<bool> taken(vertices.size(), false);
  double total = 0;
  for (std::size_t next = 0, n = 0; n < vertices.size(); ++n) {
    taken[next] = true;
    const std::vector<double> way = waysFrom(metric, vertices[next]);
    double least = 1e300;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      nearest[i] = std::min(nearest[i], way[vertices[i]]);
      if (!taken[i] && nearest[i] < least) {
        least = nearest[i];
        next = i;
      }
    }
    if (n + 1 < vertices.size()) total += least;
  }
  return total;
}

TEST(ChooseSeams, LeavesDisks) {
  for (const MetricSurface& metric :
       {plate(4, 3, {}), plate(5, 3, {{1, 1}, {3, 1}}), squareTorus(6),
        subdivide(squareTiledL(), 4), insertVertices(octahedronCover(), 200, 0.05, 3),
        doubled(plate(5, 3, {{1, 1}, {3, 1}}))}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      const auto through = flags(metric.surface.vertexCount(),
                                 someVertices(metric, static_cast<int>(seed % 3), seed));
      const auto seam = chooseSeams(metric.surface, metric.lengths, through, {});
      EXPECT_EQ(pieces(metric.surface, seam), std::vector<Index>{1});
    }
  }
}

TEST(ChooseSeams, JoinsTwoPointsOfASphereByTheShortestWay) {
  const MetricSurface sphere = insertVertices(doubled(plate(4, 3, {})), 60, 0.1, 2);
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<Index> ends = someVertices(sphere, 2, seed);
    const auto seam =
        chooseSeams(sphere.surface, sphere.lengths, flags(sphere.surface.vertexCount(), ends), {});
    EXPECT_NEAR(lengthOf(sphere, seam), waysFrom(sphere, ends[0])[ends[1]], 1e-12);
  }
}

TEST(ChooseSeams, OfManyPointsOfASphereCostsNoMoreThanTheLeastTreeOfShortestWays) {
  // Which is at most twice the least Steiner tree.
  const MetricSurface sphere = insertVertices(doubled(plate(4, 3, {})), 60, 0.1, 2);
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<Index> ends = someVertices(sphere, 6, seed);
    const auto seam =
        chooseSeams(sphere.surface, sphere.lengths, flags(sphere.surface.vertexCount(), ends), {});
    const double least = leastTree(sphere, ends);
    EXPECT_LE(lengthOf(sphere, seam), least * (1 + 1e-12));
    EXPECT_GE(lengthOf(sphere, seam), least / 2);
  }
}

TEST(ChooseSeams, CutsATorusAlongItsShortestLoops) {
  // Cells of 1, six one way round and six the other: two loops of length 6 through one vertex.
  const MetricSurface torus = squareTorus(6);
  for (const Index v : {0, 7, 20}) {
    const auto seam =
        chooseSeams(torus.surface, torus.lengths, flags(torus.surface.vertexCount(), {v}), {});
    EXPECT_NEAR(lengthOf(torus, seam), 12, 1e-12);
  }
  // Without an end nothing dangles from the loops either.
  EXPECT_NEAR(lengthOf(torus, chooseSeams(torus.surface, torus.lengths, {}, {})), 12, 1e-12);
}

TEST(ChooseSeams, GoesAroundWhatIsDear) {
  // From one side of a plate to the other past a hill in the middle, where edges cost 100 times as
  // much: two holes are joined around it.
  const MetricSurface ring = plate(7, 5, {{1, 2}, {5, 2}});
  std::vector<double> costs = ring.lengths;
  const auto direct = chooseSeams(ring.surface, costs, {}, {});
  for (Index e = 0; e < ring.surface.edgeCount(); ++e) {
    if (direct[e] && !ring.surface.isBoundaryEdge(e)) costs[e] *= 100;
  }
  const auto around = chooseSeams(ring.surface, costs, {}, {});
  for (Index e = 0; e < ring.surface.edgeCount(); ++e) {
    EXPECT_FALSE(direct[e] && around[e] && !ring.surface.isBoundaryEdge(e));
  }
  EXPECT_EQ(pieces(ring.surface, around), std::vector<Index>{1});
}

TEST(ChooseSeams, KeepsThoseGivenAndJoinsThemToTheRest) {
  const MetricSurface torus = squareTorus(6);
  const MetricSurface sphere = insertVertices(doubled(plate(4, 3, {})), 60, 0.1, 2);
  for (const MetricSurface& metric : {torus, sphere}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      std::mt19937 random(seed);
      std::vector<bool> given(metric.surface.edgeCount(), false);
      for (int n = 0; n < 12; ++n) {
        given[static_cast<Index>(uniform(random) * metric.surface.edgeCount())] = true;
      }
      const auto seam = chooseSeams(metric.surface, metric.lengths, {}, given);
      for (Index e = 0; e < metric.surface.edgeCount(); ++e) EXPECT_TRUE(seam[e] || !given[e]);
      const auto characteristics = pieces(metric.surface, seam);
      for (const Index piece : characteristics) EXPECT_EQ(piece, 1);
    }
  }
}

TEST(ChooseSeams, GivenAroundAPartCutItOut) {
  // Around the first face of a sphere: two pieces, and nothing else is cut.
  const MetricSurface sphere = insertVertices(doubled(plate(4, 3, {})), 60, 0.1, 2);
  std::vector<bool> given(sphere.surface.edgeCount(), false);
  for (Index h = 0; h < 3; ++h) given[sphere.surface.edge(h)] = true;
  const auto seam = chooseSeams(sphere.surface, sphere.lengths, {}, given);
  EXPECT_EQ(seam, given);
  EXPECT_EQ(pieces(sphere.surface, seam), (std::vector<Index>{1, 1}));
}

TEST(ChooseSeams, CostsTheSameInAnyNumbering) {
  const MetricSurface metric = insertVertices(octahedronCover(), 200, 0.05, 3);
  const double length = lengthOf(metric, chooseSeams(metric.surface, metric.lengths, {}, {}));
  for (unsigned seed = 0; seed < 5; ++seed) {
    const MetricSurface other = renumber(metric, seed);
    // Without ends the surface is cut through its dearest vertex, whatever its number.
    EXPECT_NEAR(lengthOf(other, chooseSeams(other.surface, other.lengths, {}, {})), length, 1e-12);
  }
}

TEST(SeamCosts, AreTwiceTheLengthOnARoundSphere) {
  const MetricSurface sphere = planeSample("sphere", {{"resolution", 16}});
  const std::vector<double> costs = seamCosts(sphere.surface, sphere.lengths);
  double largest = 0;
  for (std::size_t e = 0; e < costs.size(); ++e) {
    largest = std::max(largest, std::abs(costs[e] / sphere.lengths[e] - 2));
  }
  // A corner takes a third of each of its faces, which is its share up to the unevenness of the
  // faces; the root of what is left of that when neighbours are added counts.
  EXPECT_LE(largest, 0.15);
}

TEST(SeamCosts, RiseToACornerAndScaleWithLengths) {
  // The corners of a doubled plate turn by pi each, all else is flat.
  const MetricSurface pillow = insertVertices(doubled(plate(6, 6, {})), 20, 0.1, 2);
  const auto costs = seamCosts(pillow.surface, pillow.lengths);
  const auto curvatures = vertexCurvatures(pillow.surface, pillow.lengths);
  int dear = 0, plain = 0;
  for (Index e = 0; e < pillow.surface.edgeCount(); ++e) {
    const Index h = pillow.surface.halfedge(e);
    const bool corner = std::abs(curvatures[pillow.surface.tail(h)]) > 1 ||
                        std::abs(curvatures[pillow.surface.head(h)]) > 1;
    if (corner) {
      ++dear;
      EXPECT_GT(costs[e], 2.5 * pillow.lengths[e]);
    }
    // Roundings of flat vertices count by the root of their curvature, some 1e-8.
    if (costs[e] < (1 + 1e-6) * pillow.lengths[e]) ++plain;
    EXPECT_GE(costs[e], pillow.lengths[e]);
  }
  EXPECT_GT(dear, 4);
  EXPECT_GT(plain, 4 * dear);
  const MetricSurface large = scale(pillow, 1000);
  const auto more = seamCosts(large.surface, large.lengths);
  for (std::size_t e = 0; e < costs.size(); ++e) EXPECT_NEAR(more[e] / costs[e], 1000, 1e-4);
}

}  // namespace
}  // namespace moduli
