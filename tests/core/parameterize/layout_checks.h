#pragma once

#include <cmath>
#include <complex>
#include <set>
#include <vector>

#include "core/mesh/connectivity.h"

/// What a layout in the plane is judged by: points and, per halfedge, the one of its tail.
namespace moduli {

struct PlanarFaces {
  const Connectivity& surface;
  const std::vector<std::complex<double>>& points;
  const std::vector<Index>& corner;

  std::complex<double> at(Index h) const { return points[corner[h]]; }
  /// Along halfedge h, in its own face.
  std::complex<double> along(Index h) const { return at(Connectivity::next(h)) - at(h); }

  bool isSeam(Index h) const {
    const Index twin = surface.twin(h);
    return twin != kNone && (corner[h] != corner[Connectivity::next(twin)] ||
                             corner[Connectivity::next(h)] != corner[twin]);
  }

  /// Of the faces with the corners and sides that they share: 1 for a disk.
  Index eulerCharacteristic() const {
    Index edges = surface.edgeCount();
    for (Index e = 0; e < surface.edgeCount(); ++e) edges += isSeam(surface.halfedge(e)) ? 1 : 0;
    return static_cast<Index>(points.size()) - edges + surface.faceCount();
  }

  /// Whether every point is some corner's, and every corner has one.
  bool namesAllCorners() const {
    std::set<Index> used;
    for (const Index point : corner) {
      if (point < 0 || point >= static_cast<Index>(points.size())) return false;
      used.insert(point);
    }
    return corner.size() == static_cast<std::size_t>(surface.halfedgeCount()) &&
           used.size() == points.size();
  }

  double doubledArea(Index f) const {
    return std::imag(std::conj(along(3 * f)) * along(3 * f + 1));
  }

  /// Around every vertex, in all its images.
  std::vector<double> angleSums() const {
    std::vector<double> sums(surface.vertexCount(), 0.0);
    for (Index h = 0; h < surface.halfedgeCount(); ++h) {
      sums[surface.tail(h)] += std::arg(-along(Connectivity::previous(h)) / along(h));
    }
    return sums;
  }
};

}  // namespace moduli
