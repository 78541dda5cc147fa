#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "core/mesh/connectivity.h"
#include "core/spherical/circle.h"

/// Triangulated disks with round holes, for the tests of circle domains.
namespace moduli {

struct PlaneDomain {
  std::vector<std::complex<double>> points;
  std::vector<Triangle> faces;            ///< Counter-clockwise.
  std::vector<std::vector<Index>> loops;  ///< Outer one first, each counter-clockwise.
};

namespace plane_domains {

/// Whether d lies in the circle through a, b, c, which run counter-clockwise.
inline bool inCircle(std::complex<double> a, std::complex<double> b, std::complex<double> c,
                     std::complex<double> d) {
  a -= d;
  b -= d;
  c -= d;
  const auto cross = [](std::complex<double> p, std::complex<double> q) {
    return p.real() * q.imag() - p.imag() * q.real();
  };
  return std::norm(a) * cross(b, c) + std::norm(b) * cross(c, a) + std::norm(c) * cross(a, b) > 0;
}

/// Delaunay triangles of points by insertion one after the other. O(n^2), for tests. The points are
/// moved a little first, so that no four of them share a circle as far as doubles can tell.
inline std::vector<Triangle> delaunayTriangles(std::vector<std::complex<double>> points,
                                               double jitter) {
  const auto count = static_cast<Index>(points.size());
  std::mt19937 random(5);
  for (std::complex<double>& z : points) {
    z += std::polar(jitter, static_cast<double>(random() % 4096));
  }
  for (const double angle : {0.3, 2.5, 4.4}) points.push_back(std::polar(1e4, angle));
  std::vector<Triangle> faces = {{count, count + 1, count + 2}};
  for (Index v = 0; v < count; ++v) {
    std::vector<Triangle> kept;
    std::vector<std::array<Index, 2>> rim;
    for (const Triangle& face : faces) {
      if (!inCircle(points[face[0]], points[face[1]], points[face[2]], points[v])) {
        kept.push_back(face);
        continue;
      }
      for (int c = 0; c < 3; ++c) {
        const std::array<Index, 2> side = {face[c], face[(c + 1) % 3]};
        bool inner = false;
        for (std::array<Index, 2>& other : rim) {
          if (other[0] != side[1] || other[1] != side[0]) continue;
          other = rim.back();
          rim.pop_back();
          inner = true;
          break;
        }
        if (!inner) rim.push_back(side);
      }
    }
    for (const std::array<Index, 2>& side : rim) kept.push_back({side[0], side[1], v});
    faces = std::move(kept);
  }
  std::erase_if(faces, [&](const Triangle& face) {
    return face[0] >= count || face[1] >= count || face[2] >= count;
  });
  return faces;
}

}  // namespace plane_domains

/// Points without faces: even ones on the circles, `h` apart (6 at least), and those of a
/// triangular lattice of edge `spacing` between them that are not nearer to a circle than 0.6 of
/// it.
inline PlaneDomain placePoints(const std::vector<Circle>& circles, double h, double spacing) {
  PlaneDomain domain;
  for (std::size_t k = 0; k < circles.size(); ++k) {
    const int count =
        std::max(6, static_cast<int>(2 * std::numbers::pi * circles[k].radius / h + 0.5));
    domain.loops.emplace_back();
    for (int i = 0; i < count; ++i) {
      domain.loops.back().push_back(static_cast<Index>(domain.points.size()));
      const double angle = 2 * std::numbers::pi * (i + 0.1 * static_cast<double>(k)) / count;
      domain.points.push_back(circles[k].center + std::polar(circles[k].radius, angle));
    }
  }
  const int rows = static_cast<int>(2 * circles[0].radius / spacing) + 2;
  for (int i = -rows; i <= rows; ++i) {
    for (int j = -rows; j <= rows; ++j) {
      // A little off the symmetric place: no mesh of the plane is even.
      const std::complex<double> cell(i + 0.5 * j + 0.013 * std::sin(7.0 * i * j),
                                      0.866 * j + 0.0123 * std::cos(5.0 * i + j));
      const std::complex<double> z = circles[0].center + spacing * cell;
      bool within = circles[0].distance(z) < -0.6 * spacing;
      for (std::size_t k = 1; k < circles.size(); ++k) {
        within = within && circles[k].distance(z) > 0.6 * spacing;
      }
      if (within) domain.points.push_back(z);
    }
  }
  return domain;
}

/// The inside of circles[0] less the insides of the others, in triangles with edges of about h.
inline PlaneDomain triangulateDomain(const std::vector<Circle>& circles, double h) {
  PlaneDomain domain = placePoints(circles, h, h);
  // The centres of the holes, to which all sides of a hole see; the faces there go again.
  const auto count = static_cast<Index>(domain.points.size());
  std::vector<std::complex<double>> points = domain.points;
  for (std::size_t k = 1; k < circles.size(); ++k) points.push_back(circles[k].center);
  domain.faces = plane_domains::delaunayTriangles(points, 1e-5 * h);
  std::erase_if(domain.faces, [&](const Triangle& face) {
    return face[0] >= count || face[1] >= count || face[2] >= count;
  });
  return domain;
}

/// Lengths of the straight edges between points.
inline std::vector<double> planeLengths(const Connectivity& surface,
                                        const std::vector<std::complex<double>>& points) {
  std::vector<double> lengths(surface.edgeCount());
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    lengths[e] = std::abs(points[surface.head(h)] - points[surface.tail(h)]);
  }
  return lengths;
}

}  // namespace moduli
