#include "core/hyperbolic/straight_faces.h"

#include <utility>

#include "core/intrinsic/undo_flips.h"
#include "core/topology/surface_topology.h"

namespace moduli {

StraightFaces straightFaces(const DiscreteMetric& metric) {
  SignedTriangles triangles{{}, metric.angles};
  for (const double x : metric.half_chords) {
    triangles.lengths.push_back(lengthOfHalfChord(metric.geometry, x));
  }
  triangles = undoFlips(metric.geometry, metric.triangulation, std::move(triangles));
  IntrinsicTriangulation start = metric.triangulation;
  start.undoTo(0);
  return {start.connectivity(), std::move(triangles.lengths), std::move(triangles.angles)};
}

std::vector<double> boundaryLengths(const Connectivity& surface,
                                    const std::vector<double>& lengths) {
  std::vector<double> sums;
  const SurfaceTopology topology = computeTopology(surface);
  for (const std::vector<Index>& loop : topology.boundary_loops) {
    double sum = 0;
    for (const Index h : loop) sum += lengths[h];
    sums.push_back(sum);
  }
  return sums;
}

}  // namespace moduli
