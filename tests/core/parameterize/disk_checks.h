#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/hyperbolic/axis.h"
#include "core/hyperbolic/orbit_polygon.h"
#include "core/intrinsic/geometry.h"
#include "core/parameterize/parameterization.h"
#include "tests/core/parameterize/layout_checks.h"
#include "tests/core/testing.h"

/// What an image in the Poincaré disk is judged by, from its points alone.
namespace moduli {

/// The direction from one point of the disk to another: 0 where the first is carried to 0.
inline Complex seenFrom(Complex from, Complex to) {
  return imageOf(inverse(translationTo(from)), to);
}

struct DiskFaces {
  PlanarFaces plane;
  const std::vector<Su11>& neighbours;

  Complex at(Index h) const { return plane.at(h); }
  double length(Index h) const { return hyperbolicDistance(at(h), at(Connectivity::next(h))); }

  /// Of the geodesic triangle, at tail(h); negative where it is turned over.
  double angle(Index h) const {
    const Complex to_next = seenFrom(at(h), at(Connectivity::next(h)));
    return std::arg(seenFrom(at(h), at(Connectivity::previous(h))) * std::conj(to_next));
  }

  double signedArea(Index f) const {
    const double area =
        triangleArea(Geometry::kHyperbolic, {length(3 * f), length(3 * f + 1), length(3 * f + 2)});
    return angle(3 * f) > 0 ? area : -area;
  }

  double area() const {
    double sum = 0;
    for (Index f = 0; f < plane.surface.faceCount(); ++f) sum += signedArea(f);
    return sum;
  }

  /// Around every vertex, in all its images.
  std::vector<double> angleSums() const {
    std::vector<double> sums(plane.surface.vertexCount(), 0.0);
    for (Index h = 0; h < plane.surface.halfedgeCount(); ++h) {
      sums[plane.surface.tail(h)] += angle(h);
    }
    return sums;
  }

  /// How far the best of the neighbours (or none) brings `from` to `to`.
  double gapToCopies(Complex from, Complex to) const {
    double gap = hyperbolicDistance(from, to);
    for (const Su11& g : neighbours) gap = std::min(gap, hyperbolicDistance(imageOf(g, from), to));
    return gap;
  }

  /// How far the best of the neighbours brings a cut side's other side to it.
  double seamGap(Index h) const {
    const Index twin = plane.surface.twin(h);
    double gap = std::numeric_limits<double>::infinity();
    for (const Su11& g : neighbours) {
      const double tail = hyperbolicDistance(imageOf(g, at(Connectivity::next(twin))), at(h));
      const double head = hyperbolicDistance(imageOf(g, at(twin)), at(Connectivity::next(h)));
      gap = std::min(gap, std::max(tail, head));
    }
    return gap;
  }
};

/// What every image has: one sheet inside the disk, with the angles and the area of the surface.
/// tolerances: points at distance d from 0 are known to some 1e-16 e^d in the disk's metric.
inline void expectSheet(const DiskFaces& disk, double radius) {
  const Connectivity& surface = disk.plane.surface;
  ASSERT_TRUE(disk.plane.namesAllCorners());
  EXPECT_EQ(disk.plane.eulerCharacteristic(), 1);
  double farthest = 0;
  for (const Complex point : disk.plane.points) {
    ASSERT_LT(std::abs(point), 1);
    farthest = std::max(farthest, hyperbolicDistance(point, 0.0));
  }
  EXPECT_NEAR(farthest, radius, 1e-12 * radius);
  for (Index f = 0; f < surface.faceCount(); ++f) {
    ASSERT_GT(disk.plane.doubledArea(f), 0) << "face " << f;
    ASSERT_GT(disk.signedArea(f), 0) << "face " << f;
  }
  const double expected = -2 * std::numbers::pi * surface.eulerCharacteristic();
  EXPECT_NEAR(disk.area(), expected, 1e-9);
  const std::vector<double> sums = disk.angleSums();
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    const double full = surface.isBoundaryVertex(v) ? std::numbers::pi : 2 * std::numbers::pi;
    ASSERT_NEAR(sums[v], full, 1e-7) << "vertex " << v;
  }
}

/// Cut sides go to each other by neighbours, which have their inverses among them.
inline void expectSeams(const DiskFaces& disk) {
  int seams = 0;
  for (Index h = 0; h < disk.plane.surface.halfedgeCount(); ++h) {
    if (!disk.plane.isSeam(h)) continue;
    ++seams;
    ASSERT_LT(disk.seamGap(h), 1e-7) << "halfedge " << h;
  }
  EXPECT_GT(seams, 0);
  for (const Su11& g : disk.neighbours) {
    EXPECT_TRUE(std::any_of(disk.neighbours.begin(), disk.neighbours.end(),
                            [&](const Su11& other) { return displacement(other * g) < 1e-7; }));
    EXPECT_GT(translationLength(g), 1e-3);
  }
}

/// Geodesics go on where they left off, and their ways in the disk add up.
inline void expectGeodesics(const DiskFaces& disk, const HyperbolicDomain& domain) {
  double before = 0;
  for (const GeodesicPath& path : domain.geodesics) {
    EXPECT_GE(path.length, before);
    before = path.length;
    ASSERT_FALSE(path.steps.empty());
    double sum = 0;
    for (std::size_t i = 0; i < path.steps.size(); ++i) {
      const GeodesicPath::Step& step = path.steps[i];
      const GeodesicPath::Step& next = path.steps[(i + 1) % path.steps.size()];
      sum += hyperbolicDistance(step.from, step.to);
      ASSERT_LT(disk.gapToCopies(next.from, step.to), 1e-7) << "step " << i;
      const Index exit = disk.plane.surface.twin(next.entry);
      ASSERT_EQ(Connectivity::faceOf(exit), Connectivity::faceOf(step.entry)) << "step " << i;
      // On the side that it comes in through, where it says.
      const Complex on_side =
          imageOf(edgeFrame(disk.at(step.entry), disk.at(Connectivity::next(step.entry))),
                  std::tanh(step.fraction * disk.length(step.entry) / 2));
      ASSERT_LT(hyperbolicDistance(on_side, step.from), 1e-7) << "step " << i;
    }
    EXPECT_NEAR(sum, path.length, 1e-9);
  }
}

/// Boundary edges that follow each other in the image lie on one geodesic; the number of chains.
inline int expectStraightBoundary(const DiskFaces& disk) {
  const Connectivity& surface = disk.plane.surface;
  int chains = 0;
  std::vector<Index> following(disk.plane.points.size(), kNone);
  std::vector<bool> has_previous(disk.plane.points.size(), false);
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (surface.twin(h) != kNone) continue;
    following[disk.plane.corner[h]] = disk.plane.corner[Connectivity::next(h)];
    has_previous[disk.plane.corner[Connectivity::next(h)]] = true;
  }
  for (std::size_t p = 0; p < following.size(); ++p) {
    if (following[p] == kNone || has_previous[p]) continue;
    ++chains;
    std::vector<Complex> chain;
    for (auto q = static_cast<Index>(p); q != kNone; q = following[q]) {
      chain.push_back(disk.plane.points[q]);
    }
    const Su11 back = inverse(edgeFrame(chain.front(), chain.back()));
    for (const Complex point : chain)
      EXPECT_NEAR(sideOf({0, {0, 1}}, imageOf(back, point)), 0, 1e-9);
  }
  return chains;
}

/// The sums of a parameterization's boundary edges in the image, per loop.
inline std::vector<double> imageBoundaryLengths(
    const DiskFaces& disk, const std::vector<std::vector<Index>>& boundary_loops) {
  std::vector<double> sums;
  for (const std::vector<Index>& loop : boundary_loops) {
    sums.push_back(0);
    for (const Index h : loop) sums.back() += disk.length(h);
  }
  return sums;
}

/// Whether an element belongs to the group of a polygon: copies of 0 are brought nearer by its
/// pairings until they are at 0.
inline bool isInGroup(const OrbitPolygon& polygon, const Su11& element) {
  Su11 g = renormalized(inverse(polygon.base) * element * polygon.base);
  for (int n = 0; n < 1000; ++n) {
    Su11 nearest = g;
    for (const GroupElement& pairing : polygon.pairings) {
      const Su11 other = renormalized(inverse(pairing.map) * g);
      if (displacement(other) < displacement(nearest) - 1e-9) nearest = other;
    }
    if (displacement(nearest) > displacement(g) - 1e-9) break;
    g = nearest;
  }
  return distanceToUnit(g) < 1e-6;
}

}  // namespace moduli
