#include "core/intrinsic/overlay.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "core/intrinsic/delaunay.h"
#include "core/intrinsic/subdivide.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// A polygon with its corners on the unit circle, cut into triangles from corner 0. All of its
/// triangulations have straight edges in one plane, which is where projective coordinates live:
/// what crosses what, and where, is plane geometry.
struct CirclePolygon {
  std::vector<Complex> corners;
  Connectivity surface;
  IntrinsicTriangulation triangulation;
};

CirclePolygon circlePolygon(Index count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> step(0.2, 1);
  std::vector<double> angles(1, 0.0);
  for (Index n = 0; n < count; ++n) angles.push_back(angles.back() + step(random));
  std::vector<Complex> corners;
  for (Index n = 0; n < count; ++n) {
    corners.push_back(std::polar(1.0, 2 * std::numbers::pi * angles[n] / angles.back()));
  }
  std::vector<Triangle> faces;
  for (Index n = 1; n + 1 < count; ++n) faces.push_back({0, n, n + 1});
  Connectivity surface = *Connectivity::fromFaces(count, faces);
  std::vector<double> chords;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    chords.push_back(std::abs(corners[surface.tail(h)] - corners[surface.head(h)]) / 2);
  }
  IntrinsicTriangulation triangulation(surface, chords);
  return {std::move(corners), std::move(surface), std::move(triangulation)};
}

void flipAtRandom(IntrinsicTriangulation& triangulation, int count, unsigned seed) {
  std::mt19937 random(seed);
  for (int n = 0; n < count; ++n) {
    const auto h = static_cast<Index>(random() % triangulation.halfedgeCount());
    if (triangulation.canFlip(h)) triangulation.flip(h, triangulation.ptolemyDiagonal(h));
  }
}

double cross(const Complex& a, const Complex& b) {
  return std::imag(std::conj(a) * b);
}

/// Where the line from a to b meets that from c to d, as a fraction of the first.
double meeting(const Complex& a, const Complex& b, const Complex& c, const Complex& d) {
  return cross(c - a, d - c) / cross(b - a, d - c);
}

TEST(Overlay, OfAnUnchangedTriangulationHasNoCrossings) {
  Context context;
  const CirclePolygon polygon = circlePolygon(8, 1);
  const auto overlay = Overlay::make(context, polygon.triangulation);
  ASSERT_OK(overlay);
  for (Index e = 0; e < polygon.surface.edgeCount(); ++e) {
    EXPECT_TRUE(overlay->crossings(e).empty());
  }
  for (Index f = 0; f < polygon.surface.faceCount(); ++f) {
    EXPECT_EQ(overlay->boundary(f).size(), 3U);
    EXPECT_TRUE(overlay->chords(f).empty());
  }
}

TEST(Overlay, OfPolygonsOnACircleIsPlaneGeometry) {
  Context context;
  for (unsigned seed = 0; seed < 20; ++seed) {
    CirclePolygon polygon = circlePolygon(5 + static_cast<Index>(seed) * 2, seed);
    flipAtRandom(polygon.triangulation, 300, seed);
    const IntrinsicTriangulation& last = polygon.triangulation;
    const auto overlay = Overlay::make(context, last);
    ASSERT_OK(overlay);
    const auto at = [&](Index v) { return polygon.corners[v]; };
    for (Index e = 0; e < polygon.surface.edgeCount(); ++e) {
      const Index given = polygon.surface.halfedge(e);
      const Index a = polygon.surface.tail(given), b = polygon.surface.head(given);
      // What crosses a - b, in order, by plane geometry.
      std::map<double, std::pair<Index, Index>> expected;
      for (Index h = 0; h < last.halfedgeCount(); ++h) {
        if (last.twin(h) != kNone && last.twin(h) < h) continue;
        const Index c = last.tail(h), d = last.head(h);
        if (c == a || c == b || d == a || d == b) continue;
        if ((cross(at(b) - at(a), at(c) - at(a)) > 0) ==
            (cross(at(b) - at(a), at(d) - at(a)) > 0)) {
          continue;
        }
        expected[meeting(at(a), at(b), at(c), at(d))] = {std::min(c, d), std::max(c, d)};
      }
      const std::vector<Crossing>& found = overlay->crossings(e);
      ASSERT_EQ(found.size(), expected.size());
      std::size_t n = 0;
      for (const auto& [fraction, ends] : expected) {
        const Crossing& crossing = found[n++];
        const Index c = last.tail(crossing.halfedge), d = last.head(crossing.halfedge);
        EXPECT_EQ(std::min(c, d), ends.first);
        EXPECT_EQ(std::max(c, d), ends.second);
        // The given edge comes from the left of the halfedge.
        EXPECT_GT(cross(at(d) - at(c), at(a) - at(c)), 0);
        // Some ten products and sums of positive numbers, chords down to 1e-2.
        EXPECT_NEAR(crossing.fraction, fraction, 1e-12);
        const Complex there = at(a) + fraction * (at(b) - at(a));
        const Complex by_weights = (crossing.weight_tail * at(c) + crossing.weight_head * at(d)) /
                                   (crossing.weight_tail + crossing.weight_head);
        EXPECT_NEAR(std::abs(there - by_weights), 0, 1e-12);
      }
    }
  }
}

TEST(Overlay, OfIsometricFlipsMeetsTheSameEdgesInTheSameOrder) {
  // A grid whose points are moved about, and its Delaunay triangulation in the plane.
  Context context;
  constexpr Index kSide = 12;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> shift(-0.45, 0.45);
  std::vector<Complex> points;
  for (Index j = 0; j <= kSide; ++j) {
    for (Index i = 0; i <= kSide; ++i) {
      const bool rim = i == 0 || j == 0 || i == kSide || j == kSide;
      points.emplace_back(2.5 * i + (rim ? 0 : 2.5 * shift(random)), j + (rim ? 0 : shift(random)));
    }
  }
  std::vector<Triangle> faces;
  const auto turn = [&](Index a, Index b, Index c) {
    return cross(points[b] - points[a], points[c] - points[a]);
  };
  for (Index j = 0; j < kSide; ++j) {
    for (Index i = 0; i < kSide; ++i) {
      const Index a = j * (kSide + 1) + i, b = a + 1, c = b + kSide + 1, d = c - 1;
      if (turn(a, b, c) > 0 && turn(a, c, d) > 0) {
        faces.push_back({a, b, c});
        faces.push_back({a, c, d});
      } else {
        faces.push_back({a, b, d});
        faces.push_back({b, c, d});
      }
    }
  }
  for (const auto& [a, b, c] : faces) ASSERT_GT(turn(a, b, c), 0);
  const Connectivity surface = *Connectivity::fromFaces(static_cast<Index>(points.size()), faces);
  std::vector<double> half_chords;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    half_chords.push_back(std::abs(points[surface.tail(h)] - points[surface.head(h)]) / 2);
  }
  IntrinsicTriangulation last(surface, half_chords);
  const auto flips = flipToDelaunayIsometric(context, last);
  ASSERT_OK(flips);
  EXPECT_GT(*flips, 50U);
  const auto overlay = Overlay::make(context, last);
  ASSERT_OK(overlay);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Complex a = points[surface.tail(surface.halfedge(e))];
    const Complex b = points[surface.head(surface.halfedge(e))];
    std::map<double, std::pair<Index, Index>> expected;
    for (Index h = 0; h < last.halfedgeCount(); ++h) {
      if (last.twin(h) != kNone && last.twin(h) < h) continue;
      const Complex c = points[last.tail(h)], d = points[last.head(h)];
      if (c == a || c == b || d == a || d == b) continue;
      const bool apart = (cross(b - a, c - a) > 0) != (cross(b - a, d - a) > 0) &&
                         (cross(d - c, a - c) > 0) != (cross(d - c, b - c) > 0);
      if (apart) expected[meeting(a, b, c, d)] = std::minmax(last.tail(h), last.head(h));
    }
    std::vector<std::pair<Index, Index>> in_order, found;
    for (const auto& [fraction, ends] : expected) in_order.push_back(ends);
    for (const Crossing& crossing : overlay->crossings(e)) {
      found.push_back(std::minmax(last.tail(crossing.halfedge), last.head(crossing.halfedge)));
    }
    EXPECT_EQ(found, in_order) << e;
  }
}

TEST(Overlay, ForgetsWhatIsFlippedBack) {
  Context context;
  CirclePolygon polygon = circlePolygon(12, 3);
  IntrinsicTriangulation& triangulation = polygon.triangulation;
  const std::size_t before = triangulation.history().size();
  flipAtRandom(triangulation, 100, 7);
  std::vector<Index> flipped;
  for (std::size_t n = before; n < triangulation.history().size(); ++n) {
    flipped.push_back(triangulation.history()[n].halfedge);
  }
  // Four flips of one edge turn the quadrilateral around once, numbers and all.
  for (std::size_t n = flipped.size(); n-- > 0;) {
    for (int turn = 0; turn < 3; ++turn) {
      triangulation.flip(flipped[n], triangulation.ptolemyDiagonal(flipped[n]));
    }
  }
  const auto overlay = Overlay::make(context, triangulation);
  ASSERT_OK(overlay);
  for (Index e = 0; e < polygon.surface.edgeCount(); ++e) {
    EXPECT_TRUE(overlay->crossings(e).empty());
  }
}

TEST(Overlay, OfAClosedSurfaceHasChordsInOppositeFacesThatFit) {
  // A tetrahedron's edges wind around it more than once after many flips: loops and double edges.
  Context context;
  const Connectivity surface =
      *Connectivity::fromFaces(4, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  for (unsigned seed = 0; seed < 30; ++seed) {
    IntrinsicTriangulation triangulation(surface, {1, 1.1, 0.9, 1.2, 1.3, 0.8});
    flipAtRandom(triangulation, 12, seed);
    const auto overlay = Overlay::make(context, triangulation);
    ASSERT_OK(overlay);
    // Every piece of a final edge between two crossings is a chord of exactly one given face, and
    // the overlay's cells are disks: V - E + F = 2.
    Index crossings = 0, chords = 0, cells = 0;
    for (Index e = 0; e < surface.edgeCount(); ++e) {
      crossings += static_cast<Index>(overlay->crossings(e).size());
      double last = 0;
      for (const Crossing& crossing : overlay->crossings(e)) {
        EXPECT_GT(crossing.fraction, last);
        EXPECT_LT(crossing.fraction, 1);
        last = crossing.fraction;
      }
    }
    for (Index f = 0; f < surface.faceCount(); ++f) {
      const auto in_face = static_cast<Index>(overlay->chords(f).size());
      chords += in_face;
      cells += in_face + 1;
    }
    const Index vertices = 4 + crossings;
    const Index edges = surface.edgeCount() + crossings + chords;
    EXPECT_EQ(vertices - edges + cells, 2);
    // Per final edge: one chord more than crossings, unless it is a given edge.
    std::map<Index, Index> on_edge;
    for (Index e = 0; e < surface.edgeCount(); ++e) {
      for (const Crossing& crossing : overlay->crossings(e)) {
        ++on_edge[std::min(crossing.halfedge, triangulation.twin(crossing.halfedge))];
      }
    }
    Index expected = 0;
    for (const auto& [edge, count] : on_edge) expected += count + 1;
    EXPECT_EQ(chords, expected);
  }
}

TEST(NormalArcs, CutOffCornersOrEndInThem) {
  const NormalArcs plain(3, 2, 1);
  EXPECT_EQ(plain.corner[0], 1);
  EXPECT_EQ(plain.corner[1], 2);
  EXPECT_EQ(plain.corner[2], 0);
  EXPECT_EQ(plain.ending[0], 0);
  const NormalArcs ending(5, 2, 1);
  EXPECT_EQ(ending.corner[0], 1);
  EXPECT_EQ(ending.corner[1], 2);
  EXPECT_EQ(ending.ending[0], 2);
}

/// The plane of a polygon as the image of its subdivision.
struct PlaneImage {
  std::vector<Complex> points;
  SubdivisionImage image;

  explicit PlaneImage(const CirclePolygon& polygon) : points(polygon.corners) {
    image.locate = [this, &polygon](const Subdivision::Vertex& vertex) {
      const Complex tail = points[polygon.surface.tail(vertex.halfedge)];
      const Complex head = points[polygon.surface.head(vertex.halfedge)];
      points.push_back(tail + vertex.fraction * (head - tail));
    };
    image.quality = [this](Index a, Index b, Index c) {
      const double longest =
          std::max({std::norm(points[b] - points[a]), std::norm(points[c] - points[b]),
                    std::norm(points[a] - points[c])});
      return cross(points[b] - points[a], points[c] - points[a]) / longest;
    };
  }
};

TEST(Subdivide, CutsFacesIntoPiecesOfTheSameArea) {
  Context context;
  CirclePolygon polygon = circlePolygon(15, 5);
  flipAtRandom(polygon.triangulation, 200, 5);
  const auto overlay = Overlay::make(context, polygon.triangulation);
  ASSERT_OK(overlay);
  PlaneImage plane(polygon);
  std::vector<bool> all(polygon.surface.faceCount(), true);
  const auto result = subdivide(context, *overlay, all, polygon.surface.faceCount(), plane.image);
  ASSERT_OK(result);
  std::vector<double> areas(polygon.surface.faceCount(), 0.0);
  for (std::size_t f = 0; f < result->faces.size(); ++f) {
    const auto& [a, b, c] = result->faces[f];
    const double area =
        cross(plane.points[b] - plane.points[a], plane.points[c] - plane.points[a]) / 2;
    EXPECT_GT(area, 0);
    areas[result->parent[f]] += area;
  }
  for (Index f = 0; f < polygon.surface.faceCount(); ++f) {
    const auto& [a, b, c] = polygon.surface.face(f);
    const double whole =
        cross(polygon.corners[b] - polygon.corners[a], polygon.corners[c] - polygon.corners[a]) / 2;
    EXPECT_NEAR(areas[f], whole, 1e-13);
  }
  // Lengths are those of straight pieces.
  const auto count = polygon.surface.vertexCount() + static_cast<Index>(result->vertices.size());
  const auto surface = Connectivity::fromFaces(count, result->faces);
  ASSERT_OK(surface);
  std::vector<double> lengths;
  for (Index e = 0; e < polygon.surface.edgeCount(); ++e) {
    const Index h = polygon.surface.halfedge(e);
    lengths.push_back(std::abs(polygon.corners[polygon.surface.tail(h)] -
                               polygon.corners[polygon.surface.head(h)]));
  }
  const std::vector<double> fine = subdividedLengths(polygon.surface, lengths, *result, *surface);
  for (Index e = 0; e < surface->edgeCount(); ++e) {
    const Index h = surface->halfedge(e);
    EXPECT_NEAR(fine[e], std::abs(plane.points[surface->tail(h)] - plane.points[surface->head(h)]),
                1e-13);
  }
  // Pieces of a given edge lie along it, and make up its length.
  for (Index e = 0; e < polygon.surface.edgeCount(); ++e) {
    std::vector<bool> one(polygon.surface.edgeCount(), false);
    one[e] = true;
    const std::vector<bool> along = edgesAlong(polygon.surface, one, *result, *surface);
    double length = 0;
    for (Index piece = 0; piece < surface->edgeCount(); ++piece) {
      if (along[piece]) length += fine[piece];
    }
    EXPECT_NEAR(length, lengths[e], 1e-13);
  }
}

TEST(Subdivide, LeavesDistantFacesAlone) {
  Context context;
  CirclePolygon polygon = circlePolygon(30, 9);
  flipAtRandom(polygon.triangulation, 8, 2);
  const auto overlay = Overlay::make(context, polygon.triangulation);
  ASSERT_OK(overlay);
  PlaneImage plane(polygon);
  std::vector<bool> one(polygon.surface.faceCount(), false);
  Index chosen = 0;
  while (overlay->chords(chosen).empty()) ++chosen;
  one[chosen] = true;
  const auto result = subdivide(context, *overlay, one, polygon.surface.faceCount(), plane.image);
  ASSERT_OK(result);
  std::vector<int> pieces(polygon.surface.faceCount(), 0);
  for (const Index parent : result->parent) ++pieces[parent];
  EXPECT_GT(pieces[chosen], 1);
  for (Index f = 0; f < polygon.surface.faceCount(); ++f) {
    const bool beside = f == chosen || f == chosen - 1 || f == chosen + 1;
    if (!beside) {
      EXPECT_EQ(pieces[f], 1) << f;
    }
  }
  // All of it glues to a surface again: no vertex hangs on the side of a face.
  EXPECT_OK(Connectivity::fromFaces(
      polygon.surface.vertexCount() + static_cast<Index>(result->vertices.size()), result->faces));
}

}  // namespace
}  // namespace moduli
