#include "core/intrinsic/intrinsic_triangulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>
#include <vector>

#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

Index next(Index h) {
  return Connectivity::next(h);
}
Index previous(Index h) {
  return Connectivity::previous(h);
}

/// Two triangles over a loop, each with its other sides glued together: a sphere of 3 vertices.
MetricSurface pillow() {
  return fromHalfedges(3, {{0, 0, 1}, {0, 0, 2}}, {3, 2, 1, 0, 5, 4}, {1, 2, 2, 1, 3, 3});
}

MetricSurface tetrahedron() {
  return {*Connectivity::fromFaces(4, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}),
          std::vector<double>(6, 1.0)};
}

/// Genus 0, 1 and 2, with loops and double edges (one has a single vertex), and with a boundary.
std::vector<MetricSurface> someSurfaces() {
  return {pillow(),          tetrahedron(),        flatTorus({0.2, 1.1}, 3, 3, 0.2, 1),
          squareTiledL(),    gluedPolygon(8),      disphenoidCover(3, 4, 4.5),
          octahedronCover(), plate(3, 3, {{1, 1}})};
}

/// Random half chords: Ptolemy flips ask for no triangle inequality.
IntrinsicTriangulation triangulate(const MetricSurface& metric, std::mt19937& random) {
  std::vector<double> half_chords(metric.lengths.size());
  for (double& x : half_chords) x = 0.5 + uniform(random);
  return {metric.surface, half_chords};
}

/// Flips with arbitrary half chords; returns how many edges could be flipped.
int flipRandomly(IntrinsicTriangulation& triangulation, int count, std::mt19937& random) {
  int flipped = 0;
  for (int n = 0; n < count; ++n) {
    const auto h = static_cast<Index>(random() % triangulation.halfedgeCount());
    if (!triangulation.canFlip(h)) continue;
    triangulation.flip(h, 0.5 + uniform(random));
    ++flipped;
  }
  return flipped;
}

/// All that a triangulation is made of.
struct Bits {
  std::vector<Index> tail, twin;
  std::vector<double> half_chord;
  std::size_t flips = 0;

  explicit Bits(const IntrinsicTriangulation& t)
      : half_chord(t.halfChords()), flips(t.history().size()) {
    for (Index h = 0; h < t.halfedgeCount(); ++h) {
      tail.push_back(t.tail(h));
      twin.push_back(t.twin(h));
    }
  }
  bool operator==(const Bits&) const = default;
};

TEST(IntrinsicTriangulation, FlippedTwiceHasItsTwoFacesExchanged) {
  // The edge turns by two quarters: what was left of it is right of it, and all lengths are back.
  std::mt19937 random(1);
  int tried = 0;
  for (const MetricSurface& metric : someSurfaces()) {
    const IntrinsicTriangulation start = triangulate(metric, random);
    for (Index h = 0; h < start.halfedgeCount(); ++h) {
      if (!start.canFlip(h)) continue;
      IntrinsicTriangulation t = start;
      for (int n = 0; n < 2; ++n) t.flip(h, t.ptolemyDiagonal(h));
      const Index twin = start.twin(h);
      const auto image = [&](Index g) {
        for (int n = 0; n < 2; ++n) {
          const Index from = n == 0 ? h : twin, to = n == 0 ? twin : h;
          if (g == from) return to;
          if (g == next(from)) return next(to);
          if (g == previous(from)) return previous(to);
        }
        return g;
      };
      for (Index g = 0; g < start.halfedgeCount(); ++g) {
        EXPECT_EQ(t.tail(image(g)), start.tail(g));
        EXPECT_EQ(t.twin(image(g)), start.twin(g) == kNone ? kNone : image(start.twin(g)));
        // Three roundings of half a unit for the first diagonal, and as many for the second.
        EXPECT_NEAR(t.halfChord(image(g)) / start.halfChord(g), 1, 3 * kEpsilon);
      }
      ++tried;
    }
  }
  EXPECT_GT(tried, 200);
}

TEST(IntrinsicTriangulation, FlippedFourTimesIsTheSame) {
  std::mt19937 random(2);
  for (const MetricSurface& metric : someSurfaces()) {
    IntrinsicTriangulation t = triangulate(metric, random);
    for (Index h = 0; h < t.halfedgeCount(); ++h) {
      if (!t.canFlip(h)) continue;
      const Bits before(t);
      for (int n = 0; n < 4; ++n) t.flip(h, t.ptolemyDiagonal(h));
      const Bits after(t);
      EXPECT_EQ(after.tail, before.tail);
      EXPECT_EQ(after.twin, before.twin);
      for (Index g = 0; g < t.halfedgeCount(); ++g) {
        // Twelve roundings of half a unit.
        EXPECT_NEAR(after.half_chord[g] / before.half_chord[g], 1, 6 * kEpsilon);
      }
      t.undoTo(0);
    }
  }
}

TEST(IntrinsicTriangulation, FlipRunsBetweenTheOppositeCorners) {
  std::mt19937 random(3);
  for (const MetricSurface& metric : someSurfaces()) {
    IntrinsicTriangulation t = triangulate(metric, random);
    for (int n = 0; n < 100; ++n) {
      const auto h = static_cast<Index>(random() % t.halfedgeCount());
      if (!t.canFlip(h)) continue;
      const Index left = t.tail(previous(h)), right = t.tail(previous(t.twin(h)));
      std::vector<double> around;
      for (const Index g : {h, t.twin(h)}) {
        around.push_back(t.halfChord(next(g)));
        around.push_back(t.halfChord(previous(g)));
      }
      t.flip(h, 7.25);
      EXPECT_EQ(t.tail(h), right);
      EXPECT_EQ(t.head(h), left);
      EXPECT_EQ(t.halfChord(h), 7.25);
      EXPECT_EQ(t.halfChord(t.twin(h)), 7.25);
      // From l to k: then k i, i l on the left and l j, j k on the right.
      const std::array<double, 4> here{t.halfChord(next(t.twin(h))), t.halfChord(previous(h)),
                                       t.halfChord(previous(t.twin(h))), t.halfChord(next(h))};
      EXPECT_EQ(here[3], around[1]);
      EXPECT_EQ(here[1], around[2]);
      EXPECT_EQ(here[0], around[3]);
      EXPECT_EQ(here[2], around[0]);
    }
  }
}

TEST(IntrinsicTriangulation, ObeysThePentagonRelation) {
  // CHECKS F6. Five flips, of one diagonal and the other in turn, give the same two back. The
  // relative errors, in half units: 3, 6, 12, 21, 36 (those of a factor, of the divisor, and three
  // more).
  std::mt19937 random(4);
  for (int trial = 0; trial < 300; ++trial) {
    const MetricSurface pentagon{*Connectivity::fromFaces(5, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}),
                                 std::vector<double>(7, 1.0)};
    IntrinsicTriangulation t = triangulate(pentagon, random);
    const auto other = [&](Index h) {
      Index g = 0;
      while (t.twin(g) == kNone || g == h || g == t.twin(h)) ++g;
      return g;
    };
    const auto ends = [&](Index h) {
      return std::pair(std::min(t.tail(h), t.head(h)), std::max(t.tail(h), t.head(h)));
    };
    Index h = 2;
    ASSERT_EQ(ends(h), std::pair(0, 2));
    const double first = t.halfChord(h), second = t.halfChord(other(h));
    for (int n = 0; n < 5; ++n) {
      t.flip(h, t.ptolemyDiagonal(h));
      h = other(h);
    }
    // The last one flipped is the other diagonal now.
    EXPECT_EQ(ends(h), std::pair(0, 2));
    EXPECT_EQ(ends(other(h)), std::pair(0, 3));
    EXPECT_NEAR(t.halfChord(h) / first, 1, 18 * kEpsilon);
    EXPECT_NEAR(t.halfChord(other(h)) / second, 1, 18 * kEpsilon);
  }
}

TEST(IntrinsicTriangulation, GivesEveryBitBackWhenFlipsAreUndone) {
  std::mt19937 random(5);
  for (const MetricSurface& metric : someSurfaces()) {
    IntrinsicTriangulation t = triangulate(metric, random);
    std::vector<Bits> states{Bits(t)};
    for (int stage = 0; stage < 5; ++stage) {
      EXPECT_GT(flipRandomly(t, 200, random), 20);
      states.push_back(Bits(t));
      EXPECT_FALSE(states[stage + 1] == states[stage]);
    }
    for (auto state = states.rbegin(); state != states.rend(); ++state) {
      t.undoTo(state->flips);
      EXPECT_TRUE(Bits(t) == *state);
    }
    EXPECT_TRUE(t.history().empty());
  }
}

TEST(IntrinsicTriangulation, StaysTheSameSurfaceUnderFlips) {
  std::mt19937 random(6);
  for (const MetricSurface& metric : someSurfaces()) {
    IntrinsicTriangulation t = triangulate(metric, random);
    const auto boundary = [&] {
      std::vector<std::tuple<Index, Index, double>> edges;
      for (Index h = 0; h < t.halfedgeCount(); ++h) {
        if (t.twin(h) == kNone) edges.emplace_back(t.tail(h), t.head(h), t.halfChord(h));
      }
      std::sort(edges.begin(), edges.end());
      return edges;
    };
    const auto at_first = boundary();
    for (int stage = 0; stage < 10; ++stage) {
      flipRandomly(t, 50, random);
      for (Index h = 0; h < t.halfedgeCount(); ++h) {
        if (t.twin(h) == kNone) continue;
        EXPECT_EQ(t.twin(t.twin(h)), h);
        EXPECT_EQ(t.tail(t.twin(h)), t.head(h));
        EXPECT_EQ(t.halfChord(t.twin(h)), t.halfChord(h));
      }
      EXPECT_EQ(boundary(), at_first);
      // Turning around a corner until it closes or ends meets one vertex, and each vertex once.
      std::vector<bool> met(t.halfedgeCount(), false);
      Index fans = 0;
      for (Index start = 0; start < t.halfedgeCount(); ++start) {
        if (met[start]) continue;
        ++fans;
        std::vector<Index> open{start};
        while (!open.empty()) {
          const Index h = open.back();
          open.pop_back();
          if (met[h]) continue;
          met[h] = true;
          EXPECT_EQ(t.tail(h), t.tail(start));
          if (t.twin(previous(h)) != kNone) open.push_back(t.twin(previous(h)));
          if (t.twin(h) != kNone) open.push_back(next(t.twin(h)));
        }
      }
      EXPECT_EQ(fans, metric.surface.vertexCount());
      const Connectivity complex = t.connectivity();
      EXPECT_EQ(complex.eulerCharacteristic(), metric.surface.eulerCharacteristic());
      EXPECT_EQ(complex.vertexCount(), metric.surface.vertexCount());
      EXPECT_EQ(complex.faceCount(), metric.surface.faceCount());
    }
  }
}

TEST(IntrinsicTriangulation, NumbersHalfChordsAsItsConnectivityNumbersEdges) {
  std::mt19937 random(7);
  for (const MetricSurface& metric : someSurfaces()) {
    IntrinsicTriangulation t = triangulate(metric, random);
    flipRandomly(t, 100, random);
    const Connectivity complex = t.connectivity();
    const std::vector<double> half_chords = t.edgeHalfChords();
    ASSERT_EQ(half_chords.size(), static_cast<std::size_t>(complex.edgeCount()));
    for (Index h = 0; h < t.halfedgeCount(); ++h) {
      EXPECT_EQ(complex.tail(h), t.tail(h));
      EXPECT_EQ(complex.twin(h), t.twin(h));
      EXPECT_EQ(half_chords[complex.edge(h)], t.halfChord(h));
    }
  }
}

TEST(IntrinsicTriangulation, FlipsOnlyWhereTwoFacesMeet) {
  const MetricSurface sphere = pillow();
  IntrinsicTriangulation t(sphere.surface, sphere.lengths);
  EXPECT_TRUE(t.canFlip(0));
  EXPECT_TRUE(t.canFlip(3));
  for (const Index h : {1, 2, 4, 5}) EXPECT_FALSE(t.canFlip(h));
  // The loop of 1 between the edges of 2 and of 3: (2 * 3 + 2 * 3) / 1.
  EXPECT_EQ(t.ptolemyDiagonal(0), 12);
  t.flip(0, 12);
  // Now two triangles with the same corners, where everything can be flipped.
  for (Index h = 0; h < 6; ++h) {
    EXPECT_TRUE(t.canFlip(h));
    EXPECT_NE(t.tail(h), t.head(h));
  }

  const MetricSurface bordered = plate(3, 3, {{1, 1}});
  const IntrinsicTriangulation holed(bordered.surface, bordered.lengths);
  int boundary = 0;
  for (Index h = 0; h < holed.halfedgeCount(); ++h) {
    EXPECT_EQ(holed.canFlip(h), holed.twin(h) != kNone);
    if (holed.twin(h) == kNone) ++boundary;
  }
  EXPECT_EQ(boundary, 16);
}

TEST(IntrinsicTriangulation, TakesNewHalfChordsWithoutForgettingItsFlips) {
  std::mt19937 random(8);
  const MetricSurface torus = flatTorus({0, 1}, 3, 3, 0.1, 2);
  IntrinsicTriangulation t = triangulate(torus, random);
  flipRandomly(t, 30, random);
  const std::size_t flips = t.history().size();
  std::vector<double> doubled = t.halfChords();
  for (double& x : doubled) x *= 2;
  t.setHalfChords(doubled);
  EXPECT_EQ(t.halfChords(), doubled);
  EXPECT_EQ(t.history().size(), flips);
}

}  // namespace
}  // namespace moduli
