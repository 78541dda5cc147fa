#pragma once

#include <cmath>

#include "core/matching/split_surface.h"
#include "tests/core/matching/cover_samples.h"

/// Surfaces with boundary other than disks.
namespace moduli {

/// A flat ring, and a bent plate with three holes.
inline TriangleSoup ring(int resolution, double outer, int seed) {
  return *makeSample("annulus", {{"R", outer},
                                 {"resolution", static_cast<double>(resolution)},
                                 {"seed", static_cast<double>(seed)}});
}
inline TriangleSoup bentPlate(int resolution, int seed) {
  TriangleSoup soup = *makeSample("plate", {{"holes", 3},
                                            {"resolution", static_cast<double>(resolution)},
                                            {"seed", static_cast<double>(seed)}});
  for (Eigen::Vector3d& p : soup.vertices) p[2] = 0.3 * std::sin(p[0]) + 0.05 * p[0] * p[1];
  return soup;
}
/// A torus without a patch: as small a one as leaves a surface.
inline TriangleSoup openTorus(int resolution, int seed) {
  const TriangleSoup soup = lumpyTorus(resolution, seed);
  for (double radius = 0.5;; radius *= 1.02) {
    TriangleSoup result;
    std::vector<Index> number(soup.vertices.size(), kNone);
    for (Triangle face : soup.faces) {
      if ((soup.vertices[face[0]] - Eigen::Vector3d(-2, 0, 0.8)).norm() < radius) continue;
      for (Index& v : face) {
        if (number[v] == kNone) {
          number[v] = static_cast<Index>(result.vertices.size());
          result.vertices.push_back(soup.vertices[v]);
        }
        v = number[v];
      }
      result.faces.push_back(face);
    }
    if (TriangleMesh::fromSoup(result).ok()) return result;
  }
}

/// Without edges that cut across.
inline TriangleMesh chordFree(const TriangleSoup& soup) {
  return SplitSurface::make(meshOf(soup))->mesh();
}

}  // namespace moduli
