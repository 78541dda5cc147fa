#pragma once

#include <array>
#include <complex>
#include <optional>
#include <vector>

#include "core/base/status.h"
#include "core/intrinsic/flat_charts.h"
#include "core/mesh/connectivity.h"

/// A flat torus as the plane modulo a lattice, and curves along its edges. Internal to this room.
namespace moduli {

/// m a + n b for generators a, b.
struct LatticeVector {
  int m = 0, n = 0;
  bool operator==(const LatticeVector&) const = default;
  LatticeVector operator+(const LatticeVector& v) const { return {m + v.m, n + v.n}; }
  LatticeVector operator-(const LatticeVector& v) const { return {m - v.m, n - v.n}; }
};

struct TorusLattice {
  /// Re a > 0 = Im a, and b / a in the fundamental domain of SL(2, Z); one cell has the area 1.
  std::array<std::complex<double>, 2> generators;
  std::complex<double> tau;                 ///< b / a.
  std::vector<std::complex<double>> place;  ///< Per vertex: one of its images in the plane.
  /// Per halfedge: it runs from the image of its tail to that of its head moved by this.
  std::vector<LatticeVector> shift;
  /// Largest distance between edges of the faces and differences of images, in units of the square
  /// root of the area; |area of a cell / area of the faces - 1|.
  double residual = 0, area_residual = 0;

  std::complex<double> at(const LatticeVector& v) const {
    return static_cast<double>(v.m) * generators[0] + static_cast<double>(v.n) * generators[1];
  }
  std::complex<double> along(const Connectivity& surface, Index h) const {
    return place[surface.head(h)] + at(shift[h]) - place[surface.tail(h)];
  }
};

/// surface: closed, connected, of genus 1; charts: without a cone. Fails with kResidualTooLarge
/// where the charts' translations span no lattice of their area. O(F log F).
Result<TorusLattice> latticeOfTorus(const Connectivity& surface, const FlatCharts& charts);

/// Per face the lattice vector that carries its first corner, from the image of its vertex, into a
/// domain that goes on across all edges but seams. shift: as TorusLattice::shift, of any genus;
/// seam: per edge. Nothing where such a domain does not close up or is not connected. O(F).
std::optional<std::vector<LatticeVector>> liftFaces(const Connectivity& surface,
                                                    const std::vector<LatticeVector>& shift,
                                                    const std::vector<bool>& seam);

/// Two closed walks from one vertex, in the classes of the generators a and b, that have no other
/// vertex in common and meet none twice.
struct TorusCut {
  std::array<std::vector<Index>, 2> walks;  ///< Halfedges, one after the other.
};

/// Short ones: of least length among those from some vertices, ways across their generator counting
/// three times, the second one not crossing the first. Walks are empty where there are none, on
/// triangulations of a few faces. Some 50 searches, each among the vertices near a straight line.
TorusCut shortCut(const Connectivity& surface, const TorusLattice& lattice);

}  // namespace moduli
