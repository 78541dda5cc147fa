#include "core/hyperbolic/straight_faces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "core/hyperbolic/fuchsian_group.h"
#include "core/hyperbolic/length_spectrum.h"
#include "core/intrinsic/chordal_metric.h"
#include "tests/core/hyperbolic/hexagon_pants.h"
#include "tests/core/hyperbolic/uniformized_samples.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

double wrapped(double angle) {
  return std::remainder(angle, 2 * kPi);
}

Index foldsOf(const StraightFaces& faces) {
  Index folds = 0;
  for (Index f = 0; f < faces.surface.faceCount(); ++f) folds += faces.isFolded(f) ? 1 : 0;
  return folds;
}

std::vector<double> angleSums(const StraightFaces& faces) {
  std::vector<double> sums(faces.surface.vertexCount(), 0.0);
  for (Index h = 0; h < faces.surface.halfedgeCount(); ++h) {
    sums[faces.surface.tail(h)] += faces.angles[h];
  }
  return sums;
}

/// Lengths, angles and their signs belong together.
void expectSoundFaces(const StraightFaces& faces) {
  for (Index h = 0; h < faces.surface.halfedgeCount(); ++h) {
    ASSERT_GT(faces.lengths[h], 0);
    ASSERT_EQ(faces.lengths[h], faces.lengths[faces.surface.twin(h)]) << h;
  }
  for (Index f = 0; f < faces.surface.faceCount(); ++f) {
    const double* side = &faces.lengths[3 * f];
    const double* angle = &faces.angles[3 * f];
    const double sign = faces.isFolded(f) ? -1 : 1;
    for (int c = 0; c < 3; ++c) {
      ASSERT_GT(sign * angle[c], 0) << "face " << f;
      // The law of sines: angles and lengths carry some 1e-14 for each of the flips undone beside a
      // face, which small faces see relative to their size.
      ASSERT_NEAR(std::sinh(side[(c + 1) % 3]) * std::abs(std::sin(angle[(c + 2) % 3])),
                  std::sinh(side[c]) * std::abs(std::sin(angle[c])), 1e-10)
          << "face " << f;
    }
  }
}

TEST(StraightFaces, AreTheMetricsOwnWithoutFlips) {
  const MetricSurface given = metricOfSample("genus", {{"genus", 2}, {"resolution", 8}});
  // Scaled from its own Delaunay triangulation, which is that of the surface up to flips: begin
  // with these.
  Uniformization found = uniformized(given);
  DiscreteMetric metric = found.metric;
  metric.triangulation = IntrinsicTriangulation(metric.triangulation.connectivity(),
                                                metric.triangulation.edgeHalfChords());
  ASSERT_TRUE(metric.triangulation.history().empty());
  const StraightFaces faces = straightFaces(metric);
  EXPECT_EQ(faces.surface.faces(), metric.triangulation.connectivity().faces());
  EXPECT_EQ(faces.angles, metric.angles);
  for (std::size_t h = 0; h < faces.lengths.size(); ++h) {
    ASSERT_EQ(faces.lengths[h], lengthOfHalfChord(Geometry::kHyperbolic, metric.half_chords[h]));
  }
  EXPECT_EQ(foldsOf(faces), 0);
}

/// The lengths of the closed geodesics up to 1.4 systoles.
std::vector<double> shortLengths(const HyperbolicTriangles& triangles) {
  Context context;
  const auto group = computeFuchsianGroup(context, triangles);
  EXPECT_OK(group);
  if (!group.ok()) return {};
  const auto polygon =
      orbitPolygon(context, group->generators, static_cast<int>(group->generators.size() / 2));
  EXPECT_OK(polygon);
  if (!polygon.ok()) return {};
  const auto shortest = systoles(context, *polygon);
  EXPECT_OK(shortest);
  if (!shortest.ok()) return {};
  const auto spectrum = lengthSpectrum(context, *polygon, 1.4 * shortest->geodesics[0].length);
  EXPECT_OK(spectrum);
  std::vector<double> lengths;
  if (!spectrum.ok()) return lengths;
  for (const ClosedGeodesic& geodesic : spectrum->geodesics) lengths.push_back(geodesic.length);
  return lengths;
}

/// Edges by their ends, where these have no other edge.
std::map<std::pair<Index, Index>, Index> halfedgesByEnds(const Connectivity& surface) {
  std::map<std::pair<Index, Index>, Index> found;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const auto [place, fresh] = found.try_emplace({surface.tail(h), surface.head(h)}, h);
    if (!fresh) place->second = kNone;
  }
  std::erase_if(found, [](const auto& entry) { return entry.second == kNone; });
  return found;
}

/// Closed walks along the edges that flips left: vertices, each the next one's neighbour.
std::vector<std::vector<Index>> walks(Index vertices,
                                      const std::vector<std::pair<Index, Index>>& edges) {
  std::vector<std::vector<Index>> neighbours(vertices);
  for (const auto& [v, w] : edges) neighbours[v].push_back(w);
  std::vector<Index> parent(vertices, kNone), order{edges.front().first};
  parent[order[0]] = order[0];
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (const Index w : neighbours[order[i]]) {
      if (parent[w] != kNone) continue;
      parent[w] = order[i];
      order.push_back(w);
    }
  }
  const auto pathTo = [&](Index v) {
    std::vector<Index> path{v};
    while (parent[path.back()] != path.back()) path.push_back(parent[path.back()]);
    return path;
  };
  std::vector<std::vector<Index>> result;
  for (const auto& [v, w] : edges) {
    if (v > w || parent[v] == kNone || parent[v] == w || parent[w] == v) continue;
    std::vector<Index> there = pathTo(v), back = pathTo(w);
    while (there.size() > 1 && back.size() > 1 &&
           there[there.size() - 2] == back[back.size() - 2]) {
      there.pop_back();
      back.pop_back();
    }
    std::reverse(there.begin(), there.end());
    there.insert(there.end(), back.begin(), back.end() - 1);
    result.push_back(there);
  }
  return result;
}

double holonomyLength(const HyperbolicTriangles& triangles, const Development& development,
                      const std::map<std::pair<Index, Index>, Index>& halfedges,
                      const std::vector<Index>& walk) {
  std::vector<Index> loop;
  for (std::size_t i = 0; i < walk.size(); ++i) {
    loop.push_back(halfedges.at({walk[i], walk[(i + 1) % walk.size()]}));
  }
  const Su11 turn = holonomy(triangles.surface, development, loop);
  return distanceToUnit(turn) < 1e-6 ? 0 : translationLength(turn);
}

/// Walks along edges that both triangulations have move the plane by the same lengths. How many of
/// them do.
int expectSameHolonomy(const HyperbolicTriangles& before, const HyperbolicTriangles& after) {
  Context context;
  const auto a = develop(context, before), b = develop(context, after);
  EXPECT_OK(a);
  EXPECT_OK(b);
  const auto here = halfedgesByEnds(before.surface), there = halfedgesByEnds(after.surface);
  std::vector<std::pair<Index, Index>> common;
  for (const auto& [ends, h] : here) {
    const auto other = there.find(ends);
    if (other == there.end() || before.lengths[h] != after.lengths[other->second]) continue;
    common.push_back(ends);
  }
  int moving = 0;
  for (const std::vector<Index>& walk : walks(before.surface.vertexCount(), common)) {
    const double expected = holonomyLength(after, *b, there, walk);
    // Paths of some ten faces, and flips undone beside them.
    EXPECT_NEAR(holonomyLength(before, *a, here, walk), expected, 1e-9);
    moving += expected > 0 ? 1 : 0;
  }
  return moving;
}

void expectTheSurfaceOfItsMetric(const MetricSurface& given, bool initial_delaunay) {
  const Uniformization found = uniformized(given, initial_delaunay);
  const StraightFaces faces = straightFaces(found.metric);
  EXPECT_EQ(faces.surface.faces(), given.surface.faces());
  EXPECT_GT(found.metric.certificate.flips, 0);
  expectSoundFaces(faces);
  const bool folded = foldsOf(faces) > 0;
  for (const double sum : angleSums(faces)) {
    // Curvature is 0 to 1e-10 or so; angles are cut and put together flip by flip.
    EXPECT_NEAR(folded ? wrapped(sum) : sum - 2 * kPi, 0, 1e-9);
  }
  const auto flipped = hyperbolicTriangles(found.metric);
  ASSERT_OK(flipped);
  const HyperbolicTriangles straight{faces.surface, faces.lengths, faces.angles};
  EXPECT_GT(expectSameHolonomy(straight, *flipped), 0);
  const std::vector<double> expected = shortLengths(*flipped), lengths = shortLengths(straight);
  ASSERT_FALSE(expected.empty());
  ASSERT_EQ(lengths.size(), expected.size());
  for (std::size_t i = 0; i < lengths.size(); ++i) EXPECT_NEAR(lengths[i], expected[i], 1e-9);
  std::cout << found.metric.certificate.flips << " flips, " << foldsOf(faces) << " folds\n";
}

TEST(StraightFaces, OfClosedSurfacesAreThoseOfTheirMetric) {
  for (const double seed : {0, 3}) {
    for (const double genus : {2, 3}) {
      for (const bool initial_delaunay : {true, false}) {
        SCOPED_TRACE(testing::Message() << "genus " << genus << ", seed " << seed);
        expectTheSurfaceOfItsMetric(
            metricOfSample("genus", {{"genus", genus}, {"resolution", 4}, {"seed", seed}}),
            initial_delaunay);
      }
    }
  }
}

TEST(StraightFaces, OfARealMeshAreThoseOfItsMetric) {
  for (const char* name : {"genus2/cfwen__eight.off", "genus3plus/libigl-data__3holes.off"}) {
    SCOPED_TRACE(name);
    MODULI_NEED_SHARED_MESH(path, name);
    const auto given = metricOfFile(path);
    ASSERT_OK(given);
    expectTheSurfaceOfItsMetric(*given, true);
  }
}

/// Faces f and f + face_count have the same lengths and angles, read backwards.
void expectMirrorImages(const Uniformization& found, const StraightFaces& faces) {
  const Index count = found.cover->face_count;
  for (Index f = 0; f < count; ++f) {
    for (int c = 0; c < 3; ++c) {
      // The mirrored face has the corners 0, 2, 1.
      const Index h = 3 * f + c, side = 3 * (f + count) + 2 - c,
                  corner = 3 * (f + count) + (3 - c) % 3;
      ASSERT_NEAR(faces.lengths[h], faces.lengths[side], 1e-12 * std::max(1.0, faces.lengths[h]))
          << "face " << f << ", side " << c;
      ASSERT_NEAR(wrapped(faces.angles[h] - faces.angles[corner]), 0, 1e-10)
          << "face " << f << ", corner " << c;
    }
  }
}

/// The boundary is straight on the side of the first copy.
void expectStraightBoundary(const MetricSurface& given, const StraightFaces& faces) {
  std::vector<double> sums(given.surface.vertexCount(), 0.0);
  for (Index h = 0; h < given.surface.halfedgeCount(); ++h) {
    sums[given.surface.tail(h)] += faces.angles[h];
  }
  for (Index v = 0; v < given.surface.vertexCount(); ++v) {
    const double expected = given.surface.isBoundaryVertex(v) ? kPi : 0;
    EXPECT_NEAR(wrapped(sums[v] - expected), 0, 1e-10) << "vertex " << v;
  }
}

/// A face with two sides on the boundary, which is straight, has no area and counts as folded.
void expectFlatEars(const MetricSurface& given, const StraightFaces& faces) {
  for (Index f = 0; f < given.surface.faceCount(); ++f) {
    int free = 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) free += given.surface.twin(h) == kNone ? 1 : 0;
    if (free > 1) {
      EXPECT_TRUE(faces.isFolded(f)) << "face " << f;
    }
  }
}

void expectMirrorSymmetry(const MetricSurface& given) {
  for (const bool initial_delaunay : {true, false}) {
    SCOPED_TRACE(initial_delaunay);
    const Uniformization found = uniformized(given, initial_delaunay);
    ASSERT_TRUE(found.cover);
    const StraightFaces faces = straightFaces(found.metric);
    expectMirrorImages(found, faces);
    expectStraightBoundary(given, faces);
    expectFlatEars(given, faces);
    std::cout << found.metric.certificate.flips << " flips, " << foldsOf(faces) << " folds\n";
  }
}

TEST(StraightFaces, OfDoublesAreMirrorImages) {
  expectMirrorSymmetry(metricOfSample("plate", {{"holes", 2}, {"resolution", 1}}));
  expectMirrorSymmetry(metricOfSample("plate", {{"holes", 3}, {"resolution", 2}, {"seed", 5}}));
}

TEST(StraightFaces, OfDoublesOfPlatesWithEarsAreMirrorImages) {
  // On the double, flips make the edge between the copies of an ear's corner a loop that can be
  // shrunk to a point.
  const std::set<std::pair<int, int>> holes{{1, 1}, {3, 1}};
  expectMirrorSymmetry(plateWithEars(5, 3, holes));
  expectMirrorSymmetry(plateWithEars(7, 5, {{1, 1}, {2, 1}, {4, 3}}));
  expectMirrorSymmetry(subdivide(plateWithEars(5, 3, holes), 2));
}

TEST(StraightFaces, OfDoublesWithLoopsThatShrinkToAPointAreMirrorImages) {
  // Ears with an obtuse angle at the boundary: while flips are undone, loops around their corners
  // have lengths of some 1e-16, and no direction. The smallest angles are 0.002, by which the
  // rounding of angles, 1e-14, is divided.
  for (const double shear : {-2.0, -1.0, 1.0, 2.0}) {
    for (const double width : {0.3, 1.0, 3.0}) {
      SCOPED_TRACE(testing::Message() << "shear " << shear << ", width " << width);
      expectMirrorSymmetry(plateWithEars(5, 3, {{1, 1}, {3, 1}}, shear, width));
    }
  }
}

/// The chords of a surface that is given hyperbolic.
MetricSurface chordsOf(const IntrinsicSurface& given) {
  const auto lengths = chordLengths(given);
  EXPECT_OK(lengths);
  return {given.connectivity, *lengths};
}

const std::array<double, 3> kCuffs{2, 2.4, 3};

/// Per loop in the order of a surface of hexagonPants: that of the cuffs, as each begins with the
/// lowest of its halfedges, or another.
void expectCuffs(std::vector<double> lengths, std::array<double, 3> cuffs, double tolerance) {
  ASSERT_EQ(lengths.size(), 3U);
  std::sort(lengths.begin(), lengths.end());
  std::sort(cuffs.begin(), cuffs.end());
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(lengths[k], cuffs[k], tolerance);
}

TEST(StraightFaces, OfAPairOfPantsOfHexagonsAreTheHexagonsOwn) {
  for (const std::array<double, 3>& cuffs : {kCuffs, {1.5, 1.5, 1.5}, {3.5, 3, 2.5}}) {
    const IntrinsicSurface pants = hexagonPants(cuffs);
    for (const bool initial_delaunay : {false, true}) {
      const Uniformization found = uniformized(chordsOf(pants), initial_delaunay);
      EXPECT_EQ(found.metric.certificate.flips, 0);
      const StraightFaces faces = straightFaces(found.metric);
      for (Index h = 0; h < pants.connectivity.halfedgeCount(); ++h) {
        // Newton's method ends at curvatures of 1e-13 or less.
        ASSERT_NEAR(faces.lengths[h], pants.lengths[pants.connectivity.edge(h)], 1e-12);
      }
      expectCuffs(boundaryLengths(pants.connectivity, faces.lengths), cuffs, 1e-12);
    }
  }
}

/// The same discrete conformal class in another triangulation: some inner edges flipped by
/// Ptolemy's relation, and for each halfedge the length of the straight edge in the pants.
struct FlippedPants {
  MetricSurface chords;
  std::vector<double> lengths;
  int flips = 0;
};

bool isProper(const IntrinsicTriangulation& t, Index face) {
  return !isBrokenTriangle(
      {t.halfChord(3 * face), t.halfChord(3 * face + 1), t.halfChord(3 * face + 2)});
}

FlippedPants flipSome(const IntrinsicSurface& pants) {
  std::vector<double> half_chords;
  for (const double l : pants.lengths) half_chords.push_back(halfChord(Geometry::kHyperbolic, l));
  // One changed by Ptolemy's relation, one by isometries of the pants.
  IntrinsicTriangulation conformal(pants.connectivity, half_chords), straight = conformal;
  const auto length = [&](Index h) {
    return lengthOfHalfChord(Geometry::kHyperbolic, straight.halfChord(h));
  };
  int flips = 0;
  std::vector<bool> touched(conformal.faceCount(), false);
  for (Index h = 0; h < conformal.halfedgeCount(); ++h) {
    const Index t = conformal.twin(h);
    if (!conformal.canFlip(h) || touched[h / 3] || touched[t / 3]) continue;
    const double diagonal =
        isometricDiagonal(Geometry::kHyperbolic, length(h), length(Connectivity::previous(h)),
                          length(Connectivity::next(h)), length(Connectivity::previous(t)),
                          length(Connectivity::next(t)));
    const std::size_t before = conformal.history().size();
    conformal.flip(h, conformal.ptolemyDiagonal(h));
    if (!isProper(conformal, h / 3) || !isProper(conformal, t / 3)) {
      conformal.undoTo(before);
      continue;
    }
    straight.flip(h, halfChord(Geometry::kHyperbolic, diagonal));
    touched[h / 3] = touched[t / 3] = true;
    ++flips;
  }
  FlippedPants result{{conformal.connectivity(), conformal.edgeHalfChords()}, {}, flips};
  for (double& x : result.chords.lengths) x *= 2;
  for (Index h = 0; h < straight.halfedgeCount(); ++h) result.lengths.push_back(length(h));
  return result;
}

TEST(StraightFaces, OfAPairOfPantsKeepItsLengthsThroughFlips) {
  const FlippedPants given = flipSome(hexagonPants(kCuffs));
  EXPECT_GT(given.flips, 20);
  const Uniformization found = uniformized(given.chords, false);
  EXPECT_GT(found.metric.certificate.flips, 20);
  const StraightFaces faces = straightFaces(found.metric);
  double worst = 0;
  for (std::size_t h = 0; h < given.lengths.size(); ++h) {
    worst = std::max(worst, std::abs(faces.lengths[h] - given.lengths[h]));
  }
  EXPECT_LT(worst, 1e-11);
  expectCuffs(boundaryLengths(given.chords.surface, faces.lengths), kCuffs, 1e-12);
  std::cout << given.flips << " edges flipped before, " << found.metric.certificate.flips
            << " after; lengths to " << worst << "\n";
}

}  // namespace
}  // namespace moduli
