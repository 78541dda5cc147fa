#include <cmath>
#include <numbers>

#include "core/mesh/sample_kinds.h"

/// Polyhedral surfaces: the flat torus in space, and plates with rectangular holes.
namespace moduli {
namespace {

constexpr Index kMostSteps = 4000;

struct PlateShape {
  Index cells_x;
  Index cells_y;
  Index holes;
  Index hole_x;
  Index hole_y;
  Index hole_width;
  Index hole_height;
  Index hole_step;

  bool isHole(Index x, Index y) const {
    if (y < hole_y || y >= hole_y + hole_height || x < hole_x) return false;
    return (x - hole_x) / hole_step < holes && (x - hole_x) % hole_step < hole_width;
  }
};

Result<PlateShape> plateShape(const SampleValues& values) {
  constexpr Index kMostCells = 2000;
  RETURN_IF_ERROR(values.checkCount("holes", 0, kMostCells));
  for (const char* name : {"cells_x", "cells_y"}) {
    RETURN_IF_ERROR(values.checkCount(name, 0, kMostCells));
  }
  for (const char* name : {"hole_x", "hole_y", "hole_width", "hole_height", "hole_step"}) {
    RETURN_IF_ERROR(values.checkCount(name, 1, kMostCells));
  }
  PlateShape shape = {values.count("cells_x"),     values.count("cells_y"),
                      values.count("holes"),       values.count("hole_x"),
                      values.count("hole_y"),      values.count("hole_width"),
                      values.count("hole_height"), values.count("hole_step")};
  const Index holes_end =
      shape.hole_x + (std::max(shape.holes, 1) - 1) * shape.hole_step + shape.hole_width;
  const Index top = shape.hole_y + shape.hole_height;
  if (shape.cells_x == 0) shape.cells_x = holes_end + 1;
  if (shape.cells_y == 0) shape.cells_y = top + 1;
  if (shape.holes > 1 && shape.hole_step <= shape.hole_width) {
    return sampleError("hole_step must be larger than hole_width, or the holes run together");
  }
  if (shape.holes > 0 && (holes_end >= shape.cells_x || top >= shape.cells_y)) {
    return sampleError("the holes do not fit into the plate with a margin of one cell",
                       "raise cells_x or cells_y, or leave them out");
  }
  return shape;
}

// Every cell as four triangles about its centre; vertices only where a cell is.
TriangleSoup crissCross(const PlateShape& shape) {
  TriangleSoup soup;
  std::vector<Index> corner((shape.cells_x + 1) * (shape.cells_y + 1), kNone);
  const auto vertexAt = [&](Index x, Index y) {
    Index& v = corner[y * (shape.cells_x + 1) + x];
    if (v == kNone) {
      v = static_cast<Index>(soup.vertices.size());
      soup.vertices.emplace_back(x, y, 0);
    }
    return v;
  };
  for (Index y = 0; y < shape.cells_y; ++y) {
    for (Index x = 0; x < shape.cells_x; ++x) {
      if (shape.isHole(x, y)) continue;
      const std::array<Index, 4> q = {vertexAt(x, y), vertexAt(x + 1, y), vertexAt(x + 1, y + 1),
                                      vertexAt(x, y + 1)};
      const auto centre = static_cast<Index>(soup.vertices.size());
      soup.vertices.emplace_back(x + 0.5, y + 0.5, 0);
      for (int s = 0; s < 4; ++s) soup.faces.push_back({q[s], q[(s + 1) % 4], centre});
    }
  }
  return soup;
}

// On the outer rectangle or on the border of a hole: touching, at one of the four cells around the
// point, something that is no cell.
bool onPlateBorder(const PlateShape& shape, const Eigen::Vector3d& p) {
  for (const double dx : {-0.25, 0.25}) {
    for (const double dy : {-0.25, 0.25}) {
      // Borders lie on whole numbers; elsewhere both points are in the cell of p.
      const bool whole_x = p.x() == std::round(p.x());
      const bool whole_y = p.y() == std::round(p.y());
      const auto x = static_cast<Index>(std::floor(whole_x ? p.x() + dx : p.x()));
      const auto y = static_cast<Index>(std::floor(whole_y ? p.y() + dy : p.y()));
      if (x < 0 || y < 0 || x >= shape.cells_x || y >= shape.cells_y || shape.isHole(x, y)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

Result<TriangleSoup> makePlate(const SampleValues& values) {
  ASSIGN_OR_RETURN(const PlateShape shape, plateShape(values));
  RETURN_IF_ERROR(values.checkCount("resolution", 1, kMostSteps));
  const Index n = values.count("resolution");
  RETURN_IF_ERROR(checkSampleSize(4.0 * shape.cells_x * shape.cells_y * n * n));
  TriangleSoup soup = subdivideFaces(crissCross(shape), n);
  if (values.seed() != 0) {
    SampleRandom random(values.seed());
    const std::vector<Eigen::Vector3d> before = soup.vertices;
    moveVertices(soup, random, [&](Index v, const Eigen::Vector3d& moved) {
      if (onPlateBorder(shape, before[v])) return before[v];
      return Eigen::Vector3d(moved.x(), moved.y(), 0);
    });
  }
  return soup;
}

// Source: MATH 12.2, with its names.
Result<TriangleSoup> makeDiplotorus(const SampleValues& values) {
  constexpr Index kMostSides = 1000;
  RETURN_IF_ERROR(values.checkCount("n", 4, kMostSides));
  const Index n = values.count("n");
  RETURN_IF_ERROR(values.checkCount("s", -kMostSides, kMostSides));
  RETURN_IF_ERROR(values.checkCount("s2", -kMostSides, kMostSides));
  RETURN_IF_ERROR(values.checkCount("resolution", 1, kMostSteps));
  RETURN_IF_ERROR(values.checkPositive("h"));
  const double phi = values["phi"];
  if (!std::isfinite(phi)) return sampleError("phi must be a finite angle in radians");
  const Index m = values.count("resolution");
  RETURN_IF_ERROR(checkSampleSize(4.0 * n * m * m));
  const auto wrap = [n](Index k) { return (k % n + n) % n; };
  const Index s = wrap(values.count("s"));
  const Index s2 = wrap(values.count("s2"));
  if (wrap(s2 - s) < 2 || wrap(s2 - s) > n - 2) {
    return sampleError("s2 - s must lie between 2 and n - 2, counted modulo n",
                       "otherwise two edges join the same vertices");
  }

  TriangleSoup base;
  for (const Eigen::Vector3d& p : circleRing(1, 0, n)) base.vertices.push_back(p);
  for (Index k = 0; k < n; ++k) {
    const double angle = 2 * std::numbers::pi * k / n + phi;
    base.vertices.emplace_back(std::cos(angle), std::sin(angle), values["h"]);
  }
  for (Index k = 0; k < n; ++k) {
    const auto top = [&](Index i) { return n + wrap(i); };
    const Index next = wrap(k + 1);
    base.faces.push_back({k, next, top(k + s)});
    base.faces.push_back({top(k + s), next, top(k + s + 1)});
    base.faces.push_back({next, k, top(k + s2)});
    base.faces.push_back({next, top(k + s2), top(k + s2 + 1)});
  }
  if (signedVolume6(base) < 0) {
    for (Triangle& t : base.faces) std::swap(t[1], t[2]);
  }
  return subdivideFaces(base, m);
}

}  // namespace moduli
